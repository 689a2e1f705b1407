#include "core/blas.hpp"

#include <dlfcn.h>
#include <unistd.h>

#include <cstdlib>
#include <string>

namespace stridor {
namespace {

/// Return values of openblas_get_parallel().
enum class Threads { none = 0, posix = 1, openmp = 2, unknown = -1 };

template <class Function>
Function* library_function(const char* name) {
  return reinterpret_cast<Function*>(dlsym(RTLD_DEFAULT, name));
}

/// Threading of the BLAS at hand; it is chosen when the program starts.
Threads threads_of_blas() {
  static const Threads threads = [] {
    const auto parallel = library_function<int()>("openblas_get_parallel");
    return parallel == nullptr ? Threads::unknown : static_cast<Threads>(parallel());
  }();
  return threads;
}

std::mutex blas_in_use;

/// Before main(): starts the program anew where OpenBLAS should have other kernels, which it
/// chooses when it is loaded. Where the user names some, or that is not possible, all stays as it
/// is.
__attribute__((constructor)) void ask_for_wide_kernels([[maybe_unused]] int num_arguments,
                                                       [[maybe_unused]] char** arguments) {
#if defined(__x86_64__)
  constexpr const char* variable = "OPENBLAS_CORETYPE";
  const auto taken = library_function<const char*()>("openblas_get_corename");
  if (taken == nullptr || std::getenv(variable) != nullptr) return;
  const bool has_avx512 = __builtin_cpu_supports("avx512f") && __builtin_cpu_supports("avx512cd") &&
                          __builtin_cpu_supports("avx512bw") &&
                          __builtin_cpu_supports("avx512dq") && __builtin_cpu_supports("avx512vl");
  const bool has_avx2 = __builtin_cpu_supports("avx2") && __builtin_cpu_supports("fma");
  const std::string wanted(blas_kernels_to_ask_for(taken(), has_avx2, has_avx512));
  if (wanted.empty() || setenv(variable, wanted.c_str(), 1) != 0) return;
  execv("/proc/self/exe", arguments);
#endif
}

}  // namespace

std::string_view blas_kernels_to_ask_for(std::string_view taken, bool has_avx2, bool has_avx512) {
  if (taken != "Prescott" || !has_avx2) return {};
  return has_avx512 ? "SkylakeX" : "Haswell";
}

bool is_blas_reentrant() {
  const Threads threads = threads_of_blas();
  return threads == Threads::posix || threads == Threads::openmp;
}

void keep_blas_in_this_thread() {
  // Those of OpenMP are for the calling thread, that of OpenBLAS for all.
  if (const auto set = library_function<void(int)>("omp_set_num_threads")) set(1);
  // Whatever that number is, CHOLMOD asks for four threads, which then wait in a loop.
  if (const auto set = library_function<void(int)>("omp_set_max_active_levels")) set(0);
  if (threads_of_blas() != Threads::posix) return;
  if (const auto set = library_function<void(int)>("openblas_set_num_threads")) set(1);
}

BlasGuard::BlasGuard() {
  if (!is_blas_reentrant()) lock_ = std::unique_lock(blas_in_use);
}

}  // namespace stridor

extern "C" {
/// Linked into every program, by this name.
extern const bool stridor_blas_is_kept;
const bool stridor_blas_is_kept = [] {
  stridor::keep_blas_in_this_thread();
  return true;
}();
}
