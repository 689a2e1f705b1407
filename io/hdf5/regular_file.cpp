#include "io/hdf5/regular_file.hpp"

#include <fmt/format.h>
#include <sys/stat.h>

#include "core/errors.hpp"

namespace stridor {

std::string irregular_kind(const std::string& path) {
  struct stat status = {};
  if (stat(path.c_str(), &status) != 0 || S_ISREG(status.st_mode)) return "";
  if (S_ISDIR(status.st_mode)) return "a folder";
  if (S_ISFIFO(status.st_mode)) return "a FIFO (named pipe)";
  return S_ISSOCK(status.st_mode) ? "a socket" : "a device";
}

void refuse_irregular_file(const std::string& path) {
  const std::string kind = irregular_kind(path);
  if (!kind.empty())
    throw FileError(Refusal::other_kind_of_file, path, "",
                    fmt::format("is {}, expected a regular file", kind));
}

}  // namespace stridor
