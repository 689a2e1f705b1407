// The curve on which all contacts of a paraboloid with one creep time lie.
#pragma once

#include <functional>
#include <vector>

#include "coupling/laws/viscoelastic_law.hpp"
#include "solvers/half_space/sliding_contact.hpp"

namespace stridor {

/// β of the shipped curve: 57 values, 8 per decade from 1e-3 to 1e4.
std::vector<double> master_curve_betas();

/// A master curve and how each of its points was found.
struct ComputedMasterCurve {
  MasterCurve curve;
  std::vector<SlidingContactResult> results;  ///< at δ = R = 1
  bool converged() const;
};

/// Computes the contacts of a paraboloid along β, each from the one before (docs/theory.md, 8.4).
///
/// @param modulus_ratio e_0 = E_0/E_∞ in (0, 1)
/// @param betas         ascending, > 0
/// @param advanced      called after each point with the number of points done
/// @throws std::invalid_argument as SlidingContact, or if e_0 is out of range
ComputedMasterCurve compute_master_curve(double modulus_ratio, const std::vector<double>& betas,
                                         const SlidingContactParameters& parameters,
                                         const std::function<void(std::size_t)>& advanced = {});

}  // namespace stridor
