// Modes of a pencil above a frequency replaced by few that answer below it as they do.
#pragma once

#include "solvers/eigenvalues/pencil.hpp"

namespace stridor {

/// Modes above a frequency replaced by few that answer at lower frequencies as they do.
///
/// Between the ports the dropped modes answer as
///
///   Σ φφᵀ/(s² + c s + ω²) = R₀ − s R₁ − s² R₂ + …,
///   R₀ = Σ φφᵀ/ω²,  R₁ = Σ c φφᵀ/ω⁴,  R₂ = Σ φφᵀ/ω⁴ up to (c/ω)²
///
/// (docs/theory.md, 7.1): static flexibility, its damping, its inertia. In the basis x with
/// xᵀ R₀ x = 1 in which R₂ is diagonal, with entries 1/ω_r², at most m residual modes of
/// frequencies ω_r and damping c_r = ω_r² xᵀ R₁ x reproduce R₀ and R₂ exactly, and R₁ as well where
/// the damping of every body is proportional.
///
/// @param cutoff ω, rad/s, > 0: modes with a larger ω are replaced, but for those with coupled
/// terms
/// @return the modes up to `cutoff`, in their order, then the residual modes, all above it; the
///         rest as in `pencil`
/// @throws std::invalid_argument if `cutoff` is not positive, or as check_pencil() for either
/// pencil
Pencil with_residual_modes(const Pencil& pencil, double cutoff);

}  // namespace stridor
