// Reports a crash over a damaged file as what it is.
#pragma once

#include <array>
#include <csignal>
#include <string>

namespace stridor {

/// While one lives, a crash of the program ends it with exit code 4, I/O error, and a message
/// that names the file.
///
/// HDF5 trusts much of what it reads, and files in its default format carry no checksums: some
/// damage to a file makes the library follow wild pointers, when the file is opened, read or
/// closed. There is no way back from there. Let the guard outlive the reader of the file; what the
/// verb has printed by then is lost unless it was flushed.
///
/// It acts for the whole process. Several may live at once, each within the life of the one before;
/// the latest names its file.
class DamageGuard {
 public:
  /// @param path the file that is open meanwhile
  explicit DamageGuard(const std::string& path);
  DamageGuard(const DamageGuard&) = delete;
  DamageGuard& operator=(const DamageGuard&) = delete;
  ~DamageGuard();

  /// From now on a crash also prints the one JSON object of a failed verb on stdout.
  static void tell_as_json();

  static constexpr int exit_code = 4;
  static constexpr std::array<int, 5> crashes{SIGSEGV, SIGBUS, SIGFPE, SIGILL, SIGABRT};

 private:
  std::string last_words_;
  std::string json_;
  const DamageGuard* outer_ = nullptr;
  std::array<struct sigaction, crashes.size()> former_actions_{};
  stack_t former_stack_{};
};

}  // namespace stridor
