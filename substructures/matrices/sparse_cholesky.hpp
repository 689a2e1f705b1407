// Supernodal Cholesky factorisation of a sparse symmetric positive definite matrix (CHOLMOD).
#pragma once

#include <Eigen/Core>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "substructures/matrices/body_matrices.hpp"

namespace stridor {

/// Vectors side by side, one a column. The entries of one DoF are neighbours in memory: a product
/// with a sparse matrix or a factor fetches them together.
using VectorBlock = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;
/// A block, or neighbouring columns of one.
using VectorBlockRef = Eigen::Ref<VectorBlock, 0, Eigen::OuterStride<>>;

/// A = L Lᵀ, factorised once, solved often; or the part of A without some of its rows and columns.
///
/// L is triangular in an order of the DoFs that keeps it sparse. Vectors have the length and order
/// of A throughout; entries of DoFs that are left out are neither read nor written.
class SparseCholesky {
 public:
  /// @param matrix   symmetric; both triangles stored
  /// @param what     name of the matrix, for the message
  /// @param left_out DoFs whose rows and columns are not of the part that is factorised
  /// @throws NumericalError if the part is not positive definite to working precision
  /// @throws std::bad_alloc if the factor has more than 2^31 entries or does not fit into memory
  /// Memory: L, and while it is computed a sixth of L and one triangle of the matrix besides.
  SparseCholesky(const SparseMatrix& matrix, const std::string& what,
                 std::span<const int> left_out = {});
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

  Eigen::Index size() const;            ///< rows of A
  Eigen::Index num_factorised() const;  ///< rows of the part that is factorised
  std::size_t num_entries() const;      ///< numbers that L is stored in, some of them zeros
  std::span<const int> left_out() const;
  std::vector<int> factorised_dofs() const;  ///< the others, ascending
  /// Sets the rows of DoFs that are left out to zero: multiplied by A, vectors with such zeros give
  /// what the part gives.
  template <typename Vectors>
  void clear_left_out(Vectors& vectors) const {
    for (const int dof : left_out()) vectors.row(dof).setZero();
  }

 private:
  enum class Part { lower, upper, both };
  void solve(VectorBlockRef& block, Part part) const;

  struct Factor;
  std::unique_ptr<Factor> factor_;
};

}  // namespace stridor
