#include "substructures/matrices/sparse_cholesky.hpp"

#include <fmt/format.h>

#include <Eigen/CholmodSupport>
#include <algorithm>
#include <cmath>
#include <limits>
#include <new>
#include <span>

#include "core/activity.hpp"
#include "core/errors.hpp"

namespace stridor {
namespace {

/// Neighbouring columns of L that have their rows in common, stored dense: a lower triangle, and
/// the rows below it.
struct Supernode {
  std::span<const int> rows;  ///< of L, those of the triangle first
  Eigen::Index num_columns;
  const double* entries;  ///< rows.size() x num_columns, by columns

  using Part = Eigen::Map<const Eigen::MatrixXd, 0, Eigen::OuterStride<>>;
  Eigen::Index num_rows() const { return static_cast<Eigen::Index>(rows.size()); }
  Eigen::Index num_below() const { return num_rows() - num_columns; }
  std::span<const int> own_rows() const {
    return rows.first(static_cast<std::size_t>(num_columns));
  }
  std::span<const int> rows_below() const { return rows.subspan(own_rows().size()); }
  Part triangle() const { return {entries, num_columns, num_columns, num_rows()}; }
  Part below() const { return {entries + num_columns, num_below(), num_columns, num_rows()}; }
};

class Decomposition : public Eigen::CholmodSupernodalLLT<SparseMatrix, Eigen::Lower> {
 public:
  /// @throws std::bad_alloc
  void factorise(const SparseMatrix& matrix) {
    analyzePattern(matrix);
    if (m_cholmodFactor == nullptr) throw std::bad_alloc();
    factorize(matrix);
    if (cholmod().status < CHOLMOD_OK) throw std::bad_alloc();
  }

  std::size_t num_supernodes() const { return m_cholmodFactor->nsuper; }

  Supernode supernode(std::size_t k) const {
    const auto* column = static_cast<const int*>(m_cholmodFactor->super) + k;
    const auto* row = static_cast<const int*>(m_cholmodFactor->pi) + k;
    const auto* entry = static_cast<const int*>(m_cholmodFactor->px) + k;
    const auto* rows = static_cast<const int*>(m_cholmodFactor->s);
    return {{rows + row[0], rows + row[1]},
            column[1] - column[0],
            static_cast<const double*>(m_cholmodFactor->x) + entry[0]};
  }

  /// The DoF of each row of L.
  const int* dofs() const { return static_cast<const int*>(m_cholmodFactor->Perm); }
};

/// The right-hand sides at some rows of L: a column for each row, so that the parts of a supernode
/// act on it from the right, transposed.
using Panel = Eigen::MatrixXd::ColsBlockXpr;

void gather(const VectorBlockRef& block, const int* dofs, std::span<const int> rows, Panel panel) {
  Eigen::Index k = 0;
  for (const int row : rows) panel.col(k++) = block.row(dofs[row]);
}

void scatter(const Panel& panel, const int* dofs, std::span<const int> rows,
             VectorBlockRef& block) {
  Eigen::Index k = 0;
  for (const int row : rows) block.row(dofs[row]) = panel.col(k++);
}

/// Right-hand sides that `solve` takes through the factor together.
constexpr Eigen::Index solved_together = 32;

/// Ratio of the softest motion of A to rounding: xᵀ A x / (ε √Σ (A_ij x_i x_j)²), where x is the
/// result of two inverse iterations from an arbitrary start.
///
/// Rounding may hide from the factorisation that A is singular: the last pivot is then positive by
/// chance. It is about ten times the reciprocal of this ratio in the stiffness of the softest
/// motion.
double softest_over_rounding(const SparseCholesky& factor, const SparseMatrix& matrix) {
  Eigen::VectorXd start;
  Eigen::VectorXd softest(matrix.rows());
  for (Eigen::Index i = 0; i < matrix.rows(); ++i)
    softest(i) = 1.0 + 0.5 * std::sin(static_cast<double>(i + 1));
  for (int iteration = 0; iteration < 2; ++iteration) {
    start = softest.normalized();
    softest = factor.solve(start);
  }
  double squares = 0.0;
  for (Eigen::Index column = 0; column < matrix.cols(); ++column) {
    for (SparseMatrix::InnerIterator entry(matrix, column); entry; ++entry) {
      const double term = entry.value() * softest(entry.row()) * softest(column);
      squares += term * term;
    }
  }
  return softest.dot(start) / (std::numeric_limits<double>::epsilon() * std::sqrt(squares));
}

/// Anything less stiff than this is a rigid motion, or as good as unknown. Rigid motions of beams
/// reach 15, whatever the mesh; bending of a cantilever of slenderness 1e3 comes to 4e3.
constexpr double least_over_rounding = 100.0;

}  // namespace

struct SparseCholesky::Factor {
  Decomposition decomposition;
  Eigen::Index size = 0;
  Eigen::Index widest = 0;   ///< columns of a supernode, at most
  Eigen::Index deepest = 0;  ///< rows below its triangle, at most
};

SparseCholesky::SparseCholesky(const SparseMatrix& matrix, const std::string& what)
    : factor_(std::make_unique<Factor>()) {
  factor_->size = matrix.rows();
  if (matrix.rows() == 0) return;
  const Activity factorising(fmt::format("factorising {} x {}", matrix.rows(), matrix.cols()));
  Decomposition& decomposition = factor_->decomposition;
  decomposition.cholmod().print = 0;  // its warnings come back as exceptions here
  const auto refuse = [&] {
    throw NumericalError(
        fmt::format("{} ({} x {}) is not positive definite: the supports and the interface leave a "
                    "rigid motion free, the body is too slender for its mesh, or the matrix is "
                    "damaged",
                    what, matrix.rows(), matrix.cols()));
  };
  decomposition.factorise(matrix);
  if (decomposition.info() != Eigen::Success) refuse();
  for (std::size_t k = 0; k < decomposition.num_supernodes(); ++k) {
    const Supernode node = decomposition.supernode(k);
    factor_->widest = std::max(factor_->widest, node.num_columns);
    factor_->deepest = std::max(factor_->deepest, node.num_below());
  }
  if (!(softest_over_rounding(*this, matrix) > least_over_rounding)) refuse();
}

SparseCholesky::~SparseCholesky() = default;
SparseCholesky::SparseCholesky(SparseCholesky&&) noexcept = default;
SparseCholesky& SparseCholesky::operator=(SparseCholesky&&) noexcept = default;

Eigen::MatrixXd SparseCholesky::solve(const Eigen::MatrixXd& right_hand_sides) const {
  Eigen::MatrixXd solutions(right_hand_sides.rows(), right_hand_sides.cols());
  for (Eigen::Index first = 0; first < solutions.cols(); first += solved_together) {
    const Eigen::Index count = std::min(solved_together, solutions.cols() - first);
    VectorBlock block = right_hand_sides.middleCols(first, count);
    solve_lower_in_place(block);
    solve_upper_in_place(block);
    solutions.middleCols(first, count) = block;
  }
  return solutions;
}

void SparseCholesky::solve_lower_in_place(VectorBlockRef block) const {
  if (block.size() == 0) return;
  const Decomposition& decomposition = factor_->decomposition;
  const int* dofs = decomposition.dofs();
  Eigen::MatrixXd own_columns(block.cols(), factor_->widest);
  Eigen::MatrixXd columns_below(block.cols(), factor_->deepest);
  for (std::size_t k = 0; k < decomposition.num_supernodes(); ++k) {
    const Supernode node = decomposition.supernode(k);
    Panel own = own_columns.leftCols(node.num_columns);
    gather(block, dofs, node.own_rows(), own);
    if ((own.array() == 0.0).all()) continue;
    node.triangle().transpose().triangularView<Eigen::Upper>().solveInPlace<Eigen::OnTheRight>(own);
    scatter(own, dofs, node.own_rows(), block);
    if (node.num_below() == 0) continue;
    Panel below = columns_below.leftCols(node.num_below());
    below.noalias() = own * node.below().transpose();
    Eigen::Index i = 0;
    for (const int row : node.rows_below()) block.row(dofs[row]) -= below.col(i++);
  }
}

void SparseCholesky::solve_upper_in_place(VectorBlockRef block) const {
  if (block.size() == 0) return;
  const Decomposition& decomposition = factor_->decomposition;
  const int* dofs = decomposition.dofs();
  Eigen::MatrixXd own_columns(block.cols(), factor_->widest);
  Eigen::MatrixXd columns_below(block.cols(), factor_->deepest);
  for (std::size_t k = decomposition.num_supernodes(); k-- > 0;) {
    const Supernode node = decomposition.supernode(k);
    Panel own = own_columns.leftCols(node.num_columns);
    gather(block, dofs, node.own_rows(), own);
    if (node.num_below() > 0) {
      Panel below = columns_below.leftCols(node.num_below());
      gather(block, dofs, node.rows_below(), below);
      own.noalias() -= below * node.below();
    }
    node.triangle().triangularView<Eigen::Lower>().solveInPlace<Eigen::OnTheRight>(own);
    scatter(own, dofs, node.own_rows(), block);
  }
}

Eigen::Index SparseCholesky::size() const {
  return factor_->size;
}

}  // namespace stridor
