#include "solvers/eigenvalues/pair_basis.hpp"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "solvers/eigenvalues/complex_eigenpairs.hpp"

namespace stridor {
namespace {

using Complex = std::complex<double>;

constexpr double certified_residual = 1e-6;  ///< of a pair, as in sparse_spectrum()

/// Columns that span those of a matrix, and how they come from them.
struct Orthonormal {
  Eigen::MatrixXcd basis;    ///< orthonormal, the most important directions first
  Eigen::MatrixXcd mixture;  ///< basis = matrix · mixture
};

Orthonormal orthonormal(const Eigen::MatrixXcd& matrix) {
  // Of a direction. A share that is left out is rough, and its residual larger by the ratio of the stiffest
  // motion to the slow ones, 1e6 on a fine mesh; what it costs to keep rounding is nothing.
  constexpr double new_share = 1e-13;
  const Eigen::Index m = std::min(matrix.rows(), matrix.cols());
  const Eigen::HouseholderQR<Eigen::MatrixXcd> tall(matrix);
  const Eigen::MatrixXcd square =
      tall.matrixQR().topRows(m).triangularView<Eigen::Upper>().toDenseMatrix();
  Eigen::ColPivHouseholderQR<Eigen::MatrixXcd> small(square);
  small.setThreshold(new_share);
  const Eigen::Index rank = small.rank();
  Orthonormal result;
  const Eigen::MatrixXcd turned = small.householderQ() * Eigen::MatrixXcd::Identity(m, rank);
  result.basis = Eigen::MatrixXcd::Zero(matrix.rows(), rank);
  result.basis.topRows(m) = turned;
  result.basis.applyOnTheLeft(tall.householderQ());
  const Eigen::MatrixXcd leading = small.matrixQR().topLeftCorner(rank, rank);
  const Eigen::MatrixXcd inverse = leading.triangularView<Eigen::Upper>().solve(
      Eigen::MatrixXcd::Identity(rank, rank).eval());
  result.mixture = Eigen::MatrixXcd::Zero(matrix.cols(), rank);
  result.mixture.topRows(rank) = inverse;
  result.mixture = (small.colsPermutation() * result.mixture).eval();
  return result;
}

/// Adds directions of another basis where this one has fewer, the most important first, so that
/// neither side is cut to the rank of the other: left vectors may need twice as many as right ones
/// where bodies act on each other in one direction only. The mixture is then that of the columns of
/// both.
void extend_by(Orthonormal& one, const Orthonormal& other) {
  const Eigen::Index missing = other.basis.cols() - one.basis.cols();
  if (missing <= 0) return;
  const Eigen::MatrixXcd shared = one.basis.adjoint() * other.basis;
  const Orthonormal more = orthonormal(other.basis - one.basis * shared);
  const Eigen::Index num = std::min(missing, more.basis.cols());
  const Eigen::MatrixXcd turned = more.mixture.leftCols(num);
  Orthonormal all;
  all.basis.resize(one.basis.rows(), one.basis.cols() + num);
  all.basis << one.basis, more.basis.leftCols(num);
  all.mixture = Eigen::MatrixXcd::Zero(one.mixture.rows() + other.mixture.rows(), all.basis.cols());
  all.mixture.topLeftCorner(one.mixture.rows(), one.mixture.cols()) = one.mixture;
  all.mixture.topRightCorner(one.mixture.rows(), num) = -one.mixture * (shared * turned);
  all.mixture.bottomRightCorner(other.mixture.rows(), num) = other.mixture * turned;
  one = std::move(all);
}

const SparseMatrix& matrix_of(const SparseSystem& system, int power) {
  return power == 2 ? system.mass : (power == 1 ? system.velocity : system.position);
}

/// Residual of a pair at full size.
double scaled_residual(const SparseSystem& system, Complex s, const Eigen::VectorXcd& x) {
  const Eigen::VectorXcd inertia = s * s * (system.mass * x);
  const Eigen::VectorXcd damping = s * (system.velocity * x);
  const Eigen::VectorXcd stiffness = system.position * x;
  return (inertia + damping + stiffness).norm() /
         (inertia.norm() + damping.norm() + stiffness.norm());
}

}  // namespace

void PairBasis::add(TwoSidedPairs pairs) {
  known_.push_back(std::move(pairs));
  groups_.clear();
}

void PairBasis::drop_latest() {
  known_.pop_back();
  groups_.clear();
}

/// Cuts the pairs into groups where a strip is free of eigenvalues of every system.
void PairBasis::make_groups(const SystemSpan* span) {
  constexpr std::size_t least_pairs = 8;
  constexpr double least_gap = 1e-3;  // of the height
  const std::size_t num_parts = span == nullptr ? 0 : span->num_parts();
  if (!groups_.empty() && grouped_parts_ == num_parts) return;
  groups_.clear();
  grouped_parts_ = num_parts;
  std::size_t fewest = std::numeric_limits<std::size_t>::max();
  for (const TwoSidedPairs& one : known_) fewest = std::min(fewest, one.s.size());
  Group group;
  group.low = -1e-3 * rectangle_.height;
  const auto close = [&](std::size_t last, double high) {
    group.last = last;
    group.high = high;
    Sides sides = reduce(group);
    if (span == nullptr) {
      group.sides = std::move(sides);
    } else if (group.mixture.cols() > 0) {
      multiply(group, sides, *span);
    }
    groups_.push_back(std::move(group));
    group = Group();
    group.first = last;
    group.low = high;
  };
  for (std::size_t i = least_pairs; i < fewest; ++i) {
    if (i - group.first < least_pairs) continue;
    double below = 0.0;
    double above = std::numeric_limits<double>::infinity();
    for (const TwoSidedPairs& one : known_) {
      below = std::max(below, one.s[i - 1].imag());
      above = std::min(above, one.s[i].imag());
    }
    if (above >= 0.99 * rectangle_.height) break;
    if (above - below > least_gap * rectangle_.height) close(i, 0.5 * (below + above));
  }
  group.is_top = true;
  close(std::numeric_limits<std::size_t>::max(), 1.1 * rectangle_.height);
}

/// Pairs of the group inside the rectangle, of the system that has fewest.
std::size_t PairBasis::fewest_within(const Group& group) const {
  std::size_t fewest = std::numeric_limits<std::size_t>::max();
  for (const TwoSidedPairs& one : known_) {
    std::size_t num = 0;
    for (std::size_t i = group.first; i < one.s.size(); ++i)
      if (rectangle_.contains(one.s[i])) ++num;
    fewest = std::min(fewest, num);
  }
  return fewest;
}

/// The states of all systems in a group, displacements above velocities over omega.
Eigen::MatrixXcd PairBasis::states(const Group& group, bool are_left) const {
  const Eigen::Index n = known_[0].right.rows();
  Eigen::Index columns = 0;
  for (const TwoSidedPairs& one : known_)
    columns += static_cast<Eigen::Index>(std::min(group.last, one.s.size()) - group.first);
  Eigen::MatrixXcd all(2 * n, columns);
  columns = 0;
  for (const TwoSidedPairs& one : known_) {
    for (std::size_t i = group.first; i < std::min(group.last, one.s.size()); ++i) {
      const auto x = (are_left ? one.left : one.right).col(static_cast<Eigen::Index>(i));
      const Complex s = are_left ? std::conj(one.s[i]) : one.s[i];
      all.col(columns).head(n) = x;
      all.col(columns++).tail(n) = s / group.omega * x;
    }
  }
  return all;
}

/// Bases of the states of both sides.
PairBasis::Sides PairBasis::reduce(Group& group) const {
  const Eigen::Index n = known_[0].right.rows();
  double sum = 0.0;
  int num = 0;
  for (const TwoSidedPairs& one : known_) {
    for (std::size_t i = group.first; i < std::min(group.last, one.s.size()); ++i, ++num)
      sum += std::abs(one.s[i]);
  }
  if (num == 0) return {};
  group.omega = std::max(sum / num, 1e-3 * rectangle_.height);
  Orthonormal right = orthonormal(states(group, false));
  Orthonormal left = orthonormal(states(group, true));
  extend_by(right, left);
  extend_by(left, right);
  const Eigen::Index m = std::min(right.basis.cols(), left.basis.cols());
  group.mixture = right.mixture.leftCols(m);
  return {right.basis.topLeftCorner(n, m), group.omega * right.basis.bottomLeftCorner(n, m),
          left.basis.topLeftCorner(n, m), group.omega * left.basis.bottomLeftCorner(n, m)};
}

/// Adds what one matrix of a system contributes. @param image its product with X
void PairBasis::Products::add(const Sides& sides, const SparseMatrix& matrix, int power,
                              const Eigen::MatrixXcd& image) {
  if (power == 2) {
    const Eigen::MatrixXcd momenta = matrix * sides.V;
    slope += sides.Z.adjoint() * image + sides.Y.adjoint() * momenta;
    rest -= sides.Z.adjoint() * momenta;
  } else {
    (power == 1 ? slope : rest) += sides.Y.adjoint() * image;
  }
}

/// Products of the bases of a group with all parts of a span.
void PairBasis::multiply(Group& group, const Sides& sides, const SystemSpan& span) const {
  const Eigen::Index m = group.mixture.cols();
  std::vector<Eigen::MatrixXcd> images;
  for (std::size_t k = 0; k < span.num_parts(); ++k) {
    Products products(m);
    for (const int power : {2, 1, 0}) {
      const SparseMatrix& matrix = matrix_of(span.part(k), power);
      if (matrix.nonZeros() == 0) continue;
      const Eigen::MatrixXcd image = matrix * sides.X;
      products.add(sides, matrix, power, image);
      group.terms.push_back({k, power});
      images.push_back(std::pow(group.omega, power) * image);
    }
    group.products.push_back(std::move(products));
  }
  const auto num_terms = static_cast<Eigen::Index>(images.size());
  group.gram.resize(m * num_terms, m * num_terms);
  for (Eigen::Index i = 0; i < num_terms; ++i) {
    for (Eigen::Index j = i; j < num_terms; ++j) {
      auto block = group.gram.block(i * m, j * m, m, m);
      block.noalias() = images[static_cast<std::size_t>(i)].adjoint() *
                        images[static_cast<std::size_t>(j)];
      if (j > i) group.gram.block(j * m, i * m, m, m) = block.adjoint();
    }
  }
}

PairBasis::Products PairBasis::products_of(const Group& group, const Projected& one) const {
  Products all(group.mixture.cols());
  if (one.span == nullptr) {
    for (const int power : {2, 1, 0}) {
      const SparseMatrix& matrix = matrix_of(one.system, power);
      if (matrix.nonZeros() > 0) all.add(group.sides, matrix, power, matrix * group.sides.X);
    }
    return all;
  }
  for (std::size_t k = 0; k < group.products.size(); ++k) {
    const double factor = (*one.factors)(static_cast<Eigen::Index>(k));
    all.slope += factor * group.products[k].slope;
    all.rest += factor * group.products[k].rest;
  }
  return all;
}

/// The small problem of a group: (A + σ B)⁻¹ B a = a/(σ − s).
PairBasis::Solution PairBasis::solve(const Group& group, const Products& products) const {
  Solution solution;
  const Eigen::Index m = group.mixture.cols();
  const Complex shift(0.01 * rectangle_.height, 0.5 * (std::max(group.low, 0.0) + group.high));
  const Eigen::MatrixXcd shifted = products.rest + shift * products.slope;
  const Eigen::MatrixXcd inverse = shifted.partialPivLu().solve(products.slope);
  if (!inverse.allFinite()) return solution;
  const ComplexEigenpairs ritz = complex_eigenpairs(inverse);
  std::vector<std::pair<Complex, Eigen::Index>> found;
  for (Eigen::Index i = 0; i < m; ++i) {
    Complex s = shift - 1.0 / ritz.values(i);
    constexpr double real_enough = 1e-9;
    if (std::abs(s.imag()) <= real_enough * std::abs(s)) s.imag(0.0);
    const bool is_within = s.imag() >= std::max(group.low, 0.0) && s.imag() < group.high &&
                           s.real() >= rectangle_.left() && s.real() <= rectangle_.right();
    if (is_within) found.emplace_back(s, i);
  }
  std::sort(found.begin(), found.end(), [](const auto& a, const auto& b) {
    return std::pair(a.first.imag(), a.first.real()) < std::pair(b.first.imag(), b.first.real());
  });
  solution.right.resize(m, static_cast<Eigen::Index>(found.size()));
  for (const auto& [s, i] : found) {
    solution.right.col(static_cast<Eigen::Index>(solution.s.size())) = ritz.vectors.col(i);
    solution.s.push_back(s);
  }
  return solution;
}

/// scaled_residual() of a pair from the Gram matrix: to 1e-8 or so.
double PairBasis::residual(const Group& group, const Eigen::VectorXd& factors, Complex s,
                           const Eigen::VectorXcd& a) const {
  const Eigen::Index m = a.size();
  Eigen::VectorXcd all(group.gram.rows());
  for (std::size_t t = 0; t < group.terms.size(); ++t) {
    const Term& term = group.terms[t];
    all.segment(static_cast<Eigen::Index>(t) * m, m) =
        factors(static_cast<Eigen::Index>(term.part)) * std::pow(s / group.omega, term.power) * a;
  }
  const auto length = [&](int power) {
    Eigen::VectorXcd some = all;
    for (std::size_t t = 0; t < group.terms.size(); ++t)
      if (power >= 0 && group.terms[t].power != power)
        some.segment(static_cast<Eigen::Index>(t) * m, m).setZero();
    return std::sqrt(std::max(0.0, some.dot(group.gram * some).real()));
  };
  return length(-1) / (length(2) + length(1) + length(0));
}

/// X a.
Eigen::VectorXcd PairBasis::vector_of(const Group& group, const Eigen::VectorXcd& a) const {
  const Eigen::VectorXcd shares = group.mixture * a;
  Eigen::VectorXcd x = Eigen::VectorXcd::Zero(known_[0].right.rows());
  Eigen::Index column = 0;
  for (const auto side : {&TwoSidedPairs::right, &TwoSidedPairs::left}) {
    if (column == shares.size()) break;  // the right vectors alone are a basis
    for (const TwoSidedPairs& one : known_) {
      const auto first = static_cast<Eigen::Index>(group.first);
      const Eigen::Index num =
          static_cast<Eigen::Index>(std::min(group.last, one.s.size())) - first;
      x.noalias() += (one.*side).middleCols(first, num) * shares.segment(column, num);
      column += num;
    }
  }
  return x.normalized();
}

/// Whether a pair of the small problem is one at full size.
bool PairBasis::is_pair(const Group& group, const Projected& one, Complex s,
                        const Eigen::VectorXcd& a, double& residual_of) const {
  const SparseSystem& system = one.system;
  if (one.span != nullptr) residual_of = residual(group, *one.factors, s, a);
  // The rounding of the Gram matrix may hide a smaller one.
  if (one.span == nullptr || (residual_of > certified_residual && residual_of < 1e-3))
    residual_of = scaled_residual(system, s, vector_of(group, a));
  if (residual_of <= certified_residual) return true;
  // In a rigid motion all terms of the residual are rounding.
  if (std::abs(s) >= 1e-6 * rectangle_.height) return false;
  const SparsePencil pencil(system);
  return pencil.backward_error(s, vector_of(group, a)) < 1e-13;
}

ProjectedSpectrum PairBasis::project(const SystemSpan& span, const Eigen::VectorXd& factors,
                                     const SparseSystem& system, std::optional<Complex> place) {
  return project(Projected{system, &span, &factors}, place);
}

ProjectedSpectrum PairBasis::project(const SparseSystem& system, std::optional<Complex> place) {
  return project(Projected{system}, place);
}

ProjectedSpectrum PairBasis::project(const Projected& one, std::optional<Complex> place) {
  constexpr double spurious = 0.05;  // residual of what is no approximation of a pair
  make_groups(one.span);
  ProjectedSpectrum spectrum;
  for (const Group& group : groups_) {
    const double margin = 0.2 * (group.high - group.low);
    if (place && (place->imag() < group.low - margin || place->imag() > group.high + margin))
      continue;
    Solution solution;
    if (group.mixture.cols() > 0) solution = solve(group, products_of(group, one));
    std::size_t num_found = 0;
    for (std::size_t i = 0; i < solution.s.size(); ++i) {
      const Complex s = solution.s[i];
      if (s.imag() > rectangle_.height) continue;
      double residual_of = 0.0;
      const auto a = solution.right.col(static_cast<Eigen::Index>(i));
      if (is_pair(group, one, s, a, residual_of)) {
        spectrum.eigenvalues.push_back(s);
        spectrum.largest_residual = std::max(spectrum.largest_residual, residual_of);
        ++num_found;
      } else if (group.is_top && residual_of < spurious) {
        spectrum.is_certified = false;  // of the other groups the number tells
      }
    }
    if (!group.is_top && num_found != group.last - group.first) spectrum.is_certified = false;
    // Where every system of the basis has more, the basis may show nothing of some: of a system in
    // other coordinates it shows none at all.
    if (group.is_top && num_found < fewest_within(group)) spectrum.is_certified = false;
  }
  return spectrum;
}

}  // namespace stridor
