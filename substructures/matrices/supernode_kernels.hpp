// Inner loops of sparse triangular solves and products for eight vectors at a time.
#pragma once

#include <cstddef>

namespace stridor {

/// Vectors that a kernel takes through together: row i of such a strip is `strip[8 i]` to
/// `strip[8 i + 7]`.
inline constexpr std::ptrdiff_t strip_width = 8;

/// Columns of L that have their rows in common: one column after the other, each from its diagonal
/// down.
struct SupernodeView {
  const double* entries;  ///< of row 0 and column 0
  std::ptrdiff_t num_rows;
  std::ptrdiff_t num_columns;

  /// Where row 0 of a column would be; row r is r numbers further on.
  const double* column(std::ptrdiff_t c) const { return entries + c * num_rows - c * (c + 1) / 2; }
};

/// X <- T⁻¹ X for the lower triangle T of the first rows. @param own strip of these rows
void solve_lower_triangle(const SupernodeView& node, double* own);
/// X <- T⁻ᵀ X.
void solve_upper_triangle(const SupernodeView& node, double* own);
/// Y_r <- Y_r − B X, B the rows first .. first + count of the node, r = rows[0 .. count].
void subtract_rows(const SupernodeView& node, std::ptrdiff_t first, std::ptrdiff_t count,
                   const int* rows, const double* own, double* strip);
/// X <- X − Bᵀ Y_r for the columns first .. first + count of B, whose rows begin with row `offset`.
void subtract_columns(const SupernodeView& node, std::ptrdiff_t offset, std::ptrdiff_t num_rows,
                      const int* rows, std::ptrdiff_t first, std::ptrdiff_t count,
                      const double* strip, double* own);

/// y_j = Σ a_k x_{rows[k]} over the entries k of each column j: A X where A is symmetric. Rows of x
/// and y are `stride` apart, at least eight numbers.
void multiply_columns(std::ptrdiff_t num_columns, const int* starts, const int* rows,
                      const double* entries, std::ptrdiff_t stride, const double* x, double* y);

}  // namespace stridor
