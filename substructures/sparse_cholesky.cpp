#include "substructures/sparse_cholesky.hpp"

#include <fmt/format.h>

#include <Eigen/CholmodSupport>

#include "core/errors.hpp"

namespace stridor {
namespace {

class Decomposition : public Eigen::CholmodSupernodalLLT<SparseMatrix, Eigen::Lower> {
 public:
  /// (min diag L / max diag L)²: an upper bound of the reciprocal condition number.
  double reciprocal_condition() { return cholmod_rcond(m_cholmodFactor, &cholmod()); }
};

/// A pivot this far below the largest is rounding, not stiffness: even the tip of a cantilever of
/// slenderness 1e4 is only (1e-4)³ times softer than its elements.
constexpr double smallest_pivot_ratio = 1e-15;

}  // namespace

struct SparseCholesky::Factor {
  Decomposition decomposition;
  Eigen::Index size = 0;
};

SparseCholesky::SparseCholesky(const SparseMatrix& matrix, const std::string& what)
    : factor_(std::make_unique<Factor>()) {
  factor_->size = matrix.rows();
  if (matrix.rows() == 0) return;
  Decomposition& decomposition = factor_->decomposition;
  decomposition.cholmod().print = 0;  // its warnings come back as exceptions here
  decomposition.compute(matrix);
  if (decomposition.info() != Eigen::Success ||
      !(decomposition.reciprocal_condition() > smallest_pivot_ratio)) {
    throw NumericalError(
        fmt::format("{} ({} x {}) is not positive definite: the supports and the interface leave a "
                    "rigid motion free, or the matrix is damaged",
                    what, matrix.rows(), matrix.cols()));
  }
}

SparseCholesky::~SparseCholesky() = default;
SparseCholesky::SparseCholesky(SparseCholesky&&) noexcept = default;
SparseCholesky& SparseCholesky::operator=(SparseCholesky&&) noexcept = default;

Eigen::MatrixXd SparseCholesky::solve(const Eigen::MatrixXd& right_hand_sides) const {
  if (factor_->size == 0 || right_hand_sides.cols() == 0) return right_hand_sides;
  return factor_->decomposition.solve(right_hand_sides);
}

Eigen::Index SparseCholesky::size() const {
  return factor_->size;
}

}  // namespace stridor
