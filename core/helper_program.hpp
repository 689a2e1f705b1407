// Programs that run for this one: gnuplot, gmsh.
#pragma once

#include <deque>
#include <filesystem>
#include <string>
#include <vector>

#include "core/stop_token.hpp"

namespace stridor {

/// A folder only this user can read, removed with all that is in it, also where a signal ends the
/// program.
class ScratchFolder {
 public:
  /// @param purpose of the folder, part of its name
  /// @param files   that will be made in it
  /// @param owner   for messages: the file for which it is
  /// @throws FileError if it cannot be made
  ScratchFolder(const std::string& purpose, const std::vector<std::string>& files,
                const std::string& owner);
  ScratchFolder(const ScratchFolder&) = delete;
  ScratchFolder& operator=(const ScratchFolder&) = delete;
  ~ScratchFolder();

  std::filesystem::path operator/(const std::string& file) const { return path_ / file; }

 private:
  std::filesystem::path path_;
  std::deque<UnfinishedFile> unfinished_;
};

/// How a program ended.
struct HelperOutcome {
  int spawn_error = 0;  ///< why it could not be started; ENOENT: it is not installed
  int status = 0;       ///< as waitpid() has it
};

/// Runs a program to its end, through no shell and without input; it is ended with this one. Its
/// locale is C.UTF-8 whatever the user's is: in "C" gnuplot complains of characters that it can
/// draw.
/// @param words    the program, looked for in PATH, and its arguments
/// @param output   file for what it prints to stdout; empty: nowhere
/// @param messages file for what it prints to stderr, which may be `output`
HelperOutcome run_helper(std::vector<std::string> words, const std::string& output,
                         const std::string& messages);

}  // namespace stridor
