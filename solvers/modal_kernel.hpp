// The innermost loop of the modal integrators: correct, predict and gather in one pass.
#pragma once

#include <cstddef>

namespace stridor {

/// Arrays of one body, one entry per mode, all 64-byte aligned and padded with zeros to a multiple
/// of `modal_padding` entries.
struct ModalArrays {
  std::size_t size;    ///< padded length
  double* position;    ///< q_n
  double* increment;   ///< predicted increment d*_{n+1} = q*_{n+1} − q_n
  const double* keep;  ///< s: part of the increment that the next step keeps
  const double* pull;  ///< k: restoring increment per unit position
  const double* gain;  ///< e: displacement per unit modal force
  const double* load;  ///< e p: displacement by the prescribed loads
};

inline constexpr std::size_t modal_padding = 8;

/// One step of every mode of a body (docs/theory.md, 3.2):
///
///   d_{n+1} = d*_{n+1} + e Σ_j row_j f_j        correct by the forces at the slots
///   q_{n+1} = q_n + d_{n+1}
///   d*_{n+2} = s d_{n+1} − k q_{n+1} + e p      predict
///   predicted_j = row_j · (q_{n+1} + d*_{n+2})  gather
///
/// @param rows      num_slots pointers to padded rows
/// @param forces    num_slots forces at t_n
/// @param predicted num_slots displacements predicted for t_{n+2}
/// Vectorised for the processor at hand; results differ between processors by rounding only.
void advance_modes(const ModalArrays& modes, const double* const* rows, const double* forces,
                   int num_slots, double* predicted);

/// Σ a_i b_i over a padded length.
double dot(const double* a, const double* b, std::size_t size);

}  // namespace stridor
