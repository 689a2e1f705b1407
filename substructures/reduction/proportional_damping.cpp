#include "substructures/reduction/proportional_damping.hpp"

#include <cmath>

namespace stridor {
namespace {

/// Whether an entry differs from its mirror by more than this. It looks at the first entry of each
/// column alone: a matrix with a skew part mostly shows it there, and no other matrix is made.
bool is_plainly_unsymmetric(const SparseMatrix& matrix, double least) {
  for (int column = 0; column < matrix.cols(); ++column) {
    const SparseMatrix::InnerIterator first(matrix, column);
    if (first && std::abs(first.value() - matrix.coeff(column, first.row())) > least) return true;
  }
  return false;
}

double dot(const SparseMatrix& a, const SparseMatrix& b) {
  return a.cwiseProduct(b).sum();
}

}  // namespace

std::optional<RayleighDamping> proportional_damping(const SparseMatrix& velocity,
                                                    const SparseMatrix& mass,
                                                    const SparseMatrix& stiffness) {
  constexpr double tolerance = 1e-12;
  const double size = velocity.norm();
  if (size == 0.0) return RayleighDamping{};
  // What is skew is no part of either; most often that decides, at a fraction of what follows.
  if (is_plainly_unsymmetric(velocity, 2.0 * tolerance * size)) return std::nullopt;
  const SparseMatrix skew = velocity - SparseMatrix(velocity.transpose());
  if (0.5 * skew.norm() > tolerance * size) return std::nullopt;
  // Of unit size, or the normal equations lose the mass beside the stiffness.
  const double mass_norm = mass.norm();
  const double stiffness_norm = stiffness.norm();
  const SparseMatrix M = mass / mass_norm;
  const SparseMatrix K = stiffness_norm > 0.0 ? SparseMatrix(stiffness / stiffness_norm)
                                              : SparseMatrix(mass.rows(), mass.cols());
  const SparseMatrix C = velocity / size;
  const double overlap = dot(M, K);
  const double independent = dot(K, K) - overlap * overlap;
  // Where K is a multiple of M the split between both is free: all of it goes to M.
  constexpr double least_independent = 1e-12;
  double by_mass = 0.0;
  double by_stiffness = 0.0;
  SparseMatrix rest = C;
  // The second pass removes the rounding error of the first.
  for (int pass = 0; pass < 2; ++pass) {
    const double on_mass = dot(M, rest);
    const double on_stiffness = dot(K, rest);
    const double beta =
        independent > least_independent ? (on_stiffness - overlap * on_mass) / independent : 0.0;
    by_stiffness += beta;
    by_mass += on_mass - overlap * beta;
    rest = C - by_mass * M - by_stiffness * K;
  }
  for (double* part : {&by_mass, &by_stiffness})
    if (std::abs(*part) <= tolerance) *part = 0.0;
  rest = C - by_mass * M - by_stiffness * K;
  if (!(rest.norm() <= tolerance) || by_mass < 0.0 || by_stiffness < 0.0) return std::nullopt;
  RayleighDamping damping;
  damping.alpha = by_mass * size / mass_norm;
  damping.beta = by_stiffness > 0.0 ? by_stiffness * size / stiffness_norm : 0.0;
  return damping;
}

}  // namespace stridor
