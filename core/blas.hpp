// BLAS from several threads at once.
#pragma once

#include <mutex>

namespace stridor {

/// Whether several threads may be in BLAS at once. A build of OpenBLAS without locks hands the same
/// work space to all, and their results are rarely, and slightly, wrong; those for POSIX threads
/// and for OpenMP do not. Of another BLAS nothing is known, so it is taken for one of the former.
bool is_blas_reentrant();

/// Lets BLAS compute what the calling thread asks for in that thread alone: what several tasks
/// share is the processors' time, and sums must not depend on how many processors there are. Done
/// for the first thread before main().
void keep_blas_in_this_thread();

/// Held while dense products may go to BLAS by what runs in several threads: where BLAS is not
/// reentrant, one thread holds it at a time, else it does nothing.
class BlasGuard {
 public:
  BlasGuard();

 private:
  std::unique_lock<std::mutex> lock_;
};

}  // namespace stridor
