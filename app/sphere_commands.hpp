// The verbs that only scenes of a sphere on a viscoelastic substrate have.
#pragma once

#include "app/command.hpp"

namespace stridor {

void add_cycle_command(CLI::App& program, Action& action, const std::string& command_line);
void add_sweep_command(CLI::App& program, Action& action, const std::string& command_line);

}  // namespace stridor
