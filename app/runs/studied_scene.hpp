// A scene whose transients are compared with each other: quantities compared, and where.
#pragma once

#include <cstdint>
#include <optional>
#include <string>

#include "analysis/error_norms.hpp"
#include "analysis/precision_study.hpp"
#include "io/scene/scene.hpp"
#include "models/model.hpp"

namespace stridor {

/// The scene, its system and the quantities compared: the contact forces and the motion of a point
/// at every multiple of `record.interval`. The point is that of the acceleration by which `run`
/// sums up, else of the first channel that is of a point.
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

}  // namespace stridor
