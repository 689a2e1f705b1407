#include "core/blas_memory.hpp"

#include <fmt/format.h>
#include <sys/mman.h>

// Declared as Eigen does, which the precompiled headers hold.
extern "C" int dtrsm_(const char* side, const char* triangle, const char* transposed,
                      const char* diagonal, const int* rows, const int* columns,
                      const double* factor, const double* a, const int* stride_a, double* b,
                      const int* stride_b);

namespace stridor {
namespace {

/// What OpenBLAS 0.3 takes on x86-64 where it chooses its kernels at run time, the largest of all
/// its builds. Pages that are not touched cost nothing.
constexpr std::size_t work_space = std::size_t{128} << 20;

}  // namespace

void reserve_blas_memory() {
  void* room =
      mmap(nullptr, work_space, PROT_READ | PROT_WRITE, MAP_PRIVATE | MAP_ANONYMOUS, -1, 0);
  if (room == MAP_FAILED) {
    throw BlasMemoryError(
        fmt::format("the library of linear algebra (BLAS) needs {} MiB of address space; raise the "
                    "limit (ulimit -v) or free memory",
                    work_space >> 20));
  }
  munmap(room, work_space);
  const int one = 1;
  const double number = 1.0;
  double solution = 1.0;
  dtrsm_("L", "L", "N", "N", &one, &one, &number, &number, &one, &solution, &one);
}

}  // namespace stridor
