// A window of sliding contact by Siconos.
#pragma once

#include "bench/sliding_window.hpp"

namespace stridor::bench {

/// march_siconos() of a window with the reduced matrices, as they are (the modal ones, stored
/// sparse, take Siconos twice the time); the force at t_k is the mean of the impulses before and
/// after it by h.
/// @param step h, s; a whole fraction of the interval between samples
/// @throws std::runtime_error if the slave leaves its master
WindowRun run_siconos(const SlidingWindow& window, double step);

}  // namespace stridor::bench
