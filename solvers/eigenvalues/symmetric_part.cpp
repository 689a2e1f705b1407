#include "solvers/eigenvalues/symmetric_part.hpp"

#include <algorithm>
#include <cmath>

#include "core/errors.hpp"

namespace stridor {

Modes symmetric_modes(const SparseSystem& system, Eigen::Index count) {
  const SparseMatrix transposed = system.position.transpose();
  const SparseMatrix stiffness = 0.5 * (system.position + transposed);
  const double scale =
      stiffness.diagonal().cwiseAbs().maxCoeff() / system.mass.diagonal().cwiseAbs().maxCoeff();
  if (!(scale > 0.0))
    throw NumericalError(Refusal::eigenvalues_incomplete,
                         "sparse eigenvalues: there is no stiffness");
  for (double shift = 1e-12 * scale;; shift *= 10.0) {
    const SparseMatrix shifted = stiffness + shift * system.mass;
    try {
      const SparseCholesky factor(shifted, "the stiffness");
      Modes modes = lowest_modes(factor, shifted, system.mass, count);
      modes.omega_squared.array() -= shift;
      return modes;
    } catch (const NumericalError&) {
      if (shift > 1e3 * scale) throw;
    }
  }
}

SparseMatrix with_little_mass(const SparseMatrix& mass) {
  constexpr double little = 1e-9;
  const double mean = mass.diagonal().cwiseAbs().mean();
  SparseMatrix more = mass;
  for (Eigen::Index i = 0; i < mass.rows(); ++i)
    more.coeffRef(i, i) += little * std::max(std::abs(mass.coeff(i, i)), 1e-6 * mean);
  more.makeCompressed();
  return more;
}

}  // namespace stridor
