// Which vectors the processor has.
#pragma once

namespace stridor {

/// Instruction sets that kernels are compiled for by hand (see clones.hpp for those that the
/// compiler compiles several times).
enum class KernelSet {
  portable,
  v3,  ///< x86-64-v3: AVX2 and FMA, 4 numbers at once
  v4,  ///< x86-64-v4: AVX-512, 8 numbers
};

#if defined(__x86_64__)
/// Put before a function: it is compiled for that set.
#define STRIDOR_V3 __attribute__((target("arch=x86-64-v3")))
// Each compiler has its own word for vectors as wide as the registers, and does not know the
// other's.
#if defined(__clang__)
#define STRIDOR_V4 __attribute__((target("arch=x86-64-v4"), min_vector_width(512)))
#else
#define STRIDOR_V4 __attribute__((target("arch=x86-64-v4,prefer-vector-width=512")))
#endif
#endif

/// The best set of this processor. The environment variable STRIDOR_KERNELS (portable, v3) asks for
/// a lesser one, so that the kernels of other processors can be tested here; any other value ends
/// the program with exit code 2, as kernels are chosen before main().
KernelSet kernel_set();

}  // namespace stridor
