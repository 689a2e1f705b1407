// Small dense matrices times vectors, without a call of BLAS.
#pragma once

#include <Eigen/Core>

#include "solvers/aligned_array.hpp"

namespace stridor {

/// Length of a vector of `size` numbers that products with matrices may write to: a few more.
inline std::size_t padded_size(Eigen::Index size) {
  return static_cast<std::size_t>(size) + 8;
}

/// A⁻¹ by Gauss and Jordan's elimination with row pivots; not finite where A is singular. LAPACK
/// takes longer for some ten rows.
Eigen::MatrixXd small_inverse(Eigen::MatrixXd matrix);

/// A by columns, each filled up with zeros to a multiple of eight rows.
class PaddedMatrix {
 public:
  PaddedMatrix() = default;
  explicit PaddedMatrix(const Eigen::MatrixXd& matrix);

  Eigen::Index rows() const { return rows_; }
  Eigen::Index cols() const { return cols_; }
  /// y += A x.
  /// @param x cols() numbers
  /// @param y apart from x; up to seven numbers beyond rows() are added zero times x to
  void add_product(const double* x, double* y) const;

 private:
  Eigen::Index rows_ = 0, cols_ = 0;
  std::size_t height_ = 0;  ///< of a column
  AlignedArray entries_;
};

}  // namespace stridor
