// Supernodal Cholesky factorisation of a sparse symmetric positive definite matrix (CHOLMOD).
#pragma once

#include <Eigen/Core>
#include <memory>

#include "substructures/body_matrices.hpp"

namespace stridor {

/// A = L Lᵀ, factorised once, solved often.
class SparseCholesky {
 public:
  /// @param matrix symmetric; both triangles stored
  /// @param what   what it is, for the message
  /// @throws NumericalError if the matrix is not positive definite to working precision
  SparseCholesky(const SparseMatrix& matrix, const std::string& what);
  ~SparseCholesky();
  SparseCholesky(SparseCholesky&&) noexcept;
  SparseCholesky& operator=(SparseCholesky&&) noexcept;

  /// A⁻¹ b, for one or several right-hand sides.
  Eigen::MatrixXd solve(const Eigen::MatrixXd& right_hand_sides) const;
  Eigen::Index size() const;

 private:
  struct Factor;
  std::unique_ptr<Factor> factor_;
};

}  // namespace stridor
