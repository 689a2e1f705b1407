// Options of the verb sweep, and its work on every kind of scene.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "app/stability/key_range.hpp"
#include "app/terminal/command.hpp"

namespace stridor {

struct SweepOptions {
  CommonOptions common;
  std::string scene;
  RangeOptions range;
  std::string scale = "linear";
  bool is_up_and_down = false;
  std::optional<std::string> output;
  std::optional<std::string> figure;
  std::string command_line;

  Spacing spacing() const { return scale == "log" ? Spacing::logarithmic : Spacing::linear; }
};

/// Limit cycles of one mass on a half-space.
ExitCode sweep_cycles(const SweepOptions& options, const LoadedScene& loaded);
/// Transients, each from the initial state of the scene.
ExitCode sweep_transients(const SweepOptions& options, const LoadedScene& loaded);

}  // namespace stridor
