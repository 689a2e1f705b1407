// Sums of products with many small blocks of low rank.
#pragma once

#include <Eigen/Core>

namespace stridor {

/// Σ A_iᵀ F_i B_i over small square blocks F_i, gathered as one product of two tall matrices of as
/// many columns as the blocks have ranks.
///
/// A contact joins a dozen ports, and its force changes with few combinations of their
/// displacements: one product of some hundred rows takes the place of one of all ports.
class BlockProducts {
 public:
  /// @param rows, columns of the sum
  BlockProducts(Eigen::Index rows, Eigen::Index columns) : left_(rows, 0), right_(0, columns) {}

  /// @param before A_iᵀ, rows x w
  /// @param block  F_i, w x w; directions below rounding are left out
  /// @param after  B_i, w x columns
  void add(const Eigen::Ref<const Eigen::MatrixXd>& before, const Eigen::MatrixXd& block,
           const Eigen::Ref<const Eigen::MatrixXd>& after);

  bool is_zero() const { return rank_ == 0; }
  Eigen::MatrixXd sum() const;

 private:
  Eigen::MatrixXd left_, right_;  ///< with space for more
  Eigen::Index rank_ = 0;
};

}  // namespace stridor
