// An orthonormal basis in the norm of a mass matrix that grows vector by vector.
#pragma once

#include <Eigen/Core>

#include "substructures/matrices/body_matrices.hpp"

namespace stridor {

/// V with Vᵀ M V = 1 for a projection of large sparse matrices.
class MassBasis {
 public:
  /// @param mass M, positive definite; referenced from here on
  explicit MassBasis(const SparseMatrix& mass) : mass_(&mass) {}

  /// Makes room for so many vectors; what it holds is lost.
  void reserve(Eigen::Index count);
  void clear() { dim_ = 0; }
  Eigen::Index dim() const { return dim_; }
  auto vectors() const { return basis_.leftCols(dim_); }

  /// Adds the new component of a vector.
  void add(const Eigen::VectorXd& vector);
  /// The same of a complex vector, both parts of it. @return the share of it that is new
  double add_complex(const Eigen::VectorXcd& vector);

 private:
  auto momenta() const { return momenta_.leftCols(dim_); }

  const SparseMatrix* mass_;
  Eigen::MatrixXd basis_;
  Eigen::MatrixXd momenta_;  ///< M V
  Eigen::Index dim_ = 0;
};

}  // namespace stridor
