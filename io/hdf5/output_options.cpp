#include "io/hdf5/output_options.hpp"

#include <fmt/chrono.h>
#include <fmt/format.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <ctime>
#include <filesystem>
#include <sstream>

#include "core/errors.hpp"
#include "io/hdf5/hdf5_handles.hpp"
#include "io/hdf5/part_file.hpp"
#include "io/hdf5/write_lock.hpp"

namespace stridor {

void check_output(const std::string& path, Overwrite overwrite) {
  struct stat status = {};
  const std::string folder = folder_of(path);
  if (path.empty() || path.back() == '/')
    throw FileError(Refusal::cannot_write, path, "", "is not the name of a file");
  if (stat(folder.c_str(), &status) != 0) {
    throw FileError(Refusal::cannot_write, path, "",
                    fmt::format("the folder '{}' cannot be used: {}", folder, errno_text(errno)));
  }
  if (!S_ISDIR(status.st_mode))
    throw FileError(Refusal::cannot_write, path, "", fmt::format("'{}' is not a folder", folder));
  check_replaceable(path, overwrite);
  if (access(folder.c_str(), W_OK | X_OK) != 0) {
    throw FileError(Refusal::cannot_write, path, "",
                    fmt::format("cannot write in the folder '{}': {}", folder, errno_text(errno)));
  }
}

void check_replaceable(const std::string& path, Overwrite overwrite) {
  struct stat status = {};
  if (stat(path.c_str(), &status) != 0) {
    if (lstat(path.c_str(), &status) != 0 || !S_ISLNK(status.st_mode)) return;
    std::error_code unknown;
    throw FileError(Refusal::cannot_write, path, "",
                    fmt::format("is a broken link, to '{}'; remove it, or name another file",
                                std::filesystem::read_symlink(path, unknown).string()));
  }
  if (S_ISDIR(status.st_mode)) throw FileError(Refusal::cannot_write, path, "", "is a folder");
  if (!S_ISREG(status.st_mode))
    throw FileError(Refusal::cannot_write, path, "", "is not a regular file and is not replaced");
  if (overwrite == Overwrite::no)
    throw FileError(Refusal::file_exists, path, "", "exists; use --force to overwrite it");
  const WriteLock none_writes(path);
}

std::string scene_of_command(const std::string& command) {
  std::istringstream words(command);
  for (std::string word; words >> word;)
    if (word.ends_with(".yaml") || word.ends_with(".yml")) return word;
  return "";
}

std::string utc_now() {
  return fmt::format("{:%Y-%m-%dT%H:%M:%SZ}", fmt::gmtime(std::time(nullptr)));
}

}  // namespace stridor
