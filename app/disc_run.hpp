// The verb `run` on a disc between pads.
#pragma once

#include <string>

#include "app/command.hpp"

namespace stridor {

struct DiscRunOptions {
  CommonOptions common;
  std::string scene;
  std::string output;
  bool verify = false;
  std::string command_line;
};

/// Marches the scene from a perturbed steady sliding, and writes samples and results.
/// @throws ConfigError if the scene is no disc, or lacks what a run needs
ExitCode run_disc(const DiscRunOptions& options);

}  // namespace stridor
