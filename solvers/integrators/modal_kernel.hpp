// The innermost loop of the modal integrators: correct, predict and gather in one pass.
#pragma once

#include <cstddef>

namespace stridor {

/// Modes are worked on in blocks of this many; rows are padded with zeros to whole blocks.
inline constexpr std::size_t modal_block = 8;

/// Fields of a block, `modal_block` numbers each, one after the other: 6 cache lines that the pass
/// reads as one stream.
enum class ModalField : std::size_t {
  position,   ///< q_n
  increment,  ///< predicted increment d*_{n+1} = q*_{n+1} − q_n
  keep,       ///< s: part of the increment that the next step keeps
  pull,       ///< k: restoring increment per unit position
  gain,       ///< e: displacement per unit modal force
  load,       ///< e p: displacement by the prescribed loads
};
inline constexpr std::size_t num_modal_fields = 6;

/// Place of a mode's number in the blocks of a body.
constexpr std::size_t modal_index(std::size_t mode, ModalField field) {
  return (mode / modal_block * num_modal_fields + static_cast<std::size_t>(field)) * modal_block +
         mode % modal_block;
}

/// One step of every mode of a body (docs/theory.md, 3.2):
///
///   d_{n+1} = d*_{n+1} + e Σ_j row_j f_j        correct by the forces at the ports
///   q_{n+1} = q_n + d_{n+1}
///   d*_{n+2} = s d_{n+1} − k q_{n+1} + e p      predict
///   seen_j = row_j · (q_{n+1} + a d*_{n+2})     gather, a = 1 for the prediction, 0 for the
///   present
///
/// @param blocks     num_blocks blocks, 64-byte aligned, unused entries zero
/// @param rows       num_ports pointers to 64-byte aligned rows of num_blocks·modal_block entries
/// @param forces     num_ports forces at t_n
/// @param lookahead  a
/// @param seen       num_ports displacements
/// Vectorised for the processor at hand; results differ between processors by rounding only.
void advance_modes(double* blocks, std::size_t num_blocks, const double* const* rows,
                   const double* forces, int num_ports, double lookahead, double* seen);

/// row · field over all blocks.
double gather_modes(const double* blocks, std::size_t num_blocks, ModalField field,
                    const double* row);

}  // namespace stridor
