#include "core/helper_program.hpp"

#include <fcntl.h>
#include <fmt/format.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cerrno>
#include <cstdlib>
#include <cstring>
#include <string_view>
#include <system_error>

#include "core/errors.hpp"

extern char** environ;

namespace stridor {

namespace fs = std::filesystem;

ScratchFolder::ScratchFolder(const std::string& purpose, const std::vector<std::string>& files,
                             const std::string& owner) {
  std::error_code error;
  const fs::path base = fs::temp_directory_path(error);
  if (error)
    throw FileError(Refusal::cannot_write, owner, "",
                    "cannot make a temporary folder (see TMPDIR): " + error.message());
  std::string pattern = (base / ("stridor-" + purpose + "-XXXXXX")).string();
  if (mkdtemp(pattern.data()) == nullptr) {
    throw FileError(
        Refusal::cannot_write, owner, "",
        fmt::format("cannot make a temporary folder '{}': {}", pattern, std::strerror(errno)));
  }
  path_ = pattern;
  for (const std::string& file : files) unfinished_.emplace_back((path_ / file).string());
  unfinished_.emplace_back(path_.string());
}

ScratchFolder::~ScratchFolder() {
  std::error_code ignored;
  fs::remove_all(path_, ignored);
}

HelperOutcome run_helper(std::vector<std::string> words, const std::string& output,
                         const std::string& messages) {
  std::vector<char*> arguments;
  arguments.reserve(words.size() + 1);
  for (std::string& word : words) arguments.push_back(word.data());
  arguments.push_back(nullptr);
  std::string locale = "LC_ALL=C.UTF-8";
  std::vector<char*> environment{locale.data()};
  for (char** variable = environ; *variable != nullptr; ++variable) {
    if (!std::string_view(*variable).starts_with("LC_ALL=")) environment.push_back(*variable);
  }
  environment.push_back(nullptr);
  posix_spawn_file_actions_t actions;
  posix_spawn_file_actions_init(&actions);
  const auto open_for = [&](int number, const std::string& path) {
    posix_spawn_file_actions_addopen(&actions, number, path.c_str(), O_WRONLY | O_CREAT | O_APPEND,
                                     0600);
  };
  posix_spawn_file_actions_addopen(&actions, STDIN_FILENO, "/dev/null", O_RDONLY, 0);
  open_for(STDOUT_FILENO, output.empty() ? "/dev/null" : output);
  open_for(STDERR_FILENO, messages);
  pid_t child = -1;
  HelperOutcome outcome;
  outcome.spawn_error = posix_spawnp(&child, arguments.front(), &actions, nullptr, arguments.data(),
                                     environment.data());
  posix_spawn_file_actions_destroy(&actions);
  if (outcome.spawn_error != 0) return outcome;
  const HelperProcess helper(child);
  while (waitpid(child, &outcome.status, 0) < 0 && errno == EINTR) {
  }
  return outcome;
}

}  // namespace stridor
