// Supernodal Cholesky factorisation of a sparse symmetric positive definite matrix (CHOLMOD).
#pragma once

#include <Eigen/Core>
#include <memory>

#include "substructures/matrices/body_matrices.hpp"

namespace stridor {

/// Vectors side by side, one a column. The entries of one DoF are neighbours in memory: a product
/// with a sparse matrix or a factor fetches them together.
using VectorBlock = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;
/// A block, or neighbouring columns of one.
using VectorBlockRef = Eigen::Ref<VectorBlock, 0, Eigen::OuterStride<>>;

/// A = L Lᵀ, factorised once, solved often.
///
/// L is triangular in an order of the DoFs that keeps it sparse. Vectors are in the order of A
/// throughout.
class SparseCholesky {
 public:
  /// @param matrix symmetric; both triangles stored
  /// @param what   name of the matrix, for the message
  /// @throws NumericalError if the matrix is not positive definite to working precision
  /// @throws std::bad_alloc if the factor has more than 2^31 entries or does not fit into memory
  SparseCholesky(const SparseMatrix& matrix, const std::string& what);
  ~SparseCholesky();
  SparseCholesky(SparseCholesky&&) noexcept;
  SparseCholesky& operator=(SparseCholesky&&) noexcept;

  /// A⁻¹ b, for one or several right-hand sides.
  Eigen::MatrixXd solve(const Eigen::MatrixXd& right_hand_sides) const;

  /// X <- A⁻¹ X. Parts of L that the zeros of X keep out of L⁻¹ X are passed over.
  ///
  /// L is read once for all columns in either direction; multiples of 8 of them, up to 64, make the
  /// most of it.
  void solve_in_place(VectorBlockRef block) const;
  /// X <- L⁻¹ X, likewise.
  void solve_lower_in_place(VectorBlockRef block) const;
  /// X <- L⁻ᵀ X.
  void solve_upper_in_place(VectorBlockRef block) const;

  Eigen::Index size() const;

 private:
  enum class Part { lower, upper, both };
  void solve(VectorBlockRef& block, Part part) const;

  struct Factor;
  std::unique_ptr<Factor> factor_;
};

}  // namespace stridor
