// Terms of the spin of a body in reduced coordinates.
#pragma once

#include <Eigen/Core>

#include "substructures/matrices/body_matrices.hpp"
#include "substructures/matrices/coupled_terms.hpp"

namespace stridor {

/// BodyMatrices::spin of displacements u = T q, for any speed and damping (docs/theory.md, 10.9).
struct ReducedSpin {
  Eigen::MatrixXd gyroscopic;  ///< Tᵀ G T, kg; skew
  Eigen::MatrixXd position;    ///< Tᵀ (K_σ − S) T, kg
  Eigen::MatrixXd elastic;     ///< skew part of Tᵀ K ∂_φ T, N/m; empty where damping does not turn
  Eigen::MatrixXd viscous;     ///< the same of the damping that is not proportional, N s/m; or empty
};

/// @param T columns of displacements, all DoFs of `body`, which spins
ReducedSpin reduce_spin(const BodyMatrices& body, const Eigen::MatrixXd& T);

/// V = 2 Ω G and N = Ω² (K_σ − S) + Ω (α G + β K ∂_φ + C ∂_φ): the material, and so its damping,
/// turns with the body. α is the last one of its schedule.
CoupledTerms spin_terms(const ReducedSpin& spin, double speed, const RayleighDamping& damping);

/// Adds terms to others, which may be empty.
void add_terms(const CoupledTerms& more, CoupledTerms& terms);

}  // namespace stridor
