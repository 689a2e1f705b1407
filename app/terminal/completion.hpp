// Candidates for a word of the command line, for completion in shells.
#pragma once

#include <CLI/CLI.hpp>
#include <string>
#include <vector>

namespace stridor {

/// A word that fits, and what it is.
struct Candidate {
  std::string word;
  std::string meaning;
};

/// Candidates for the last of some words behind the name of the program: verbs, options of the
/// verb, values of an option that has a list of them, keys of the scene that is named after `--set`
/// (with `=`, and behind that its choices) and where a key is varied, channels of the run file that
/// is named after `--channel`. None where a file may stand. The last word may be `--option=value`.
/// @param behind words of the line behind that one, which may name the scene or the run file
std::vector<Candidate> candidates(const CLI::App& program, std::vector<std::string> words,
                                  const std::vector<std::string>& behind);

}  // namespace stridor
