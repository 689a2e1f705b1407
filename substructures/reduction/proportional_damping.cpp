#include "substructures/reduction/proportional_damping.hpp"

#include <cmath>

namespace stridor {
namespace {

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
