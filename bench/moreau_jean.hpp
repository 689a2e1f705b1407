// The time stepping of Moreau and Jean in modal coordinates, as fast as it can be made.
#pragma once

#include "bench/sliding_window.hpp"

namespace stridor::bench {

struct MoreauJeanParameters {
  double step = 0.0;   ///< h, s; a whole fraction of the interval between samples
  double theta = 0.5;  ///< θ in [1/2, 1]
  /// A contact is taken as closed up to this gap ahead, m.
  double activation = 1e-6;
};

/// Marches a window by
///
///   (M + hθC + h²θ²K)(v_{k+1} − v_k) = h (f − C v_k − K q_k − hθ K v_k) + Bᵀ P_{k+1}
///   q_{k+1} = q_k + h (θ v_{k+1} + (1 − θ) v_k)
///   0 ≤ U_n ⟂ P_n ≥ 0,  |P_t| ≤ μ P_n,  U = B v_{k+1} + ∂g/∂t
///
/// (Jean, Comput. Methods Appl. Mech. Engrg. 177, 1999, 235), with the rows B at q_k + h v_k. In
/// modes the iteration matrix is diagonal; correction, position and the free velocity of the next
/// step are one pass over the modes, the contact sees its ports only. The local problem is solved
/// by the ContactSolver of the program. The force at t_k is the mean of the impulses before and
/// after it by h.
///
/// @throws std::runtime_error if the slave leaves its master
WindowRun run_moreau_jean(const SlidingWindow& window, const MoreauJeanParameters& parameters,
                          Sampling sampling);

}  // namespace stridor::bench
