// Eigenvalues by Arnoldi's method on the linearised problem: the second method for sparse spectra.
#pragma once

#include <Eigen/Eigenvalues>
#include <Eigen/SparseLU>
#include <algorithm>
#include <complex>
#include <random>
#include <vector>

#include "substructures/bodies/matrix_body.hpp"

namespace stridor::test {

/// Eigenvalues next to a shift, nearest first, from a Krylov space of the linearised problem
///
///   v' − σ x' = x,  (σ² M + σ P + Q) x' = −(M v + P x + σ M x)
///
/// with the factorisation of Eigen. Those whose residual of the Krylov space is below 1e-9 count.
inline std::vector<std::complex<double>> eigenvalues_next_to(const SparseSystem& system,
                                                             std::complex<double> shift,
                                                             Eigen::Index num_vectors) {
  using Complex = std::complex<double>;
  using Matrix = Eigen::SparseMatrix<Complex>;
  const Eigen::Index n = system.size();
  const double scale = std::abs(shift);
  Matrix P = Matrix(system.mass.cast<Complex>()) * (shift * shift);
  P += Matrix(system.velocity.cast<Complex>()) * shift;
  P += Matrix(system.position.cast<Complex>());
  P.makeCompressed();
  Eigen::SparseLU<Matrix> factor(P);
  Eigen::MatrixXcd V(2 * n, num_vectors + 1);
  Eigen::MatrixXcd H = Eigen::MatrixXcd::Zero(num_vectors + 1, num_vectors);
  std::mt19937 generator(3);
  std::normal_distribution<double> normal;
  for (Complex& entry : V.col(0)) entry = {normal(generator), normal(generator)};
  V.col(0).normalize();
  for (Eigen::Index k = 0; k < num_vectors; ++k) {
    const Eigen::VectorXcd x = V.col(k).head(n);
    const Eigen::VectorXcd v = scale * V.col(k).tail(n);
    const Eigen::VectorXcd momentum = v + shift * x;
    const Eigen::VectorXcd force = -(system.mass * momentum + system.velocity * x);
    Eigen::VectorXcd next(2 * n);
    next.head(n) = factor.solve(force);
    next.tail(n) = (x + shift * next.head(n)) / scale;
    for (int round = 0; round < 2; ++round) {
      const Eigen::VectorXcd inside = V.leftCols(k + 1).adjoint() * next;
      next -= V.leftCols(k + 1) * inside;
      H.col(k).head(k + 1) += inside;
    }
    H(k + 1, k) = next.norm();
    V.col(k + 1) = next / H(k + 1, k);
  }
  const Eigen::ComplexEigenSolver<Eigen::MatrixXcd> ritz(H.topRows(num_vectors));
  std::vector<std::pair<double, Complex>> found;
  for (Eigen::Index i = 0; i < num_vectors; ++i) {
    const Complex theta = ritz.eigenvalues()(i);
    const double residual =
        std::abs(H(num_vectors, num_vectors - 1) * ritz.eigenvectors()(num_vectors - 1, i));
    if (residual > 1e-9 * std::abs(theta)) continue;
    found.emplace_back(1.0 / std::abs(theta), shift + 1.0 / theta);
  }
  std::sort(found.begin(), found.end(),
            [](const auto& a, const auto& b) { return a.first < b.first; });
  std::vector<Complex> eigenvalues;
  for (const auto& one : found) eigenvalues.push_back(one.second);
  return eigenvalues;
}

}  // namespace stridor::test
