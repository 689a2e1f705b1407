// Errors of a command line that makes no command.
#pragma once

#include <CLI/CLI.hpp>
#include <string>
#include <vector>

#include "core/refusals.hpp"

namespace stridor {

/// An error of the command line, for a message and a code.
struct CommandProblem {
  Refusal refusal;  ///< its kind
  std::string message;
  std::string verb;  ///< that was given; empty where there is none like it
};

/// The error as the user is told: an unknown verb or option with the nearest that there is, a
/// required option with its meaning, else the message of CLI11.
/// @param error of program.parse()
/// @param words behind the name of the program
CommandProblem problem_of_command(CLI::App& program, const CLI::ParseError& error,
                                  const std::vector<std::string>& words);

}  // namespace stridor
