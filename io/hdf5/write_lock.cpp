#include "io/hdf5/write_lock.hpp"

#include <fcntl.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>

#include "core/errors.hpp"

namespace stridor {

bool lock_for_writing(int descriptor) {
  return flock(descriptor, LOCK_EX | LOCK_NB) == 0 || errno != EWOULDBLOCK;
}

bool is_named(int descriptor, const std::string& path) {
  struct stat mine = {};
  struct stat named = {};
  return fstat(descriptor, &mine) == 0 && stat(path.c_str(), &named) == 0 &&
         mine.st_ino == named.st_ino && mine.st_dev == named.st_dev;
}

void throw_being_written(const std::string& path) {
  throw FileError(Refusal::file_is_written, path, "",
                  "another process is writing it, a run that goes on; wait for its end or stop "
                  "it (Ctrl-C leaves a checkpoint)");
}

WriteLock::WriteLock(const std::string& path)
    : descriptor_(::open(path.c_str(), O_RDONLY | O_NONBLOCK | O_CLOEXEC)) {
  if (descriptor_ < 0) return;
  // The process that wrote it may have replaced it by a copy meanwhile (StagedFile).
  if (lock_for_writing(descriptor_) && is_named(descriptor_, path)) return;
  ::close(descriptor_);
  throw_being_written(path);
}

WriteLock::~WriteLock() {
  if (descriptor_ >= 0) ::close(descriptor_);
}

}  // namespace stridor
