// The error of a transient, from a finer run beside it.
#pragma once

#include <functional>
#include <string>

#include "app/runs/studied_scene.hpp"

namespace stridor {

/// The error of a transient as its scene sets it up.
struct ErrorEstimate {
  RunErrors errors;      ///< differences from the finer run; NaN where that cannot tell
  double step = 0.0;     ///< of the finer run, s
  std::string failure;   ///< why there is none; empty where there is one
  double seconds = 0.0;  ///< that it has taken
};

/// Runs a scene as it is, and by exact propagation of all modes at half the step, and sets one
/// against the other. At order p in the step the difference is 1 − 2⁻ᵖ of the error by the step,
/// half of it or more, and it contains the full error of the truncated modes.
/// @param on_progress receives the part done
ErrorEstimate estimate_error(const StudiedScene& study,
                             const std::function<void(double)>& on_progress);

}  // namespace stridor
