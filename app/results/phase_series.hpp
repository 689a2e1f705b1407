// The two series of a run that a phase plot sets against each other.
#pragma once

#include <string>
#include <utility>
#include <vector>

#include "app/results/pictures.hpp"
#include "io/figures/phase_plot.hpp"

namespace stridor {

/// The series across and up: of two channels these; of one it with its partner, a displacement with
/// its velocity or a position along the master with the slip velocity; of none the first such pair.
/// @throws ConfigError at --channel if there are more, or what is shown has not been recorded
std::pair<std::string, std::string> phase_series(const std::vector<std::string>& channels,
                                                 const RecordedStretch& run);

/// A word about a path that is too coarse to be smooth; empty where it is fine.
/// @param interval between samples, s
std::string resolution_text(const PhaseAxis& axis, double interval);

}  // namespace stridor
