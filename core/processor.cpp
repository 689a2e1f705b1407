#include "core/processor.hpp"

#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <string_view>

namespace stridor {
namespace {

KernelSet set_of_this_processor() {
#if defined(__x86_64__)
  __builtin_cpu_init();
  const bool has_v3 = __builtin_cpu_supports("avx2") && __builtin_cpu_supports("fma") &&
                      __builtin_cpu_supports("bmi2");
  const bool has_v4 = has_v3 && __builtin_cpu_supports("avx512f") &&
                      __builtin_cpu_supports("avx512bw") && __builtin_cpu_supports("avx512cd") &&
                      __builtin_cpu_supports("avx512dq") && __builtin_cpu_supports("avx512vl");
  if (has_v4) return KernelSet::v4;
  if (has_v3) return KernelSet::v3;
#endif
  return KernelSet::portable;
}

}  // namespace

KernelSet kernel_set() {
  const char* asked = std::getenv("STRIDOR_KERNELS");
  if (asked == nullptr) return set_of_this_processor();
  if (std::string_view(asked) == "portable") return KernelSet::portable;
  if (std::string_view(asked) == "v3") return std::min(KernelSet::v3, set_of_this_processor());
  std::fprintf(stderr, "stridor: STRIDOR_KERNELS is '%s', but may be portable or v3\n", asked);
  std::_Exit(2);
}

}  // namespace stridor
