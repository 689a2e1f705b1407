// The step of a simulation as a linear map, its sliding held.
#pragma once

#include <complex>
#include <optional>
#include <vector>

#include "coupling/system/system.hpp"
#include "solvers/eigenvalues/pencil.hpp"
#include "solvers/integrators/coupled_step.hpp"
#include "solvers/integrators/time_parameters.hpp"

namespace stridor {

/// One step, prediction and correction, of bodies whose contacts slide with rows that stay as they
/// are (docs/theory.md, 3.7). Loads and drive drop out, so that the step is a linear map of the
/// state. The motions of the bodies change in a step by factors z with |z| at most the spectral
/// radius.
///
/// With C = B_C S and E = B_E S the rows of all modes, and s, k, e, g the coefficients of their
/// scheme,
///
///   r_{n+1} = r_n + d_{n+1},   d_{n+1} = s d_n − k r_n − e Eᵀ λ_n
///
/// where λ_n closes the gaps at t_{n+1}, or those at t_n where bodies answer at once:
///
///   (C e Eᵀ) λ_n = C (r_n + s d_n − k r_n),   or   (C g Eᵀ + Σ w R_b) λ_n = C r_n − Σ (1 − w) R_b
///   λ~, λ~_n = w λ_n + (1 − w) λ~_{n−1}
///
/// A penalty adds its compliance c to the diagonal on the left, as the gap is −c λ_n then. Tangents
/// that stick beside springs on faces (has_springs_on_faces()) are sought at t_{n+1}, under a force
/// that stays:
///
///   (C (e + g) Eᵀ + Σ R_b) λ_n = C (r_n + s d_n − k r_n)
///
/// Here R_b = B_C R B_Eᵀ of the modes that body b leaves out, and λ~ is the force as they feel it.
/// Bodies with coupled terms have the matrices of their CoupledStep in place of s, k, e and g.
class FrozenStep {
 public:
  /// As a simulation takes it up: with the modes that `time` keeps, and added_feedthrough().
  /// @param system with all modes; referenced as long as this is used
  FrozenStep(const System& system, const TimeParameters& time);
  /// With another added.
  FrozenStep(const System& system, const TimeParameters& time, std::optional<double> added);

  double step() const { return time_.step; }
  Integrator integrator() const { return time_.integrator; }

  /// All factors by which motions change in a step, conjugates one by one, in no order; those of
  /// rigid gaps, which one step closes, are 0.
  /// @param contacts rows of sliding or sticking contacts on all modes of the system, with their
  ///                 damping and compliance (linearise_constraints()); G and H, which turn the
  ///                 rows with the motion, are left out
  /// @throws std::invalid_argument as check_pencil(), or if it has other modes than the system
  /// @throws NumericalError if no contact forces close the gaps: the contact jams
  /// Cost: of order 20 n² k² operations for n modes that move and k contacts (step_factors()), and
  /// 10 (2n)³ for few modes, for bodies with coupled terms and where that finds not all of them.
  std::vector<std::complex<double>> factors(const Pencil& contacts) const;

 private:
  const System* system_;
  TimeParameters time_;
  std::optional<double> added_;
  double cutoff_;                     ///< ω of the last mode that moves, rad/s
  std::vector<CoupledStep> coupled_;  ///< of the bodies with coupled terms, in their order
};

/// The largest of some factors, |z|.
double spectral_radius(const std::vector<std::complex<double>>& factors);

}  // namespace stridor
