// The innermost loop of the Moreau-Jean scheme in modal coordinates.
#pragma once

namespace stridor::bench {

/// Data of a body per mode: arrays of equal length, 64-byte aligned and padded with zeros to a
/// multiple of 8, as the rows are.
struct MoreauJeanModes {
  int count = 0;
  double* position = nullptr;      ///< q_k
  double* velocity = nullptr;      ///< v_k
  double* free = nullptr;          ///< v_free of the step under way
  const double* answer = nullptr;  ///< 1/(1 + hθc + h²θ²ω²), velocity per impulse
  const double* kept = nullptr;    ///< v_free per v_k
  const double* pulled = nullptr;  ///< v_free per q_k
  const double* loaded = nullptr;  ///< v_free by the loads
};

/// Ends a step with the impulses at the ports and begins the next one:
///
///   v_{k+1} = v_free + answer Σ_j row_j P_j,   q_{k+1} = q_k + h (θ v_{k+1} + (1 − θ) v_k),
///   v_free  = kept v_{k+1} + pulled q_{k+1} + loaded,   seen_j = row_j · v_free
///
/// @tparam num_ports forces on the body and velocities seen
template <int num_ports>
void advance_moreau_jean(const MoreauJeanModes& modes, const double* const* rows,
                         const double* impulses, double new_share, double old_share, double* seen);

}  // namespace stridor::bench
