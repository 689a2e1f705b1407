// The built program, run as a user would run it.
#pragma once

#include <sys/prctl.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <csignal>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <string>
#include <utility>
#include <vector>

#include "tests/support/temporary_folder.hpp"

namespace stridor::test {

struct ProgramResult {
  int exit_code = -1;  ///< −1 where the program died of a signal
  std::string out;
  std::string err;
};

/// Starts the program, waits for it and collects its output.
class Program {
 public:
  explicit Program(std::vector<std::string> arguments) : arguments_(std::move(arguments)) {}
  Program(const Program&) = delete;
  Program& operator=(const Program&) = delete;
  /// A test that fails leaves nothing running.
  ~Program() {
    if (child_ <= 0) return;
    kill(child_, SIGKILL);
    waitpid(child_, nullptr, 0);
  }

  /// Largest file it may write, bytes: a disk that runs full.
  Program& with_file_limit(rlim_t bytes) {
    file_limit_ = bytes;
    return *this;
  }

  /// Address space that it may take, bytes: a small machine.
  Program& with_memory_limit(rlim_t bytes) {
    memory_limit_ = bytes;
    return *this;
  }

  void start() {
    child_ = fork();
    if (child_ != 0) return;
    prctl(PR_SET_PDEATHSIG, SIGKILL);  // not to outlive a test that fails or is ended
    if (file_limit_ != RLIM_INFINITY) {
      const rlimit limit{file_limit_, file_limit_};
      setrlimit(RLIMIT_FSIZE, &limit);
    }
    if (memory_limit_ != RLIM_INFINITY) {
      const rlimit limit{memory_limit_, memory_limit_};
      setrlimit(RLIMIT_AS, &limit);
    }
    if (std::freopen((folder_ / "out").c_str(), "w", stdout) == nullptr) _exit(99);
    if (std::freopen((folder_ / "err").c_str(), "w", stderr) == nullptr) _exit(99);
    std::vector<char*> argv{const_cast<char*>(STRIDOR_PROGRAM)};
    for (std::string& argument : arguments_) argv.push_back(argument.data());
    argv.push_back(nullptr);
    execv(argv[0], argv.data());
    _exit(98);
  }

  /// A request to stop is sent as soon as the program listens to it: on a busy machine that takes
  /// its time.
  void send(int signal) const {
    if (child_ <= 0) return;  // -1 would be every process there is
    const bool is_request = signal == SIGINT || signal == SIGTERM;
    for (int i = 0; is_request && i < 3000 && !listens_or_is_over(signal); ++i) usleep(10'000);
    kill(child_, signal);
  }

  /// Threads that it has at the moment.
  std::ptrdiff_t num_threads() const {
    const std::filesystem::directory_iterator threads("/proc/" + std::to_string(child_) + "/task");
    return std::distance(begin(threads), end(threads));
  }

  ProgramResult wait() {
    int status = 0;
    waitpid(child_, &status, 0);
    child_ = -1;
    return {WIFEXITED(status) ? WEXITSTATUS(status) : -1, contents_of(folder_ / "out"),
            contents_of(folder_ / "err")};
  }

  ProgramResult run() {
    start();
    return wait();
  }

 private:
  /// By the mask of caught signals that the kernel tells.
  bool listens_or_is_over(int signal) const {
    std::ifstream status("/proc/" + std::to_string(child_) + "/status");
    if (!status) return true;
    for (std::string line; std::getline(status, line);) {
      if (line.starts_with("State:") && line.find('Z') != std::string::npos) return true;
      if (!line.starts_with("SigCgt:")) continue;
      const unsigned long long caught = std::stoull(line.substr(7), nullptr, 16);
      return ((caught >> (signal - 1)) & 1) != 0;
    }
    return false;
  }

  std::vector<std::string> arguments_;
  rlim_t file_limit_ = RLIM_INFINITY;
  rlim_t memory_limit_ = RLIM_INFINITY;
  TemporaryFolder folder_;
  pid_t child_ = -1;
};

inline std::string scene_path(const std::string& name) {
  return STRIDOR_SOURCE_DIR "/scenes/" + name;
}

}  // namespace stridor::test
