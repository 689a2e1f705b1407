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

/// The best set of this processor. The environment variable STRIDOR_KERNELS (portable, v3) asks for
/// a lesser one, so that the kernels of other processors can be tested here; any other value ends
/// the program with exit code 2, as kernels are chosen before main().
KernelSet kernel_set();

}  // namespace stridor
