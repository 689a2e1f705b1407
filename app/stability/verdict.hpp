// How far a verdict about stability reaches: up to which frequency, and between which values.
#pragma once

#include <complex>
#include <span>
#include <string>

#include "analysis/locus.hpp"
#include "coupling/system/system.hpp"
#include "io/scene/scene_family.hpp"
#include "solvers/eigenvalues/secular_eigenvalues.hpp"

namespace stridor {

/// Up to where a verdict over some of the lowest eigenvalues holds, Hz: to the highest that was
/// computed, to where the window ends, and no further than the model is valid.
double verdict_limit(std::span<const std::complex<double>> eigenvalues,
                     const SpectrumWindow& window, double trusted);
/// The same for all values of a locus.
double verdict_limit(const Locus& locus, const SpectrumWindow& window, double trusted);
/// "the verdict holds between 0 and 7494.83 Hz"
std::string window_text(double highest);
/// Why a verdict reaches no further, in brackets; empty where it does not end.
/// @param trusted up to where the model is valid, Hz
std::string limit_text(double highest, double trusted);

/// Validity of a verdict between the values of a range: "everywhere", or "at all values
/// looked at" where something may have been missed.
std::string reach_text(const Locus& locus);
/// Prints which parts of a locus may have been missed, if any.
void print_resolution(const Locus& locus, const NumericKey& key);

/// Frequency up to which the reduced bodies respond as the full ones, Hz; infinite where no mode is
/// truncated.
///
/// It is half the frequency of the highest fixed-interface mode that any body keeps. Below it the
/// contribution of the truncated modes is quasi-static up to a share of (f/f_cut)² ≤ 1/4, and that
/// is a share of a residual flexibility which the constraint modes already carry. The first
/// fixed-interface mode of a body that keeps none is unknown; such a body gives no limit.
double trusted_frequency(const System& system);

}  // namespace stridor
