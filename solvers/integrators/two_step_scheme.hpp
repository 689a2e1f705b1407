// Coefficients of the two-step schemes for one mode.
#pragma once

namespace stridor {

/// One step of one mode, q̈ + c q̇ + ω² q = p (docs/theory.md, 3.2):
///
///   d_{n+1} = s d_n − k r_n + e p_n,  r_{n+1} = r_n + d_{n+1},  q_n = r_n + g p_n
///
/// All schemes have this form, most of them with g = 0. The static response is e + k g = k/ω² in
/// each, and e ≥ 0: g is at most 1/ω².
struct StepCoefficients {
  double keep;          ///< s: part of the increment that the next step keeps
  double pull;          ///< k: restoring increment per unit position
  double gain;          ///< e: displacement in a step per unit modal force, s²
  double feedthrough = 0.0;  ///< g: instantaneous displacement per unit modal force, s²

  /// e + k g, by which loads act that do not change within a step.
  double answer() const { return gain + pull * feedthrough; }
};

/// Central difference with backward-difference damping (BDF):
///
///   s = 1 − h c,  k = h² ω²,  e = h²
///
/// @param omega   ω ≥ 0, rad/s
/// @param damping c, 1/s
/// @param step    h > 0, s; stable up to 4/(c + √(c² + 4 ω²))
/// @param added δ: with g = min(δ h², 1/ω²) in place of 0
StepCoefficients central_difference(double omega, double damping, double step,
                                    double added = 0.0);

/// Exact free motion and static response; under a force exp(iΩt) the error is of fourth order in
/// Ωh, with damping of third order times c/ω, whatever ωh is (docs/theory.md, 3.5):
///
///   s = r₁ r₂,  k = (1 − r₁)(1 − r₂),  g = (1 − k/(ωh)² · ch/(1 − s))/ω² + δ k/ω²,  e = k/ω² − k g
///
/// with r₁ and r₂ the factors by which the two free motions change in a step, exp(h s₁) and
/// exp(h s₂) with s₁, s₂ the roots of s² + c s + ω². Without stiffness k = 0 and
/// e = h (1 − exp(−c h))/c; without damping, g = h²/12 + δ e.
///
/// Written so that nothing cancels, however small ω h; any damping, negative too; stable at every
/// step where c ≥ 0. Parameters as central_difference().
/// @param added δ ≥ 0, added feedthrough: costs accuracy of second order, for the stability of
///                contacts; g is not made larger than 1/ω²
StepCoefficients exact_propagation(double omega, double damping, double step, double added = 0.0);

/// The first step of a mode from a displacement and a velocity at t = 0. The force f of the
/// contacts acts with the coefficient e of every step; the prediction corrects for the excess:
///
///   d*₁ = a v₀ − ρ (k r₀ − e p) + (ρ − 1) e f
///
/// The central difference starts with d₀ = h v₀: a = s h, ρ = 1.
struct StartCoefficients {
  double rate;   ///< a, s
  double share;  ///< ρ: share of e that acts in the first step
};

/// Parameters as central_difference().
StartCoefficients central_difference_start(double damping, double step);

/// The exact motion from q₀ and v₀ under a constant force: q₁ = A q₀ + a v₀ + (1 − A)/ω² (p + f),
/// ρ = (1 − A)/k.
StartCoefficients exact_start(double omega, double damping, double step);

}  // namespace stridor
