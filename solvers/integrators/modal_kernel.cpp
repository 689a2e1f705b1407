#include "solvers/integrators/modal_kernel.hpp"

#include "core/processor.hpp"
#include "solvers/algebra/ports.hpp"

namespace stridor {
namespace {

// Vectors of 4 and 8 doubles. The compiler splits them where the instruction set has shorter ones,
// so one source serves every processor.
using Vector4 = double __attribute__((vector_size(32)));
using Vector8 = double __attribute__((vector_size(64)));

template <class Vector>
constexpr std::size_t lanes = sizeof(Vector) / sizeof(double);

template <class Vector>
STRIDOR_INLINE const Vector& at(const double* values, std::size_t i) {
  return *reinterpret_cast<const Vector*>(
      static_cast<const double*>(__builtin_assume_aligned(values, 64)) + i);
}

template <class Vector>
STRIDOR_INLINE Vector& at(double* values, std::size_t i) {
  return *reinterpret_cast<Vector*>(static_cast<double*>(__builtin_assume_aligned(values, 64)) + i);
}

template <class Vector>
STRIDOR_INLINE double sum_of(const Vector& vector) {
  // Pairwise, so that the order does not depend on how the compiler splits the vector.
  double partial[lanes<Vector>];
  for (std::size_t i = 0; i < lanes<Vector>; ++i) partial[i] = vector[i];
  for (std::size_t width = lanes<Vector> / 2; width > 0; width /= 2) {
    for (std::size_t i = 0; i < width; ++i) partial[i] += partial[i + width];
  }
  return partial[0];
}

/// Part `part` of a field of a block.
template <class Vector, class Double>
STRIDOR_INLINE auto& field(Double* block, ModalField which, std::size_t part) {
  return at<Vector>(block, static_cast<std::size_t>(which) * modal_block + part);
}

/// The fused pass for a number of ports known to the compiler, which keeps one sum for each in a
/// register.
template <class Vector, int num_ports>
STRIDOR_INLINE void fused_pass(double* blocks, std::size_t num_blocks, const double* const* rows,
                               const double* forces, double lookahead, double* seen) {
  Vector sums[num_ports + 1]{};  // one more, for no array is empty
  for (std::size_t b = 0; b < num_blocks; ++b) {
    double* const block = blocks + b * num_modal_fields * modal_block;
    for (std::size_t part = 0; part < modal_block; part += lanes<Vector>) {
      const std::size_t i = b * modal_block + part;
      // The rows are read once, before the stores below that they might overlap for all the
      // compiler knows.
      Vector row[num_ports + 1];
#pragma GCC unroll 8
      for (int j = 0; j < num_ports; ++j) row[j] = at<Vector>(rows[j], i);
      Vector increment = field<Vector>(block, ModalField::increment, part);
      if constexpr (num_ports > 0) {
        Vector modal_force = row[0] * forces[0];
#pragma GCC unroll 8
        for (int j = 1; j < num_ports; ++j) modal_force += row[j] * forces[j];
        increment += field<Vector>(block, ModalField::gain, part) * modal_force;
      }
      const Vector position = field<Vector>(block, ModalField::position, part) + increment;
      const Vector next = field<Vector>(block, ModalField::keep, part) * increment -
                          (field<Vector>(block, ModalField::pull, part) * position -
                           field<Vector>(block, ModalField::load, part));
      field<Vector>(block, ModalField::position, part) = position;
      field<Vector>(block, ModalField::increment, part) = next;
      const Vector ahead = position + lookahead * next;
#pragma GCC unroll 8
      for (int j = 0; j < num_ports; ++j) sums[j] += row[j] * ahead;
    }
  }
  for (int j = 0; j < num_ports; ++j) seen[j] = sum_of(sums[j]);
}

template <class Vector>
STRIDOR_INLINE double gather(const double* blocks, std::size_t num_blocks, ModalField which,
                             const double* row) {
  // Four sums: one alone would wait for the latency of every addition.
  constexpr std::size_t num_sums = 4;
  constexpr std::size_t parts = modal_block / lanes<Vector>;
  Vector sums[num_sums]{};
  const auto add = [&](std::size_t piece, Vector & sum) __attribute__((always_inline)) {
    const std::size_t b = piece / parts;
    const std::size_t part = piece % parts * lanes<Vector>;
    sum += at<Vector>(row, b * modal_block + part) *
           field<Vector>(blocks + b * num_modal_fields * modal_block, which, part);
  };
  const std::size_t num_pieces = num_blocks * parts;
  std::size_t piece = 0;
  for (; piece + num_sums <= num_pieces; piece += num_sums) {
    add(piece, sums[0]);
    add(piece + 1, sums[1]);
    add(piece + 2, sums[2]);
    add(piece + 3, sums[3]);
  }
  for (; piece < num_pieces; ++piece) add(piece, sums[0]);
  return sum_of<Vector>((sums[0] + sums[1]) + (sums[2] + sums[3]));
}

template <class Vector>
STRIDOR_INLINE void advance(double* blocks, std::size_t num_blocks, const double* const* rows,
                            const double* forces, int num_ports, double lookahead, double* seen) {
  // Ports beyond the fused ones stream the rows once more; a body rarely has any.
  const int fused = num_ports >= 8 ? 8 : num_ports >= 4 ? 4 : num_ports >= 2 ? 2 : 0;
  for (std::size_t b = 0; b < num_blocks && fused < num_ports; ++b) {
    double* const block = blocks + b * num_modal_fields * modal_block;
    for (std::size_t part = 0; part < modal_block; part += lanes<Vector>) {
      Vector modal_force = at<Vector>(rows[fused], b * modal_block + part) * forces[fused];
      for (int j = fused + 1; j < num_ports; ++j)
        modal_force += at<Vector>(rows[j], b * modal_block + part) * forces[j];
      field<Vector>(block, ModalField::increment, part) +=
          field<Vector>(block, ModalField::gain, part) * modal_force;
    }
  }
  if (fused == 8) {
    fused_pass<Vector, 8>(blocks, num_blocks, rows, forces, lookahead, seen);
  } else if (fused == 4) {
    fused_pass<Vector, 4>(blocks, num_blocks, rows, forces, lookahead, seen);
  } else if (fused == 2) {
    fused_pass<Vector, 2>(blocks, num_blocks, rows, forces, lookahead, seen);
  } else {
    fused_pass<Vector, 0>(blocks, num_blocks, rows, forces, lookahead, seen);
  }
  for (int j = fused; j < num_ports; ++j) {
    seen[j] = gather<Vector>(blocks, num_blocks, ModalField::position, rows[j]);
    if (lookahead != 0.0)
      seen[j] += lookahead * gather<Vector>(blocks, num_blocks, ModalField::increment, rows[j]);
  }
}

using Advance = void (*)(double*, std::size_t, const double* const*, const double*, int, double,
                         double*);
using Gather = double (*)(const double*, std::size_t, ModalField, const double*);

struct Kernel {
  Advance advance;
  Gather gather;
};

void advance_portable(double* blocks, std::size_t num_blocks, const double* const* rows,
                      const double* forces, int num_ports, double lookahead, double* seen) {
  advance<Vector4>(blocks, num_blocks, rows, forces, num_ports, lookahead, seen);
}
double gather_portable(const double* blocks, std::size_t num_blocks, ModalField which,
                       const double* row) {
  return gather<Vector4>(blocks, num_blocks, which, row);
}

#if defined(__x86_64__)
STRIDOR_V3
void advance_v3(double* blocks, std::size_t num_blocks, const double* const* rows,
                const double* forces, int num_ports, double lookahead, double* seen) {
  advance<Vector4>(blocks, num_blocks, rows, forces, num_ports, lookahead, seen);
}
STRIDOR_V3
double gather_v3(const double* blocks, std::size_t num_blocks, ModalField which,
                 const double* row) {
  return gather<Vector4>(blocks, num_blocks, which, row);
}
STRIDOR_V4
void advance_v4(double* blocks, std::size_t num_blocks, const double* const* rows,
                const double* forces, int num_ports, double lookahead, double* seen) {
  advance<Vector8>(blocks, num_blocks, rows, forces, num_ports, lookahead, seen);
}
STRIDOR_V4
double gather_v4(const double* blocks, std::size_t num_blocks, ModalField which,
                 const double* row) {
  return gather<Vector8>(blocks, num_blocks, which, row);
}
#endif

Kernel kernel_of_this_processor() {
#if defined(__x86_64__)
  const KernelSet set = kernel_set();
  if (set == KernelSet::v4) return {advance_v4, gather_v4};
  if (set == KernelSet::v3) return {advance_v3, gather_v3};
#endif
  return {advance_portable, gather_portable};
}

const Kernel kernel = kernel_of_this_processor();

}  // namespace

void advance_modes(double* blocks, std::size_t num_blocks, const double* const* rows,
                   const double* forces, int num_ports, double lookahead, double* seen) {
  kernel.advance(blocks, num_blocks, rows, forces, num_ports, lookahead, seen);
}

double gather_modes(const double* blocks, std::size_t num_blocks, ModalField field,
                    const double* row) {
  return kernel.gather(blocks, num_blocks, field, row);
}

}  // namespace stridor
