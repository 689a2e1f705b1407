// The results of a run in words.
#pragma once

#include <string>

#include "app/terminal/command.hpp"

namespace stridor {

/// Prints the results of a run from step to step.
/// @param results as a run file holds them (docs/files.md)
/// @param output  the run file
void print_summary(const Json& results, const std::string& output);
/// The same of a run from event to event.
void print_cycles(const Json& results, const std::string& output);

}  // namespace stridor
