// Concurrent use of BLAS by several threads.
#pragma once

#include <mutex>
#include <string_view>

namespace stridor {

/// Whether several threads may be in BLAS concurrently. A build of OpenBLAS without locks hands the
/// same work space to all, and their results are rarely, and slightly, wrong; those for POSIX
/// threads and for OpenMP do not. Of another BLAS nothing is known, so it is taken for one of the
/// former.
bool is_blas_reentrant();

/// Makes BLAS, and CHOLMOD, which uses it, compute in the calling thread alone: tasks share the
/// processors' time, and sums must not depend on the number of processors. Done for the first
/// thread before main().
void keep_blas_in_this_thread();

/// Complex numbers behind the end of a vector that must be readable: OpenBLAS 0.3.21 (zgemv for
/// Haswell) reads some of them.
constexpr int read_beyond_vectors = 16;

/// Kernels to ask OpenBLAS for, as its variable OPENBLAS_CORETYPE names them; empty where those
/// that it took are wide enough.
///
/// It chooses them by the model of the processor. Of one that is younger than the library it knows
/// nothing and takes those for vectors of two numbers, with which dense products take five times as
/// long as with those for eight.
/// @param taken name of the kernels taken
std::string_view blas_kernels_to_ask_for(std::string_view taken, bool has_avx2, bool has_avx512);

/// Held while work in several threads may pass dense products to BLAS: where BLAS is not reentrant,
/// one thread holds it at a time, else it does nothing.
class BlasGuard {
 public:
  BlasGuard();

 private:
  std::unique_lock<std::mutex> lock_;
};

}  // namespace stridor
