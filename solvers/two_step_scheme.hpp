// Coefficients of the two-step schemes for one mode.
#pragma once

namespace stridor {

/// One step of one mode, q̈ + c q̇ + ω² q = p (docs/theory.md, 3.2):
///
///   d_{n+1} = s d_n − k q_n + e p_n,  q_{n+1} = q_n + d_{n+1}
///
/// All schemes have this form; k = ω² e in each.
struct StepCoefficients {
  double keep;  ///< s: part of the increment that the next step keeps
  double pull;  ///< k: restoring increment per unit position
  double gain;  ///< e: displacement per unit modal force, s²
};

/// Central difference with backward-difference damping (BDF):
///
///   s = 1 − h c,  k = h² ω²,  e = h²
///
/// @param omega   ω ≥ 0, rad/s
/// @param damping c, 1/s
/// @param step    h > 0, s; stable up to 4/(c + √(c² + 4 ω²))
StepCoefficients central_difference(double omega, double damping, double step);

/// Exact free motion, and exact for a force that is constant over [t_{n−1}, t_{n+1}] (of Gautschi's
/// type):
///
///   s = r₁ r₂,  k = (1 − r₁)(1 − r₂),  e = k/ω²
///
/// with r₁ and r₂ the factors by which the two free motions change in a step, exp(h s₁) and
/// exp(h s₂) with s₁, s₂ the roots of s² + c s + ω². Without stiffness k = 0 and
/// e = h (1 − exp(−c h))/c.
///
/// Written so that nothing cancels, however small ω h; any damping, negative too; stable at every
/// step where c ≥ 0. Parameters as central_difference().
StepCoefficients exact_propagation(double omega, double damping, double step);

/// The first step of a mode from a displacement and a velocity at t = 0. The force f of the
/// contacts acts with the gain of every step, so the prediction makes up for what that is too much:
///
///   d*₁ = r v₀ − ρ (k q₀ − e p) + (ρ − 1) e f
///
/// The central difference starts with d₀ = h v₀: r = s h, ρ = 1.
struct StartCoefficients {
  double rate;   ///< r, s
  double share;  ///< ρ: part of a step's gain that acts in the first step
};

/// Parameters as central_difference().
StartCoefficients central_difference_start(double damping, double step);

/// The exact motion from q₀ and v₀ under a constant force: q₁ = A q₀ + r v₀ + (1 − A)/ω² (p + f),
/// ρ = (1 − A)/k.
StartCoefficients exact_start(double omega, double damping, double step);

}  // namespace stridor
