#include "substructures/matrices/massless_motions.hpp"

#include <fmt/format.h>

#include <Eigen/Cholesky>
#include <cmath>
#include <utility>

#include "core/errors.hpp"
#include "substructures/matrices/definiteness.hpp"
#include "substructures/matrices/symmetric_eigenpairs.hpp"

namespace stridor {
namespace {

/// Whether the Cholesky factor of M is far from breaking down. It may exist for a singular M, by
/// rounding, and eigenpairs by it are wrong then.
bool is_well_factored(const Eigen::MatrixXd& mass) {
  const Eigen::LLT<Eigen::MatrixXd> factor(mass);
  if (factor.info() != Eigen::Success) return false;
  const Eigen::ArrayXd pivots = factor.matrixLLT().diagonal().array().square();
  constexpr double least_ratio = 1e-12;
  return (pivots > least_ratio * mass.diagonal().array()).all();
}

}  // namespace

SemidefinitePairs semidefinite_eigenpairs(const Eigen::MatrixXd& stiffness,
                                          const Eigen::MatrixXd& mass, const std::string& what) {
  const Eigen::Index n = mass.rows();
  if (n == 0 || !mass.allFinite() || is_well_factored(mass)) {
    SymmetricEigenpairs pairs = generalised_eigenpairs(stiffness, mass, what);
    return {std::move(pairs.values), std::move(pairs.vectors), Eigen::MatrixXd(n, 0)};
  }
  if ((mass.diagonal().array() < 0.0).any())
    throw NumericalError(Refusal::singular,
                         what + ": the mass has a negative entry on its diagonal");
  // Unknowns without mass keep the scale of the stiffness.
  Eigen::VectorXd scale(n);
  for (Eigen::Index i = 0; i < n; ++i)
    scale(i) = mass(i, i) > 0.0 ? 1.0 / std::sqrt(mass(i, i)) : 1.0;
  const SymmetricEigenpairs masses =
      symmetric_eigenpairs(scale.asDiagonal() * mass * scale.asDiagonal(), what);
  if (masses.values(0) < -massless_ratio) {
    throw NumericalError(Refusal::singular,
                         fmt::format("{}: the mass is not positive semidefinite; scaled to a unit "
                                     "diagonal its least eigenvalue "
                                     "is {:.3g}",
                                     what, masses.values(0)));
  }
  const auto num_massless = (masses.values.array() <= massless_ratio).count();
  const Eigen::Index num_massive = n - num_massless;
  const Eigen::MatrixXd free = scale.asDiagonal() * masses.vectors.leftCols(num_massless);
  const Eigen::LLT<Eigen::MatrixXd> factor(free.transpose() * stiffness * free);
  const Eigen::MatrixXd own_stiffness = free.transpose() * stiffness * free;
  const bool is_held =
      factor.info() == Eigen::Success &&
      (factor.matrixLLT().diagonal().array().square() > 1e-12 * own_stiffness.diagonal().array())
          .all();
  if (!is_held) {
    throw NumericalError(
        Refusal::singular,
        what +
            ": some motion has neither mass nor stiffness; hold it, or leave "
            "the unknowns out that nothing holds (elements of reduced integration have "
            "such motions where they are one layer thick)");
  }
  SemidefinitePairs pairs;
  // N L⁻ᵀ with NᵀKN = L Lᵀ.
  pairs.massless = free;
  factor.matrixU().solveInPlace<Eigen::OnTheRight>(pairs.massless);
  const Eigen::MatrixXd massive =
      scale.asDiagonal() * masses.vectors.rightCols(num_massive) *
      masses.values.tail(num_massive).cwiseSqrt().cwiseInverse().asDiagonal();
  const Eigen::MatrixXd shared = pairs.massless.transpose() * stiffness * massive;
  const Eigen::MatrixXd follows = massive - pairs.massless * shared;
  Eigen::MatrixXd condensed = massive.transpose() * stiffness * massive;
  condensed -= shared.transpose() * shared;
  SymmetricEigenpairs found = symmetric_eigenpairs(
      0.5 * (condensed + condensed.transpose()), what);
  pairs.values = std::move(found.values);
  pairs.vectors = follows * found.vectors;
  return pairs;
}

}  // namespace stridor
