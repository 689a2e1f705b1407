// Forces of contacts on the faces of a plate at one instant, by their laws.
#pragma once

#include <Eigen/Core>
#include <array>
#include <string>
#include <vector>

#include "core/state.hpp"
#include "coupling/face_contact.hpp"
#include "solvers/padded_matrix.hpp"

namespace stridor {

/// Gap, m, and velocities, m/s, that k contacts see under their forces, N: three in a row of each
/// contact, along its normal, along the sliding direction and across it.
class FaceContactAnswer {
 public:
  using Compliance = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;

  virtual ~FaceContactAnswer() = default;
  /// @param forces 3k
  /// @param seen   3k
  /// @return how far what bends with the motion is from settled, as a force, N: what is seen may
  ///         change by as much when asked again
  virtual double see(const double* forces, double* seen) = 0;
  /// Of gap and velocities per force, 3k x 3k; what bends may be left out.
  virtual const Compliance& compliance() const = 0;
};

/// Finds forces f = (λ, τ) of every contact with
///
///   λ >= 0,  g + λ/k_C >= 0,  λ (g + λ/k_C) = 0,
///   τ = μ λ v/|v|,  or |τ| <= μ λ where v = 0,
///
/// with the gap g and the velocities v of a FaceContactAnswer, and 1/k_C = 0 without a penalty
/// (docs/theory.md, 10.6). Newton's method on the closed contacts, whose inverse matrix is kept
/// from step to step until a contact opens, closes, sticks or slips, or more than six further
/// corrections would be needed with it; where it fails, Gauss and Seidel's sweeps over the
/// contacts, or Newton's method with shortened steps where those go round in circles.
class FaceContactSolver {
 public:
  /// @param least force that counts as large, N, >= 0: convergence is relative to it, or to the
  /// largest force
  FaceContactSolver(const FaceContactLaw& law, double least);

  /// @param forces 3k; a first guess, and the forces found
  /// @return whether it has converged
  bool solve(FaceContactAnswer& answer, Eigen::VectorXd& forces);
  /// Gap and velocities under the forces found but for the last correction, 3k, for which the
  /// answer was asked last.
  const Eigen::VectorXd& seen() const { return seen_; }
  /// To be called where the compliance changes.
  void forget() { kept_.clear(); }

  /// What is kept between solutions.
  void save(State& state, const std::string& prefix) const;
  void load(const State& state, const std::string& prefix);

  /// Of the largest force.
  static constexpr double tolerance = 1e-12;

 private:
  using Compliance = FaceContactAnswer::Compliance;
  enum class Regime : unsigned char { open, slip, stick };

  bool follow(FaceContactAnswer& answer, Eigen::VectorXd& forces);
  bool open_contacts(const Compliance& compliance, Eigen::VectorXd& forces);
  bool repeat(FaceContactAnswer& answer, Eigen::VectorXd& forces);
  Regime regime_of(const Compliance& compliance, Eigen::Index k, const Eigen::VectorXd& seen,
                   const Eigen::VectorXd& forces) const;
  void keep(const Compliance& compliance, const Eigen::VectorXd& seen,
            const Eigen::VectorXd& forces);
  void keep_inverse(const Eigen::MatrixXd& inverse);
  double correct(const Compliance& compliance, const Eigen::VectorXd& seen,
                 Eigen::VectorXd& forces);
  void accelerate();
  void obey(const Compliance& compliance, const Eigen::VectorXd& seen,
            Eigen::VectorXd& forces) const;
  double largest_of(const Eigen::VectorXd& forces) const;
  bool sweep(const Compliance& compliance, const Eigen::VectorXd& free,
             Eigen::VectorXd& forces) const;
  bool search(const Compliance& compliance, const Eigen::VectorXd& free,
              Eigen::VectorXd& forces) const;
  void deviation(const Compliance& compliance, const Eigen::VectorXd& seen,
                 const Eigen::VectorXd& forces, Eigen::VectorXd& apart, Compliance* slope) const;

  double friction_;
  double softness_;  ///< 1/k_C, m/N
  double least_;
  std::vector<Regime> kept_;          ///< of every contact, where the inverse is of; empty: none
  std::vector<Regime> regimes_;       ///< now
  std::vector<Eigen::Index> active_;  ///< forces of closed contacts, where the inverse is of
  Eigen::MatrixXd inverse_;           ///< of the deviation by the active forces
  PaddedMatrix padded_inverse_;
  Compliance slope_;
  std::array<Eigen::VectorXd, 8> corrections_;  ///< by the present inverse, in one solution
  std::size_t num_corrections_ = 0;
  Eigen::VectorXd first_guess_, seen_, apart_, active_apart_, change_;
};

}  // namespace stridor
