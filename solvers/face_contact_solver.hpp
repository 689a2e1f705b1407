// Forces of contacts on the faces of a plate at one instant, by their laws.
#pragma once

#include <Eigen/Core>

#include "coupling/face_contact.hpp"

namespace stridor {

/// Gap and velocities that k contacts see, linear in their forces: three in a row of each contact,
/// along its normal, along the sliding direction and across it.
struct FaceContactAnswer {
  /// Of gap and velocities per force, 3k x 3k; by rows, as sweeps over the contacts take them.
  Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor> compliance;
  /// Gap, m, and velocities of the face against the pad, m/s, without forces.
  Eigen::VectorXd free;
};

/// Finds forces f = (λ, τ) of every contact with
///
///   λ >= 0,  g + λ/k_C >= 0,  λ (g + λ/k_C) = 0,
///   τ = μ λ v/|v|,  or |τ| <= μ λ where v = 0,
///
/// with the gap g and the velocities v of a FaceContactAnswer, and 1/k_C = 0 without a penalty: by
/// Gauss and Seidel's sweeps over the contacts, or by Newton's method where those go round in
/// circles (docs/theory.md, 10.6).
class FaceContactSolver {
 public:
  /// @param least force that counts as large, N, >= 0: convergence is relative to it, or to the
  /// largest force
  FaceContactSolver(const FaceContactLaw& law, double least);

  /// @param forces 3k; a first guess, and the forces found
  /// @return whether it has converged
  bool solve(const FaceContactAnswer& answer, Eigen::VectorXd& forces) const;

  /// Of the largest force.
  static constexpr double tolerance = 1e-12;

 private:
  bool sweep(const FaceContactAnswer& answer, Eigen::VectorXd& forces) const;
  bool search(const FaceContactAnswer& answer, Eigen::VectorXd& forces) const;
  Eigen::VectorXd deviation(const FaceContactAnswer& answer, const Eigen::VectorXd& forces,
                            Eigen::MatrixXd* slope) const;

  double friction_;
  double softness_;  ///< 1/k_C, m/N
  double least_;
};

}  // namespace stridor
