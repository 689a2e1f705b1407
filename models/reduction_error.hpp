// How far the answers of reduced bodies are from those of the full ones.
#pragma once

#include <optional>
#include <span>
#include <string>
#include <vector>

#include "models/body_cache.hpp"

namespace stridor {

/// A reduced body beside its full model at some frequencies.
///
/// H(ω) holds the displacements of DoFs of the interface per harmonic forces on them. Of the full body it
/// is the part (K + iωC − ω²M)⁻¹ between these DoFs, by one sparse factorisation for each frequency; of
/// the reduced one it comes from its modes.
struct ReductionError {
  std::string body;
  Eigen::Index num_unknowns = 0;   ///< of the full body
  Eigen::Index num_interface = 0;  ///< DoFs that the reduction kept
  Eigen::Index num_modes = 0;      ///< fixed-interface modes that it kept
  std::optional<Eigen::Index> num_interface_modes;  ///< in which the interface moves; nothing: all
  std::vector<int> dofs;           ///< between which H is taken
  std::vector<double> frequencies; ///< Hz, > 0
  std::vector<double> errors;      ///< ‖H_reduced − H‖/‖H‖, Frobenius norms
};

/// Most DoFs of an interface between which answers are compared; of a larger one as many are taken at
/// equal distances of its order.
inline constexpr std::size_t most_compared_dofs = 60;

/// @param interface   as of make_craig_bampton()
/// @param dofs        of the interface, between which answers are compared
/// @param reduction   with a row for each of `dofs`
/// @param frequencies Hz; empty: 1/16, 1/8, 1/4, 1/2 and 1 times half of the frequency of the highest
///                    fixed-interface mode, up to which a reduction is trusted
/// @throws std::invalid_argument if there are no frequencies and no modes to choose some by
/// @throws NumericalError as SparsePencil; Interrupted
/// Cost: a factorisation and as many solves as `dofs` for each frequency.
ReductionError reduction_error(const BodyMatrices& body, std::span<const int> interface,
                               const std::vector<int>& dofs,
                               const BodyCache::Reduction& reduction,
                               const std::vector<double>& frequencies);

/// The same of every body of a model that is reduced and has an interface. Structural damping (loss
/// factors) is left out of both sides, as a reduction holds it by its modes only.
/// @throws ConfigError as make_model(); as reduction_error()
std::vector<ReductionError> reduction_errors(const ModelParameters& parameters,
                                             const std::vector<double>& frequencies,
                                             BodyCache& cache);

}  // namespace stridor
