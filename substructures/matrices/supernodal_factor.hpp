// The supernodal factor of a part of a sparse symmetric matrix (CHOLMOD).
#pragma once

#include <cholmod.h>

#include <cstddef>
#include <span>
#include <vector>

#include "substructures/matrices/body_matrices.hpp"
#include "substructures/matrices/supernode_kernels.hpp"

namespace stridor {

/// Neighbouring columns of L that have their rows in common: a lower triangle, and the rows below
/// it.
struct Supernode {
  std::span<const int> rows;  ///< of L, those of the triangle first
  Eigen::Index num_columns;
  const double* entries;  ///< column by column, each from its diagonal down

  Eigen::Index num_rows() const { return static_cast<Eigen::Index>(rows.size()); }
  Eigen::Index num_below() const { return num_rows() - num_columns; }
  std::span<const int> rows_below() const {
    return rows.subspan(static_cast<std::size_t>(num_columns));
  }
  SupernodeView view() const { return {entries, num_rows(), num_columns}; }
};

/// Settings and memory of CHOLMOD.
class Cholmod {
 public:
  Cholmod();
  ~Cholmod() { cholmod_finish(&common_); }
  Cholmod(const Cholmod&) = delete;
  Cholmod& operator=(const Cholmod&) = delete;

  cholmod_common* operator->() { return &common_; }
  cholmod_common* get() { return &common_; }

 private:
  cholmod_common common_{};
};

/// L of a part of a matrix: P A_part Pᵀ = L Lᵀ, in an order P that keeps L sparse.
class SupernodalFactor {
 public:
  SupernodalFactor() = default;
  ~SupernodalFactor() { cholmod_free_factor(&factor_, cholmod_.get()); }
  SupernodalFactor(const SupernodalFactor&) = delete;
  SupernodalFactor& operator=(const SupernodalFactor&) = delete;

  /// @param matrix symmetric; both triangles stored
  /// @param dofs   rows and columns of the part, ascending, at least one
  /// @return whether the part is positive definite
  /// @throws std::bad_alloc if L has more than 2^31 entries or does not fit into memory
  bool factorise(const SparseMatrix& matrix, std::span<const int> dofs);

  std::size_t num_supernodes() const { return factor_ == nullptr ? 0 : factor_->nsuper; }
  Supernode supernode(std::size_t k) const;
  /// Numbers that L is stored in.
  std::size_t num_entries() const { return factor_ == nullptr ? 0 : factor_->xsize; }
  /// The row of the matrix of each row of L.
  std::span<const int> dofs() const { return dofs_; }

 private:
  void drop_upper_triangles();

  Cholmod cholmod_;
  cholmod_factor* factor_ = nullptr;
  std::vector<int> dofs_;
};

}  // namespace stridor
