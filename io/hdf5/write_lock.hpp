// One process writes a file at a time: who writes one holds a lock on it, readers do not ask.
#pragma once

#include <string>

namespace stridor {

/// Keeps other processes from writing the file as long as the descriptor is open.
/// @return false where another one holds it. Some file systems know no locks: true there.
bool lock_for_writing(int descriptor);

/// Whether the file that is open has this name.
bool is_named(int descriptor, const std::string& path);

/// That another process writes the file.
[[noreturn]] void throw_being_written(const std::string& path);

/// Keeps other processes from writing a file that is to be replaced.
class WriteLock {
 public:
  /// @throws FileError if another process is writing the file, or replaces it
  explicit WriteLock(const std::string& path);
  WriteLock(const WriteLock&) = delete;
  WriteLock& operator=(const WriteLock&) = delete;
  ~WriteLock();

  /// False where there is no such file, or none that may be read.
  bool is_held() const { return descriptor_ >= 0; }

 private:
  int descriptor_;
};

}  // namespace stridor
