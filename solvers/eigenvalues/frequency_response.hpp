// Answers of bodies in sliding contact to harmonic forces.
#pragma once

#include <Eigen/Core>
#include <complex>
#include <utility>
#include <vector>

#include "solvers/eigenvalues/pencil.hpp"

namespace stridor {

/// Displacements per harmonic force of small motion about an equilibrium (docs/theory.md, 7.8):
///
///   (s² + s C + Ω² + Sᵀ(G + s H) S) q + Sᵀ B_Eᵀ δλ = aᵀ,   B_C S q = 0,   h = b q
///
/// for the loads a and the sensors b, given as rows on the modes, with s = iω. With friction h is
/// not symmetric: a force at one point moves another as that does not move the one.
class FrequencyResponse {
 public:
  /// @param pencil  its springs of contacts are taken as with_springs() does
  /// @param loads   a, p x n: rows of the displacements that the forces do work on
  /// @param sensors b, l x n: rows of the displacements that are wanted
  /// @throws std::invalid_argument as check_pencil(), or if a row is not as long as there are modes
  FrequencyResponse(const Pencil& pencil, Eigen::MatrixXd loads, Eigen::MatrixXd sensors);

  /// h, l x p, m/N; not finite where s is an eigenvalue to the last digit.
  /// Cost: n (k + r)² + (k + r)³ with k constraints and the rank r of G and H, as in ModalRows.
  Eigen::MatrixXcd at(std::complex<double> s) const;

 private:
  Eigen::ArrayXd omega_;
  Eigen::ArrayXd damping_;
  ModalRows rows_;
  Eigen::MatrixXd loads_;
  Eigen::MatrixXd sensors_;
};

/// Rows of displacements of bodies on the modes of all of them, as of make_modal_pencil().
/// @param displacements body and row of ReducedBody::rows of each
Eigen::MatrixXd rows_on_modes(const System& system,
                              const std::vector<std::pair<int, int>>& displacements);

/// The pencil with more displacements among its ports, behind those of the contacts; nothing acts
/// between them. What with_residual_modes() drops keeps its static answer there.
/// @param rows of the displacements on the modes
Pencil with_ports(const Pencil& pencil, const Eigen::MatrixXd& rows);

/// Rows of with_ports() in a pencil made from it.
Eigen::MatrixXd added_ports(const Pencil& pencil, Eigen::Index count);

}  // namespace stridor
