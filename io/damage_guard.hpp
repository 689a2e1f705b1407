// Reports a crash over a damaged file as what it is.
#pragma once

#include <string>

namespace stridor {

/// While one lives, a crash of the program ends it with ExitCode::file_trouble and a message that
/// names the file.
///
/// HDF5 trusts much of what it reads, and files in its default format carry no checksums: some
/// damage to a file makes the library follow wild pointers, when the file is opened, read or
/// closed. There is no way back from there. Let the guard outlive the reader of the file.
///
/// At most one may live at a time; it acts for the whole process.
class DamageGuard {
 public:
  /// @param path the file that is open meanwhile
  explicit DamageGuard(const std::string& path);
  DamageGuard(const DamageGuard&) = delete;
  DamageGuard& operator=(const DamageGuard&) = delete;
  ~DamageGuard();

 private:
  std::string last_words_;
};

}  // namespace stridor
