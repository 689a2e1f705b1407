// Retained modes, and truncated modes represented by their residual flexibility.
#pragma once

#include "coupling/system/system.hpp"
#include "solvers/integrators/time_parameters.hpp"

namespace stridor {

/// Circular frequency up to which `time.retain` retains modes, rad/s; infinite if it retains all.
///
/// For a requested error it is the lowest with which, at every place that a contact passes until
/// time.end and every frequency Ω up to RetainParameters::upper,
///
///   Δ(Ω) ≤ error · Ω f'(Ω),  f = Σ b²/(ω² − Ω²),  Δ = Σ_left b² Ω²/(ω² (ω² − Ω²))
///
/// with b the entries of the modes of both bodies along the normal of the undeformed master: Δ, the
/// inertia that is neglected, shifts the zeros of f, the frequencies of the bodies in contact
/// without friction, by Δ/f' (docs/theory.md, 3.6). Of a system without contacts it is infinite.
double asked_frequency(const System& system, const TimeParameters& time);
/// That, but with exact propagation not more than the step resolves, ω h = 2.
/// @throws ConfigError for `time.retain.error` where the step does not resolve the modes needed
double retained_frequency(const System& system, const TimeParameters& time);
/// The system with those modes in its bodies and the residual flexibility of the truncated ones.
System retained(const System& system, const TimeParameters& time);

}  // namespace stridor
