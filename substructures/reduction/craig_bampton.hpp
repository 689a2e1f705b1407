// Craig-Bampton reduction.
#pragma once

#include <optional>
#include <span>

#include "substructures/matrices/body_matrices.hpp"
#include "substructures/matrices/coupled_terms.hpp"
#include "substructures/reduction/reduced_spin.hpp"

namespace stridor {

/// One component in reduced coordinates q: M q̈ + (α M + β K) q̇ + K q = rowsᵀ f + base_inertia (−a).
struct ReducedBody {
  Eigen::MatrixXd mass;       ///< n x n, symmetric positive definite
  Eigen::MatrixXd stiffness;  ///< n x n, symmetric positive semi-definite
  RayleighDamping damping;
  /// Row r: the displacement of watched DoF r is rows.row(r) q; a force on it enters as its
  /// transpose.
  Eigen::MatrixXd rows;
  /// Tᵀ M r of BodyMatrices::base_inertia; empty where the body does not follow the drive.
  Eigen::VectorXd base_inertia;
  Eigen::Index num_interface = 0;  ///< leading coordinates that are of the interface
  /// X of with_interface_modes(), a row for each DoF of the interface; empty where these DoFs are the
  /// leading coordinates.
  Eigen::MatrixXd interface_modes;
  /// Rounding of the entries of `stiffness` between interface DoFs, N/m: what is left of entries of
  /// the full stiffness that cancel in the motion of a soft or free body. 0 where nothing cancels.
  double interface_rounding = 0.0;
  CoupledTerms coupled;            ///< empty where there are none
  Eigen::MatrixXd loss_stiffness;  ///< Tᵀ (Σ η K) T, n x n, N/m; empty where there is none
  std::optional<ReducedSpin> spin;  ///< of a body that spins; not in `coupled` yet

  Eigen::Index size() const { return mass.rows(); }
};

/// Reduces a body to its interface DoFs and its lowest fixed-interface modes.
///
///   u = T q,  T = [[I, 0], [Ψ, Φ]],  Ψ = −K_ii⁻¹ K_ib,  K_ii Φ = M_ii Φ diag(ω²),  Φᵀ M_ii Φ = I
///   (docs/theory.md, 1.2; Craig and Bampton 1968)
///
/// Static response to interface loads is exact, mass and rigid-body motions are kept, frequencies
/// come out at or above those of the full model.
///
/// @param body      full matrices
/// @param interface DoFs kept, distinct; they become the first coordinates, in this order
/// @param num_modes fixed-interface modes kept, 0 .. number of interior DoFs
/// @param watched   DoFs whose displacement is wanted, in the order of `rows`; `BodyMatrices::held`
///                  gives a row of zeros
/// @throws std::invalid_argument if a DoF is out of range or doubled, or num_modes too large
/// @throws NumericalError if the interior stiffness is singular or the eigensolver fails
/// Cost: one sparse factorisation, one solve per interface DoF, about 2 num_modes + 20 more.
ReducedBody make_craig_bampton(const BodyMatrices& body, std::span<const int> interface,
                               Eigen::Index num_modes, std::span<const int> watched);

}  // namespace stridor
