// The static sliding state of bodies on the faces of a spinning plate.
#pragma once

#include "tests/support/face_contact.hpp"

namespace stridor {

/// Solution and its quality.
struct SlidingStateSolution {
  FaceSlidingState state;
  bool has_converged = false;
  int iterations = 0;
  double residual = 0.0;  ///< largest force out of balance over the largest force
};

/// Bodies at rest in space under loads, with their contacts as they slide (docs/theory.md, 10.8):
///
///   Q q = f + Σ λ [n(q) + μ (d₁ b(q) + d₂ a)],   λ >= 0,  g(q) + λ/k_C >= 0,  λ (g + λ/k_C) = 0
///
/// with 1/k_C = 0 where contacts are rigid. Newton's method on displacements and the forces of
/// those contacts that are closed; contacts that would pull open, those that would overlap close,
/// until none does. The way friction and normals turn with q is differentiated.
///
/// @param bodies without contact; Q need not be symmetric
/// @param loads  f, N
/// @return has_converged is false where no such state was found: friction can pull pads in without
///         bound
SlidingStateSolution solve_sliding_state(const LinearSystem& bodies,
                                         const std::vector<FaceContact>& contacts,
                                         const FaceContactLaw& law, const Eigen::VectorXd& loads);

}  // namespace stridor
