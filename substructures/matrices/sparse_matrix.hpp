// Sparse matrices of bodies and systems.
#pragma once

#include <Eigen/SparseCore>
#include <type_traits>

namespace stridor {

/// A sparse matrix by columns that is moved without a copy. Eigen 3.4 has no move of its own: every
/// vector that grows and every struct that is returned would copy the matrices in it.
/// A matrix that was moved from may be destroyed or assigned to.
class SparseMatrix : public Eigen::SparseMatrix<double> {
 public:
  /// What templates of Eigen that factor a matrix take.
  using Base = Eigen::SparseMatrix<double>;
  using Base::Base;
  using Base::operator=;
  SparseMatrix() = default;
  ~SparseMatrix() = default;
  SparseMatrix(const SparseMatrix&) = default;
  SparseMatrix& operator=(const SparseMatrix&) = default;
  /// Not even memory for a single number, which Eigen asks for, is something to go on from: vectors
  /// move only what does not throw.
  SparseMatrix(SparseMatrix&& other) noexcept : Base() { swap(other); }
  SparseMatrix& operator=(SparseMatrix&& other) noexcept {
    swap(other);
    return *this;
  }
};

static_assert(std::is_nothrow_move_constructible_v<SparseMatrix>);

}  // namespace stridor
