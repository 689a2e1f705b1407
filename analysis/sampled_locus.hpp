// Locus of a small system from all its eigenvalues at every value, without following any.
#pragma once

#include "analysis/locus.hpp"

namespace stridor {

/// Eigenvalues and unstable windows along a parameter, for systems whose eigenvalues coincide or
/// lie on the imaginary axis over whole intervals: without damping, with bodies that are alike.
///
/// At every value the dense problem is solved. An interval is unstable where any of the eigenvalues
/// wanted has a real part larger than rounding can make of zero,
///
///   Re s > min(20 ε ω_max κ, 1e-6 |s|),
///
/// κ its condition number, and its ends are bisected: where two eigenvalues meet on the axis their
/// real part grows like a square root, and the error of the end is of order ε all the same. Between
/// the values asked for at least 64 are looked at, and every negative maximum of the growth is
/// climbed; a window that lies between two of them is missed where nothing is damped.
///
/// @return no branches; `branch` of windows and crossings is 0
/// @throws as trace_locus()
Locus sample_locus(const PencilFamily& family, const std::vector<double>& values,
                   const LocusOptions& options = {});

}  // namespace stridor
