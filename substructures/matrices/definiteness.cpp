#include "substructures/matrices/definiteness.hpp"

#include <Eigen/SparseCholesky>
#include <cmath>
#include <vector>

#include "core/errors.hpp"
#include "substructures/matrices/sparse_cholesky.hpp"

namespace stridor {
namespace {

/// D^-½ A D^-½ with the diagonal D of A, over the unknowns with an entry.
struct ScaledMatrix {
  SparseMatrix matrix;
  bool has_negative = false;  ///< a diagonal entry below 0, or entries beside one that is 0
};

ScaledMatrix scaled_to_unit_diagonal(const SparseMatrix& matrix) {
  ScaledMatrix scaled;
  const Eigen::VectorXd diagonal = matrix.diagonal();
  std::vector<int> place(static_cast<std::size_t>(matrix.rows()), -1);
  int count = 0;
  for (Eigen::Index i = 0; i < matrix.rows(); ++i) {
    if (diagonal(i) > 0.0) {
      place[static_cast<std::size_t>(i)] = count++;
    } else if (diagonal(i) < 0.0) {
      scaled.has_negative = true;
    }
  }
  std::vector<Eigen::Triplet<double>> entries;
  entries.reserve(static_cast<std::size_t>(matrix.nonZeros()));
  for (Eigen::Index column = 0; column < matrix.outerSize(); ++column) {
    for (SparseMatrix::InnerIterator entry(matrix, column); entry; ++entry) {
      const int row = place[static_cast<std::size_t>(entry.row())];
      const int to = place[static_cast<std::size_t>(column)];
      if (row >= 0 && to >= 0) {
        entries.emplace_back(row, to,
                             entry.value() / std::sqrt(diagonal(entry.row()) * diagonal(column)));
      } else if (entry.value() != 0.0) {
        scaled.has_negative = true;
      }
    }
  }
  scaled.matrix.resize(count, count);
  scaled.matrix.setFromTriplets(entries.begin(), entries.end());
  return scaled;
}

}  // namespace

bool is_positive_semidefinite(const SparseMatrix& matrix) {
  ScaledMatrix scaled = scaled_to_unit_diagonal(matrix);
  if (scaled.has_negative) return false;
  if (scaled.matrix.rows() == 0) return true;
  for (Eigen::Index i = 0; i < scaled.matrix.rows(); ++i)
    scaled.matrix.coeffRef(i, i) += massless_ratio;
  try {
    const SparseCholesky factor(scaled.matrix, "the matrix");
  } catch (const NumericalError&) {
    return false;
  }
  return true;
}

double smallest_pivot_ratio(const SparseMatrix& matrix) {
  const ScaledMatrix scaled = scaled_to_unit_diagonal(matrix);
  if (scaled.has_negative) return -1.0;
  if (scaled.matrix.rows() < matrix.rows() || matrix.rows() == 0) return 0.0;
  const Eigen::SimplicialLDLT<SparseMatrix::Base> factor(scaled.matrix);
  if (factor.info() != Eigen::Success) return 0.0;
  return factor.vectorD().minCoeff();
}

}  // namespace stridor
