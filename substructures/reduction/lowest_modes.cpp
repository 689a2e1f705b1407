#include "substructures/reduction/lowest_modes.hpp"

#include <fmt/format.h>

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <limits>
#include <random>
#include <stdexcept>
#include <vector>

#include "core/activity.hpp"
#include "core/errors.hpp"
#include "core/stop_token.hpp"
#include "substructures/matrices/massless_motions.hpp"
#include "substructures/matrices/supernode_kernels.hpp"
#include "substructures/matrices/symmetric_eigenpairs.hpp"

namespace stridor {
namespace {

using SymmetricEigen = Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd>;

/// Vectors by which the Krylov space grows at a time. A pass over the factor or the mass serves all
/// of them; with more of them the space would have to be larger.
constexpr Eigen::Index block_width = strip_width;

Modes dense_modes(const SparseCholesky& factor, const SparseMatrix& stiffness,
                  const SparseMatrix& mass, Eigen::Index count) {
  const std::vector<int> dofs = factor.factorised_dofs();
  const auto part = [&](const SparseMatrix& matrix) {
    return Eigen::MatrixXd(Eigen::MatrixXd(matrix)(dofs, dofs));
  };
  const SemidefinitePairs all =
      semidefinite_eigenpairs(part(stiffness), part(mass), "fixed-interface modes");
  if (count > all.values.size()) {
    throw NumericalError(Refusal::cannot_reduce,
                         fmt::format("fixed-interface modes: {} asked, but only {} of the {} "
                                     "motions of the interior have mass; "
                                     "ask for that many at most",
                                     count, all.values.size(), dofs.size()));
  }
  Modes modes{all.values.head(count), Eigen::MatrixXd::Zero(mass.rows(), count)};
  modes.shapes(dofs, Eigen::all) = all.vectors.leftCols(count);
  return modes;
}

/// Replaces W by orthonormal columns Q with W = Q R, and returns R.
///
/// Directions in which W is no longer than `negligible` are left out, so Q may have fewer columns.
/// The Gram matrix of W holds squares, in which lengths below 1e-8 of the longest drown in
/// rounding; directions as short as that are stretched by 1e7 only, and seen better in the next
/// round.
///
/// @param scratch memory kept from call to call
Eigen::MatrixXd orthonormalise(VectorBlock& block, double negligible, VectorBlock& scratch) {
  Eigen::MatrixXd factor = Eigen::MatrixXd::Identity(block.cols(), block.cols());
  bool is_orthonormal = false;
  while (!is_orthonormal && block.cols() > 0) {
    const Eigen::MatrixXd products = block.transpose() * block;
    const SymmetricEigen gram(products);
    Eigen::VectorXd lengths = gram.eigenvalues().cwiseMax(0.0).cwiseSqrt();
    const double longest = lengths.maxCoeff();
    is_orthonormal = lengths.minCoeff() > 1e-2 * longest;
    lengths = lengths.cwiseMax(1e-7 * longest);
    const Eigen::Index num_kept = (lengths.array() > negligible).count();
    const auto kept = lengths.tail(num_kept);
    const auto directions = gram.eigenvectors().rightCols(num_kept);
    scratch.noalias() = block * (directions * kept.cwiseInverse().asDiagonal());
    block.swap(scratch);
    factor = (kept.asDiagonal() * directions.transpose() * factor).eval();
    negligible = 1e-6;  // what was stretched and is still this short was rounding
  }
  return factor;
}

/// Residual |A y − ν y| / ν at which an eigenpair has converged.
constexpr double tolerance = 1e-12;

/// When the approximations in a Krylov space are worth a look, which costs as much as some steps.
///
/// The logarithm of the largest residual falls about evenly with the dimension, and faster towards
/// the end. Two looks tell where it will reach the tolerance.
class LookSchedule {
 public:
  explicit LookSchedule(Eigen::Index first_look) : next_(first_look) {}

  bool is_due(Eigen::Index dim) const { return dim >= next_; }

  void looked(Eigen::Index dim, double residual) {
    // Not far enough apart, or not falling: some steps more.
    Eigen::Index steps = std::max(2 * block_width, dim / 16);
    const double excess = std::log(std::max(residual, tolerance) / tolerance);
    const double fall = (last_excess_ - excess) / static_cast<double>(dim - last_dim_);
    if (last_dim_ > 0 && std::isfinite(fall) && fall > 0.0) {
      const double needed = std::min(excess / fall, static_cast<double>(dim / 2));
      steps = std::max(block_width, static_cast<Eigen::Index>(needed));
    }
    last_dim_ = dim;
    last_excess_ = excess;
    next_ = dim + steps;
  }

 private:
  Eigen::Index next_;
  Eigen::Index last_dim_ = 0;
  double last_excess_ = 0.0;  ///< logarithm of the largest residual over the tolerance
};

/// Block Lanczos for the largest eigenvalues ν = 1/ω² of A = L⁻¹ M L⁻ᵀ, where K = L Lᵀ.
///
/// The Krylov space has an orthonormal basis V with A V = V T + Q R Eᵀ, where T = Vᵀ A V and Eᵀ
/// takes the part of the newest block. Eigenpairs (ν, s) of T are approximate ones of A, with y = V
/// s and |A y − ν y| = |R Eᵀ s|; the mode is φ = L⁻ᵀ y. A full space is replaced by its best
/// approximations, for which the equation holds as well.
class Lanczos {
 public:
  Lanczos(const SparseCholesky& stiffness, const SparseMatrix& mass, Eigen::Index count)
      : stiffness_(stiffness),
        mass_(mass),
        count_(count),
        // The constant part is for clustered eigenvalues, which ask for many steps.
        basis_(mass.rows(), std::min(stiffness.num_factorised(), 3 * count + 30 * block_width)),
        projection_(basis_.cols(), basis_.cols()) {}

  /// @throws NumericalError
  Modes solve();

 private:
  /// W = V H + Q R with Q orthonormal and orthogonal to V.
  struct Split {
    Eigen::MatrixXd inside;   ///< H
    Eigen::MatrixXd outside;  ///< R
  };

  VectorBlock random_block();
  void append(const VectorBlock& block);
  void apply(VectorBlock& block);
  Split split(VectorBlock& block);
  void restart();

  const SparseCholesky& stiffness_;
  const SparseMatrix& mass_;
  Eigen::Index count_;
  Eigen::MatrixXd basis_;       ///< V in the first dim_ columns
  Eigen::MatrixXd projection_;  ///< T in the first dim_ rows and columns; lower triangle
  Eigen::Index dim_ = 0;
  Eigen::Index newest_ = 0;     ///< first column of the newest block
  Eigen::Index neighbour_ = 0;  ///< first column of the block before it
  std::mt19937 generator_;
  VectorBlock scratch_;  ///< the size of a block, kept from step to step
  Eigen::MatrixXd scratch_by_columns_;
};

Modes Lanczos::solve() {
  constexpr int max_steps = 1000;
  Eigen::Index num_converged = 0;
  // Earlier, only what exhausts the space has converged.
  LookSchedule looks(2 * count_ + 5 * block_width);
  VectorBlock block = random_block();
  for (int step = 0; step < max_steps; ++step) {
    throw_if_stopped();
    append(block);
    apply(block);
    if (!block.allFinite()) break;
    const Split parts = split(block);
    const Eigen::Index newest_width = dim_ - newest_;
    projection_.block(newest_, 0, newest_width, dim_) = parts.inside.transpose();

    const bool is_exhausted = block.cols() == 0;
    const bool is_full = dim_ + block.cols() > basis_.cols();
    if (!looks.is_due(dim_) && !is_exhausted && !is_full) continue;
    const Eigen::Index num_looked_at = std::min(count_, dim_);
    const SymmetricEigenpairs ritz = highest_eigenpairs(projection_.topLeftCorner(dim_, dim_),
                                                        num_looked_at, "fixed-interface modes");
    const Eigen::VectorXd values = ritz.values.reverse();
    const Eigen::MatrixXd vectors = ritz.vectors.rowwise().reverse();
    const Eigen::ArrayXd residuals =
        (parts.outside * vectors.bottomRows(newest_width)).colwise().norm().transpose();
    const Eigen::ArrayXd relative = residuals / values.array().abs();
    num_converged = (residuals <= tolerance * values.array().abs()).count();
    if (num_converged == count_) {
      if (!(values(count_ - 1) > 0.0))
        throw NumericalError(Refusal::singular,
                             "fixed-interface modes: the mass is not positive definite");
      VectorBlock shapes = basis_.leftCols(dim_) * vectors;
      stiffness_.solve_upper_in_place(shapes);
      return {values.cwiseInverse(), shapes};
    }
    if (is_full) {
      restart();
      looks = LookSchedule(dim_ + 5 * block_width);
    } else {
      looks.looked(dim_, relative.maxCoeff());
    }
    if (is_exhausted) block = random_block();
  }
  throw NumericalError(Refusal::eigenvalues_incomplete,
                       fmt::format("fixed-interface modes: Lanczos found {} of {} eigenpairs",
                                   num_converged, count_));
}

/// Orthonormal and outside the space; the same in every run.
VectorBlock Lanczos::random_block() {
  VectorBlock block(basis_.rows(), block_width);
  for (double& entry : block.reshaped())
    entry = static_cast<double>(generator_()) - 0.5 * static_cast<double>(std::mt19937::max());
  stiffness_.clear_left_out(block);
  split(block);
  return block;
}

void Lanczos::append(const VectorBlock& block) {
  basis_.middleCols(dim_, block.cols()) = block;
  neighbour_ = newest_;
  newest_ = dim_;
  dim_ += block.cols();
}

/// W <- A W.
void Lanczos::apply(VectorBlock& block) {
  stiffness_.solve_upper_in_place(block);
  if (block.cols() == strip_width && mass_.isCompressed()) {
    // M is symmetric.
    scratch_.resize(block.rows(), block.cols());
    multiply_columns(mass_.cols(), mass_.outerIndexPtr(), mass_.innerIndexPtr(), mass_.valuePtr(),
                     strip_width, block.data(), scratch_.data());
  } else {
    scratch_.noalias() = mass_ * block;
  }
  stiffness_.clear_left_out(scratch_);
  block.swap(scratch_);
  stiffness_.solve_lower_in_place(block);
}

/// Splits W, of which Q stays in `block`.
Lanczos::Split Lanczos::split(VectorBlock& block) {
  Split parts{Eigen::MatrixXd::Zero(dim_, block.cols()),
              Eigen::MatrixXd::Identity(block.cols(), block.cols())};
  const auto take_out = [&](Eigen::Index first) {
    const auto basis = basis_.middleCols(first, dim_ - first);
    const Eigen::MatrixXd inside = basis.transpose() * block;
    scratch_by_columns_.noalias() = basis * inside;
    block -= scratch_by_columns_;
    parts.inside.bottomRows(dim_ - first) += inside * parts.outside;
  };
  // A couples neighbouring blocks only. What W has of the others is rounding, which would grow from
  // step to step if left in. One round for all does not do: it would leave the large parts in,
  // multiplied by what V lacks in orthogonality.
  const double scale = block.norm();
  take_out(neighbour_);
  take_out(0);
  parts.outside = orthonormalise(block, 1e-14 * scale, scratch_);
  if (block.cols() == 0) return parts;
  // In short directions of W that rounding weighs more; those that held nothing else are left out.
  const Eigen::MatrixXd squares = parts.outside.transpose() * parts.outside;
  if (std::sqrt(SymmetricEigen(squares).eigenvalues().minCoeff()) < 1e-3 * scale) {
    take_out(0);
    parts.outside = (orthonormalise(block, 0.1, scratch_) * parts.outside).eval();
  }
  return parts;
}

/// Keeps the better half of the approximations.
void Lanczos::restart() {
  const Eigen::Index kept = count_ + (dim_ - count_) / 2;
  const SymmetricEigenpairs ritz = highest_eigenpairs(projection_.topLeftCorner(dim_, dim_), kept,
                                                      "fixed-interface modes");
  const Eigen::VectorXd values = ritz.values.reverse();
  const Eigen::MatrixXd vectors = ritz.vectors.rowwise().reverse();
  constexpr Eigen::Index rows_at_once = 4096;
  for (Eigen::Index row = 0; row < basis_.rows(); row += rows_at_once) {
    const Eigen::Index num_rows = std::min(rows_at_once, basis_.rows() - row);
    const Eigen::MatrixXd part = basis_.block(row, 0, num_rows, dim_) * vectors;
    basis_.block(row, 0, num_rows, kept) = part;
  }
  projection_.topLeftCorner(kept, kept) = values.asDiagonal();
  dim_ = kept;
  newest_ = 0;  // all of them couple to the next block
}

/// Rounding in the product of a matrix with each of some vectors x: ε √Σ (A_ij x_j)².
Eigen::RowVectorXd product_rounding(const SparseMatrix& matrix, const VectorBlock& vectors) {
  Eigen::RowVectorXd squares = Eigen::RowVectorXd::Zero(vectors.cols());
  for (Eigen::Index column = 0; column < matrix.cols(); ++column)
    squares += matrix.col(column).squaredNorm() * vectors.row(column).cwiseAbs2();
  return std::numeric_limits<double>::epsilon() * squares.cwiseSqrt();
}

}  // namespace

Modes lowest_modes(const SparseCholesky& stiffness, const SparseMatrix& stiffness_matrix,
                   const SparseMatrix& mass, Eigen::Index count) {
  const Eigen::Index size = stiffness.num_factorised();
  if (count < 0 || count > size) {
    throw std::invalid_argument(
        fmt::format("lowest_modes: {} modes asked of {} DoFs", count, size));
  }
  if (count == 0) return {Eigen::VectorXd(0), Eigen::MatrixXd(mass.rows(), 0)};
  // A Krylov space needs room beyond the wanted pairs; without it the dense solver is as cheap.
  const Activity searching(fmt::format("{} modes of {} unknowns", count, size));
  const bool is_small = size <= 2 * count + 20 || size <= 60;
  Modes modes = is_small ? dense_modes(stiffness, stiffness_matrix, mass, count)
                         : Lanczos(stiffness, mass, count).solve();

  const VectorBlock shapes = modes.shapes;
  VectorBlock inertia = mass * shapes;
  VectorBlock force = stiffness_matrix * shapes;
  stiffness.clear_left_out(inertia);
  stiffness.clear_left_out(force);
  const Eigen::RowVectorXd rounding = product_rounding(stiffness_matrix, shapes);
  for (Eigen::Index i = 0; i < count; ++i) {
    const double residual = (force.col(i) - modes.omega_squared(i) * inertia.col(i)).norm();
    if (!(residual < 1e-6 * force.col(i).norm() + 10.0 * rounding(i))) {
      throw NumericalError(
          Refusal::eigenvalues_incomplete,
          fmt::format("fixed-interface modes: eigenpair {} has a residual of {:.1e}", i + 1,
                      residual / force.col(i).norm()));
    }
    auto shape = modes.shapes.col(i);
    Eigen::Index largest = 0;
    shape.cwiseAbs().maxCoeff(&largest);
    shape *= (shape(largest) < 0.0 ? -1.0 : 1.0) / std::sqrt(shape.dot(inertia.col(i)));
  }
  return modes;
}

}  // namespace stridor
