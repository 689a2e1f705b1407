// The verb `run` on a sphere on a viscoelastic substrate.
#pragma once

#include <string>

#include "app/command.hpp"

namespace stridor {

struct SphereRunOptions {
  CommonOptions common;
  std::string scene;
  std::string output;
  bool verify = false;
  std::string command_line;
};

/// Marches the scene with the integrator that it names, and writes samples and results.
ExitCode run_sphere(const SphereRunOptions& options);

}  // namespace stridor
