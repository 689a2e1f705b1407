#include "core/blas_memory.hpp"

#include <fmt/format.h>
#include <sys/mman.h>
#include <sys/resource.h>
#include <sys/syscall.h>
#include <unistd.h>

#include <string_view>

// Declared as Eigen does, which the precompiled headers hold.
extern "C" int dtrsm_(const char* side, const char* triangle, const char* transposed,
                      const char* diagonal, const int* rows, const int* columns,
                      const double* factor, const double* a, const int* stride_a, double* b,
                      const int* stride_b);

namespace stridor {
namespace {

/// Memory that OpenBLAS 0.3 takes on x86-64 where it chooses its kernels at run time, the largest
/// of all its builds. Pages that are not touched cost nothing.
constexpr std::size_t work_space = std::size_t{128} << 20;

bool is_room_for(std::size_t bytes) {
  void* room = mmap(nullptr, bytes, PROT_READ | PROT_WRITE, MAP_PRIVATE | MAP_ANONYMOUS, -1, 0);
  if (room == MAP_FAILED) return false;
  munmap(room, bytes);
  return true;
}

/// Builds with threads take a work space for every processor when they are loaded, and ask for it
/// for ever where there is none. Runs before anything that is loaded does, and before the C library
/// is ready for more than system calls.
__attribute__((no_sanitize("address", "undefined", "thread"))) void check_room_for_threads() {
  rlimit limit{};
  if (syscall(SYS_prlimit64, 0, RLIMIT_AS, nullptr, &limit) != 0 || limit.rlim_cur == RLIM_INFINITY)
    return;
  unsigned char processors[128] = {};
  const long num_bytes = syscall(SYS_sched_getaffinity, 0, sizeof processors, processors);
  std::size_t num_processors = 0;
  for (long i = 0; i < num_bytes; ++i)
    num_processors += static_cast<std::size_t>(__builtin_popcount(processors[i]));
  if (is_room_for((num_processors > 0 ? num_processors : 1) * work_space)) return;
  constexpr std::string_view message =
      "stridor: out of memory\nthe library of linear algebra (BLAS) needs 128 MiB of address space "
      "for every processor; raise the limit (ulimit -v) or free memory\n";
  // Whether it is heard or not, there is nothing else to do.
  [[maybe_unused]] const ssize_t written =
      write(STDERR_FILENO, message.data(), message.size());
  _exit(1);
}

__attribute__((section(".preinit_array"), used)) void (*const before_libraries)() =
    check_room_for_threads;

}  // namespace

void reserve_blas_memory() {
  if (!is_room_for(work_space)) {
    throw BlasMemoryError(
        fmt::format("the library of linear algebra (BLAS) needs {} MiB of address space; raise the "
                    "limit (ulimit -v) or free memory",
                    work_space >> 20));
  }
  const int one = 1;
  const double number = 1.0;
  double solution = 1.0;
  dtrsm_("L", "L", "N", "N", &one, &one, &number, &number, &one, &solution, &one);
}

}  // namespace stridor
