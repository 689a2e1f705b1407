// What is wrong with a command line that makes no command.
#pragma once

#include <CLI/CLI.hpp>
#include <string>
#include <vector>

#include "core/refusals.hpp"

namespace stridor {

struct CommandProblem {
  Refusal refusal;
  std::string message;
  std::string verb;  ///< that was given; empty where there is none like it
};

/// What the user sees of an error of parsing: an unknown verb or option with the nearest that there
/// is, a required option with its meaning, else what CLI11 says.
/// @param words behind the name of the program
CommandProblem problem_of_command(CLI::App& program, const CLI::ParseError& error,
                                  const std::vector<std::string>& words);

}  // namespace stridor
