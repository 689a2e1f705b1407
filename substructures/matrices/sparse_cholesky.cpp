#include "substructures/matrices/sparse_cholesky.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <span>
#include <utility>
#include <vector>

#include "core/activity.hpp"
#include "core/errors.hpp"
#include "substructures/matrices/supernodal_factor.hpp"
#include "substructures/matrices/supernode_kernels.hpp"

namespace stridor {
namespace {

/// Vectors in the order of L, in strips of eight; those that fill the last strip up are zero.
class Strips {
 public:
  Strips(const VectorBlockRef& block, std::span<const int> dofs)
      : size_(static_cast<Eigen::Index>(dofs.size())),
        num_strips_((block.cols() + strip_width - 1) / strip_width),
        numbers_(static_cast<std::size_t>(size_ * num_strips_ * strip_width)) {
    for (Eigen::Index strip = 0; strip < num_strips_; ++strip) {
      const Eigen::Index first = strip * strip_width;
      const Eigen::Index count = std::min(strip_width, block.cols() - first);
      double* to = at(strip, 0);
      for (Eigen::Index row = 0; row < size_; ++row, to += strip_width)
        std::copy_n(&block(dofs[static_cast<std::size_t>(row)], first), count, to);
    }
  }

  void write_to(VectorBlockRef& block, std::span<const int> dofs) {
    for (Eigen::Index strip = 0; strip < num_strips_; ++strip) {
      const Eigen::Index first = strip * strip_width;
      const Eigen::Index count = std::min(strip_width, block.cols() - first);
      const double* from = at(strip, 0);
      for (Eigen::Index row = 0; row < size_; ++row, from += strip_width)
        std::copy_n(from, count, &block(dofs[static_cast<std::size_t>(row)], first));
    }
  }

  Eigen::Index count() const { return num_strips_; }
  double* at(Eigen::Index strip, Eigen::Index row) {
    return numbers_.data() + (strip * size_ + row) * strip_width;
  }
  bool is_zero(Eigen::Index row, Eigen::Index count) {
    for (Eigen::Index strip = 0; strip < num_strips_; ++strip) {
      const double* begin = at(strip, row);
      if (!std::all_of(begin, begin + count * strip_width, [](double x) { return x == 0.0; }))
        return false;
    }
    return true;
  }

 private:
  Eigen::Index size_, num_strips_;
  std::vector<double> numbers_;
};

/// Numbers of L that stay in the cache while all strips pass over them.
constexpr Eigen::Index kept_in_cache = 16384;

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
  factor.clear_left_out(softest);
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
  SupernodalFactor decomposition;
  Eigen::Index size = 0;      ///< of the matrix
  std::vector<int> left_out;  ///< rows and columns that are not of L

  void solve_lower(Strips& strips) const {
    Eigen::Index own = 0;  // the first row of the supernode
    for (std::size_t k = 0; k < decomposition.num_supernodes(); ++k) {
      const Supernode node = decomposition.supernode(k);
      const Eigen::Index first = std::exchange(own, own + node.num_columns);
      if (strips.is_zero(first, node.num_columns)) continue;
      const SupernodeView view = node.view();
      for (Eigen::Index strip = 0; strip < strips.count(); ++strip)
        solve_lower_triangle(view, strips.at(strip, first));
      const Eigen::Index at_once = std::max<Eigen::Index>(8, kept_in_cache / node.num_columns);
      for (Eigen::Index row = 0; row < node.num_below(); row += at_once) {
        const Eigen::Index count = std::min(at_once, node.num_below() - row);
        for (Eigen::Index strip = 0; strip < strips.count(); ++strip)
          subtract_rows(view, node.num_columns + row, count, node.rows_below().data() + row,
                        strips.at(strip, first), strips.at(strip, 0));
      }
    }
  }

  void solve_upper(Strips& strips) const {
    auto own = static_cast<Eigen::Index>(decomposition.dofs().size());
    for (std::size_t k = decomposition.num_supernodes(); k-- > 0;) {
      const Supernode node = decomposition.supernode(k);
      own -= node.num_columns;
      const SupernodeView view = node.view();
      const Eigen::Index at_once = std::max<Eigen::Index>(
          8, kept_in_cache / std::max<Eigen::Index>(node.num_below(), 1) / 8 * 8);
      for (Eigen::Index column = 0; node.num_below() > 0 && column < node.num_columns;
           column += at_once) {
        const Eigen::Index count = std::min(at_once, node.num_columns - column);
        for (Eigen::Index strip = 0; strip < strips.count(); ++strip)
          subtract_columns(view, node.num_columns, node.num_below(), node.rows_below().data(),
                           column, count, strips.at(strip, 0), strips.at(strip, own));
      }
      for (Eigen::Index strip = 0; strip < strips.count(); ++strip)
        solve_upper_triangle(view, strips.at(strip, own));
    }
  }
};

SparseCholesky::SparseCholesky(const SparseMatrix& matrix, const std::string& what,
                               std::span<const int> left_out)
    : factor_(std::make_unique<Factor>()) {
  factor_->size = matrix.rows();
  factor_->left_out.assign(left_out.begin(), left_out.end());
  const std::vector<int> dofs = factorised_dofs();
  if (dofs.empty()) return;
  const Activity factorising(fmt::format("factorising {} x {}", dofs.size(), dofs.size()));
  if (!factor_->decomposition.factorise(matrix, dofs) ||
      !(softest_over_rounding(*this, matrix) > least_over_rounding)) {
    throw NumericalError(
        Refusal::singular,
        fmt::format("{} ({} x {}) is not positive definite: the supports and the interface leave a "
                    "rigid motion free, the body is too slender for its mesh, or the matrix is "
                    "damaged",
                    what, dofs.size(), dofs.size()));
  }
}

SparseCholesky::~SparseCholesky() = default;
SparseCholesky::SparseCholesky(SparseCholesky&&) noexcept = default;
SparseCholesky& SparseCholesky::operator=(SparseCholesky&&) noexcept = default;

Eigen::MatrixXd SparseCholesky::solve(const Eigen::MatrixXd& right_hand_sides) const {
  Eigen::MatrixXd solutions(right_hand_sides.rows(), right_hand_sides.cols());
  for (Eigen::Index first = 0; first < solutions.cols(); first += solved_together) {
    const Eigen::Index count = std::min(solved_together, solutions.cols() - first);
    VectorBlock block = right_hand_sides.middleCols(first, count);
    solve_in_place(block);
    solutions.middleCols(first, count) = block;
  }
  return solutions;
}

void SparseCholesky::solve(VectorBlockRef& block, Part part) const {
  if (block.size() == 0) return;
  const std::span<const int> dofs = factor_->decomposition.dofs();
  Strips strips(block, dofs);
  if (part != Part::upper) factor_->solve_lower(strips);
  if (part != Part::lower) factor_->solve_upper(strips);
  strips.write_to(block, dofs);
}

void SparseCholesky::solve_in_place(VectorBlockRef block) const {
  solve(block, Part::both);
}

void SparseCholesky::solve_lower_in_place(VectorBlockRef block) const {
  solve(block, Part::lower);
}

void SparseCholesky::solve_upper_in_place(VectorBlockRef block) const {
  solve(block, Part::upper);
}

Eigen::Index SparseCholesky::size() const {
  return factor_->size;
}

std::span<const int> SparseCholesky::left_out() const {
  return factor_->left_out;
}

std::vector<int> SparseCholesky::factorised_dofs() const {
  std::vector<bool> is_left_out(static_cast<std::size_t>(factor_->size), false);
  for (const int dof : factor_->left_out) is_left_out[static_cast<std::size_t>(dof)] = true;
  std::vector<int> dofs;
  dofs.reserve(is_left_out.size());
  for (std::size_t dof = 0; dof < is_left_out.size(); ++dof)
    if (!is_left_out[dof]) dofs.push_back(static_cast<int>(dof));
  return dofs;
}

Eigen::Index SparseCholesky::num_factorised() const {
  return static_cast<Eigen::Index>(factor_->decomposition.dofs().size());
}

std::size_t SparseCholesky::num_entries() const {
  return factor_->decomposition.num_entries();
}

}  // namespace stridor
