#include "solvers/padded_matrix.hpp"

#include <cstddef>
#include <vector>

#include "core/clones.hpp"

namespace stridor {
namespace {

/// y += A x, eight columns at a time: plain loops, which the compiler turns into vectors.
STRIDOR_CLONES void multiply(const double* __restrict matrix, std::ptrdiff_t rows,
                             std::ptrdiff_t cols, const double* __restrict x,
                             double* __restrict y) {
  std::ptrdiff_t j = 0;
  for (; j + 8 <= cols; j += 8, matrix += 8 * rows) {
    const double *a = matrix, *b = a + rows, *c = b + rows, *d = c + rows;
    const double *e = d + rows, *f = e + rows, *g = f + rows, *h = g + rows;
    for (std::ptrdiff_t i = 0; i < rows; ++i) {
      y[i] += ((a[i] * x[j] + b[i] * x[j + 1]) + (c[i] * x[j + 2] + d[i] * x[j + 3])) +
              ((e[i] * x[j + 4] + f[i] * x[j + 5]) + (g[i] * x[j + 6] + h[i] * x[j + 7]));
    }
  }
  for (; j + 2 <= cols; j += 2, matrix += 2 * rows) {
    const double *a = matrix, *b = a + rows;
    for (std::ptrdiff_t i = 0; i < rows; ++i) y[i] += a[i] * x[j] + b[i] * x[j + 1];
  }
  if (j < cols)
    for (std::ptrdiff_t i = 0; i < rows; ++i) y[i] += matrix[i] * x[j];
}

/// All columns less `column` times their entry in row k.
STRIDOR_CLONES void eliminate(double* __restrict matrix, std::ptrdiff_t n, std::ptrdiff_t k,
                              double inverse, const double* __restrict column) {
  for (std::ptrdiff_t j = 0; j < n; ++j, matrix += n) {
    const double entry = inverse * matrix[k];
    for (std::ptrdiff_t i = 0; i < n; ++i) matrix[i] -= entry * column[i];
    matrix[k] = entry;
  }
}

}  // namespace

Eigen::MatrixXd small_inverse(Eigen::MatrixXd matrix) {
  const Eigen::Index n = matrix.rows();
  std::vector<Eigen::Index> pivots(static_cast<std::size_t>(n));
  Eigen::VectorXd column(n);
  for (Eigen::Index k = 0; k < n; ++k) {
    Eigen::Index pivot = 0;
    matrix.col(k).tail(n - k).cwiseAbs().maxCoeff(&pivot);
    pivot += k;
    pivots[static_cast<std::size_t>(k)] = pivot;
    if (pivot != k) matrix.row(pivot).swap(matrix.row(k));
    const double inverse = 1.0 / matrix(k, k);
    column = matrix.col(k);
    column(k) = 0.0;
    matrix.col(k).setZero();
    matrix(k, k) = 1.0;
    eliminate(matrix.data(), n, k, inverse, column.data());
  }
  for (Eigen::Index k = n - 1; k >= 0; --k) {
    const Eigen::Index pivot = pivots[static_cast<std::size_t>(k)];
    if (pivot != k) matrix.col(pivot).swap(matrix.col(k));
  }
  return matrix;
}

PaddedMatrix::PaddedMatrix(const Eigen::MatrixXd& matrix)
    : rows_(matrix.rows()),
      cols_(matrix.cols()),
      height_(static_cast<std::size_t>((rows_ + 7) / 8 * 8)),
      entries_(height_ * static_cast<std::size_t>(cols_)) {
  for (Eigen::Index j = 0; j < cols_; ++j)
    for (Eigen::Index i = 0; i < rows_; ++i)
      entries_[static_cast<std::size_t>(j) * height_ + static_cast<std::size_t>(i)] = matrix(i, j);
}

void PaddedMatrix::add_product(const double* x, double* y) const {
  multiply(entries_.data(), static_cast<std::ptrdiff_t>(height_), cols_, x, y);
}

}  // namespace stridor
