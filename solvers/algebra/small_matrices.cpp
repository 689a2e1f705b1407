#include "solvers/algebra/small_matrices.hpp"

#include <cmath>

namespace stridor {

using Complex = std::complex<double>;

bool equilibrate(Eigen::MatrixXcd& B, Eigen::MatrixXcd& slope) {
  const Eigen::Index size = B.rows();
  for (Eigen::Index j = 0; j < size; ++j) {
    const double largest = std::sqrt(B.col(j).cwiseAbs2().maxCoeff());
    if (largest == 0.0) return false;
    for (Eigen::Index i = 0; i < size; ++i) {
      B(i, j) *= 1.0 / largest;
      slope(i, j) *= 1.0 / largest;
    }
  }
  for (Eigen::Index i = 0; i < size; ++i) {
    const double largest = std::sqrt(B.row(i).cwiseAbs2().maxCoeff());
    if (largest == 0.0) return false;
    for (Eigen::Index j = 0; j < size; ++j) {
      B(i, j) *= 1.0 / largest;
      slope(i, j) *= 1.0 / largest;
    }
  }
  return true;
}

Complex determinant_of(Eigen::MatrixXcd& B) {
  const Eigen::Index size = B.rows();
  Complex product = 1.0;
  for (Eigen::Index k = 0; k < size; ++k) {
    Eigen::Index pivot = k;
    for (Eigen::Index i = k + 1; i < size; ++i) {
      if (std::norm(B(i, k)) > std::norm(B(pivot, k))) pivot = i;
    }
    if (B(pivot, k) == 0.0) return 0.0;
    if (pivot != k) {
      B.row(k).swap(B.row(pivot));
      product = -product;
    }
    product *= B(k, k);
    const Complex scale = reciprocal(B(k, k));
    for (Eigen::Index i = k + 1; i < size; ++i) {
      const Complex factor = B(i, k) * scale;
      for (Eigen::Index j = k + 1; j < size; ++j) B(i, j) -= factor * B(k, j);
    }
  }
  return product;
}

std::optional<Complex> trace_of_solution(Eigen::MatrixXcd& B, Eigen::MatrixXcd& C) {
  const Eigen::Index size = B.rows();
  for (Eigen::Index k = 0; k < size; ++k) {
    Eigen::Index pivot = k;
    for (Eigen::Index i = k + 1; i < size; ++i) {
      if (std::norm(B(i, k)) > std::norm(B(pivot, k))) pivot = i;
    }
    if (B(pivot, k) == 0.0) return std::nullopt;
    if (pivot != k) {
      B.row(k).swap(B.row(pivot));
      C.row(k).swap(C.row(pivot));
    }
    const Complex scale = reciprocal(B(k, k));
    for (Eigen::Index j = k + 1; j < size; ++j) B(k, j) *= scale;
    for (Eigen::Index j = 0; j < size; ++j) C(k, j) *= scale;
    for (Eigen::Index i = 0; i < size; ++i) {
      if (i == k) continue;
      const Complex factor = B(i, k);
      for (Eigen::Index j = k + 1; j < size; ++j) B(i, j) -= factor * B(k, j);
      for (Eigen::Index j = 0; j < size; ++j) C(i, j) -= factor * C(k, j);
    }
  }
  return C.trace();
}

}  // namespace stridor
