// Windows in which the real part of a followed eigenvalue is positive.
#pragma once

#include "analysis/branch_tracker.hpp"

namespace stridor {

/// Refines the samples of a track until they show every change of sign of the growth, and appends
/// its windows and crossings to the locus (trace_locus()).
///
/// @param branch index of the track
void find_windows(SpectrumSource& source, const LocusOptions& options, const Grid& grid,
                  Track& track, int branch, Locus& locus);

}  // namespace stridor
