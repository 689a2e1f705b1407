// Stands before the functions of the C library by which files are written (see write_faults.hpp):
// linked into a test, its definitions come first for all libraries, HDF5 too. No rights are needed
// as for tracing a process.
#include "tests/support/write_faults.hpp"

#include <dlfcn.h>
#include <fcntl.h>
#include <signal.h>
#include <sys/stat.h>
#include <sys/types.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstdio>

namespace stridor::test {

FaultPlan* fault_plan = nullptr;

namespace {

[[noreturn]] void die() {
  kill(getpid(), SIGKILL);
  for (;;) pause();
}

/// Counts a call. @return what befalls it; a death before it has come already
Fault next_fault() {
  if (fault_plan == nullptr) return Fault::none;
  FaultPlan& plan = *fault_plan;
  const long number = ++plan.count;
  switch (plan.fault) {
    case Fault::none:
      break;
    case Fault::kill:
      if (number == plan.at) die();
      break;
    case Fault::torn:
      if (number == plan.at) return Fault::torn;
      break;
    case Fault::no_space_kill:
      if (number == plan.death) die();
      [[fallthrough]];
    case Fault::no_space:
      if (number == plan.at) return Fault::no_space;
      break;
    case Fault::full:
      if (number >= plan.at) return Fault::no_space;
      break;
  }
  return Fault::none;
}

bool is_watched(int descriptor) {
  struct stat status = {};
  return fault_plan != nullptr && descriptor > STDERR_FILENO && fstat(descriptor, &status) == 0 &&
         S_ISREG(status.st_mode);
}

template <class Function>
Function* library_function(const char* name) {
  return reinterpret_cast<Function*>(dlsym(RTLD_NEXT, name));
}

/// A call that is done or not, without a middle.
template <class Call>
int whole_call(const Call& call) {
  switch (next_fault()) {
    case Fault::torn:
      call();
      die();
    case Fault::no_space:
      errno = ENOSPC;
      return -1;
    default:
      return call();
  }
}

template <class Call>
ssize_t write_call(int descriptor, size_t size, const Call& call) {
  constexpr size_t page = 4096;
  if (!is_watched(descriptor)) return call(size);
  switch (next_fault()) {
    case Fault::torn:
      call(std::min(size, page));
      die();
    case Fault::no_space:
      errno = ENOSPC;
      return -1;
    default:
      return call(size);
  }
}

ssize_t positioned_write(int descriptor, const void* bytes, size_t size, off_t offset) {
  static const auto next = library_function<ssize_t(int, const void*, size_t, off_t)>("pwrite64");
  return write_call(descriptor, size,
                    [&](size_t count) { return next(descriptor, bytes, count, offset); });
}

int set_length(int descriptor, off_t length) {
  static const auto next = library_function<int(int, off_t)>("ftruncate64");
  if (!is_watched(descriptor)) return next(descriptor, length);
  return whole_call([&] { return next(descriptor, length); });
}

int allocate(int descriptor, off_t offset, off_t length) {
  static const auto next = library_function<int(int, off_t, off_t)>("posix_fallocate64");
  if (!is_watched(descriptor)) return next(descriptor, offset, length);
  const int status = whole_call([&] { return next(descriptor, offset, length); });
  return status == -1 ? ENOSPC : status;
}

}  // namespace
}  // namespace stridor::test

extern "C" {

ssize_t write(int descriptor, const void* bytes, size_t size) {
  static const auto next =
      stridor::test::library_function<ssize_t(int, const void*, size_t)>("write");
  return stridor::test::write_call(descriptor, size,
                                   [&](size_t count) { return next(descriptor, bytes, count); });
}
ssize_t pwrite(int descriptor, const void* bytes, size_t size, off_t offset) {
  return stridor::test::positioned_write(descriptor, bytes, size, offset);
}
ssize_t pwrite64(int descriptor, const void* bytes, size_t size, off_t offset) {
  return stridor::test::positioned_write(descriptor, bytes, size, offset);
}
int ftruncate(int descriptor, off_t length) noexcept {
  return stridor::test::set_length(descriptor, length);
}
int ftruncate64(int descriptor, off_t length) noexcept {
  return stridor::test::set_length(descriptor, length);
}
int posix_fallocate(int descriptor, off_t offset, off_t length) {
  return stridor::test::allocate(descriptor, offset, length);
}
int posix_fallocate64(int descriptor, off_t offset, off_t length) {
  return stridor::test::allocate(descriptor, offset, length);
}
int fsync(int) {
  // Nothing here outlives the machine: the disk need not be waited for.
  return stridor::test::fault_plan == nullptr ? 0 : stridor::test::whole_call([] { return 0; });
}
int rename(const char* from, const char* to) noexcept {
  static const auto next = stridor::test::library_function<int(const char*, const char*)>("rename");
  return stridor::test::whole_call([&] { return next(from, to); });
}
int renameat2(int from_folder, const char* from, int to_folder, const char* to,
              unsigned flags) noexcept {
  static const auto next =
      stridor::test::library_function<int(int, const char*, int, const char*, unsigned)>(
          "renameat2");
  return stridor::test::whole_call([&] { return next(from_folder, from, to_folder, to, flags); });
}
int unlink(const char* path) noexcept {
  static const auto next = stridor::test::library_function<int(const char*)>("unlink");
  return stridor::test::whole_call([&] { return next(path); });
}

}  // extern "C"
