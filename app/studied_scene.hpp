// A scene whose transients are set against each other: what is looked at, and where.
#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <string>

#include "analysis/error_norms.hpp"
#include "analysis/precision_study.hpp"
#include "io/scene.hpp"
#include "models/model.hpp"

namespace stridor {

/// The scene, its system and what is looked at: the contact forces and the motion of a point at
/// every multiple of `record.interval`. The point is that of the acceleration by which `run` sums
/// up, else of the first channel that is of a point.
struct StudiedScene {
  LoadedScene loaded;
  Model model;
  std::string channel;
  ObservedRow observed;
  double interval = 0.0;         ///< s
  std::int64_t num_samples = 0;  ///< after that at t = 0
  NormParameters norms;

  double end() const { return static_cast<double>(num_samples) * interval; }
};

/// @param until as given with --until, where the study ends before the scene
/// @throws ConfigError with places in the scene, where no point is recorded and where the
///         time is too short for a window; FileError, NumericalError
StudiedScene study_scene(LoadedScene loaded, const std::optional<std::string>& until = {});

/// The error of a transient as its scene sets it up.
struct ErrorEstimate {
  RunErrors errors;      ///< differences from the finer run; NaN where that cannot tell
  double step = 0.0;     ///< of the finer run, s
  std::string failure;   ///< why there is none; empty where there is one
  double seconds = 0.0;  ///< that it has taken
};

/// Runs a scene as it is, and by exact propagation of all modes at half the step, and sets one
/// against the other. At order p in the step the difference is 1 − 2⁻ᵖ of the error by the step,
/// half of it or more, and what modes left out do is all in it.
/// @param on_progress is told the part done
ErrorEstimate estimate_error(const StudiedScene& study,
                             const std::function<void(double)>& on_progress);

}  // namespace stridor
