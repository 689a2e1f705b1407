#include "solvers/eigenvalues/sparse_spectrum.hpp"

#include <fmt/format.h>

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <numbers>
#include <random>
#include <stdexcept>

#include "core/errors.hpp"
#include "solvers/eigenvalues/dense_eigenvalues.hpp"
#include "solvers/eigenvalues/eigenvalue_count.hpp"
#include "solvers/eigenvalues/linear_pencil.hpp"
#include "solvers/eigenvalues/shift_invert.hpp"
#include "substructures/reduction/lowest_modes.hpp"

namespace stridor {
namespace {

using Complex = std::complex<double>;

constexpr Eigen::Index most_modes = 1000;  ///< of the symmetric part in the first space
constexpr double tolerance = 1e-9;         ///< of directions
constexpr double largest_residual = 1e-6;  ///< of a pair

/// The lowest modes of the symmetric part of Q with M. It need not be definite: it is shifted until
/// it is.
Modes symmetric_modes(const SparseSystem& system, Eigen::Index count) {
  const SparseMatrix transposed = system.position.transpose();
  const SparseMatrix stiffness = 0.5 * (system.position + transposed);
  const double scale =
      stiffness.diagonal().cwiseAbs().maxCoeff() / system.mass.diagonal().cwiseAbs().maxCoeff();
  if (!(scale > 0.0)) throw NumericalError("sparse eigenvalues: there is no stiffness");
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

using Pair = SparsePair;

/// M with a trace of mass everywhere: positive definite unless M is indefinite. A body without mass
/// at some DoFs is none the worse.
SparseMatrix with_little_mass(const SparseMatrix& mass) {
  constexpr double little = 1e-9;
  const double mean = mass.diagonal().cwiseAbs().mean();
  SparseMatrix more = mass;
  for (Eigen::Index i = 0; i < mass.rows(); ++i)
    more.coeffRef(i, i) += little * std::max(std::abs(mass.coeff(i, i)), 1e-6 * mean);
  more.makeCompressed();
  return more;
}

/// Priority of an eigenvalue.
using Rank = std::function<double(Complex)>;

class SparseSearch {
 public:
  SparseSearch(const SparseSystem& system, const SpectrumWindow& window)
      : pencil_(system), window_(window) {
    SparseCholesky(with_little_mass(system.mass), "the mass matrix");
  }

  SparseSpectrum run();
  /// @param rank  of an eigenvalue: its priority
  /// @param count of the pairs that are wanted most
  SparseSpectrum run(const SpectrumBasis& basis, const Rank& rank, int count);

 private:
  Eigen::Index size() const { return pencil_.size(); }
  void start();
  void add(const Eigen::VectorXd& vector);
  double add_complex(const Eigen::VectorXcd& vector);
  void improve(Pair& pair, const Eigen::VectorXcd& vector) const;
  void project();
  void refine();
  void search(std::size_t most_at_once);
  void search_group(const std::vector<Complex>& group, double low, double high);
  void add_modes_below(double omega);
  double height_for_count() const;
  bool is_near(Complex s) const;
  SparseSpectrum found_up_to(double height) const;
  void count(SparseSpectrum& spectrum);

  SparsePencil pencil_;
  SpectrumWindow window_;
  double height_ = 0.0;  ///< up to where pairs are refined
  Rank rank_;            ///< of pairs that are refined one by one
  double least_rank_ = -std::numeric_limits<double>::infinity();  ///< of pairs that are refined
  Modes modes_;
  Eigen::MatrixXd basis_;    ///< V with Vᵀ M V = 1
  Eigen::MatrixXd momenta_;  ///< M V
  Eigen::Index dim_ = 0;
  double represented_ = std::numeric_limits<double>::infinity();  ///< ω up to which V has modes
  std::vector<Pair> pairs_;                                       ///< near the window
  std::vector<Complex> far_;                                      ///< approximations above
  std::mt19937 generator_{1};
  int factorisations_ = 0;
};

void SparseSearch::start() {
  const double wanted = 2.0 * std::numbers::pi * window_.frequency;
  Eigen::Index count = window_.count ? 2 * *window_.count + 20 : 40;
  while (true) {
    count = std::min(count, size());
    if (count > most_modes) {
      throw NumericalError(fmt::format(
          "sparse eigenvalues: the window takes more than {} modes of the symmetric part; ask for "
          "fewer eigenvalues or a lower frequency",
          most_modes));
    }
    modes_ = symmetric_modes(pencil_.system(), count);
    const double highest = std::sqrt(std::max(0.0, modes_.omega_squared(count - 1)));
    if (count == size() || window_.count || highest >= 1.5 * wanted) break;
    // Modes are about evenly spaced, or come closer.
    const double ratio = std::clamp(1.5 * wanted / std::max(highest, 0.1 * wanted), 1.1, 4.0);
    count = static_cast<Eigen::Index>(std::pow(ratio, 1.3) * static_cast<double>(count)) + 10;
  }
  basis_.resize(size(), 2 * count);
  momenta_.resize(size(), 2 * count);
  height_ = wanted;
  add_modes_below(window_.count ? std::numeric_limits<double>::infinity() : 1.2 * wanted);
  project();
  if (window_.count) {
    height_ = 1.05 * height_for_count();
    project();
  }
}

/// Begins the basis with the modes of the symmetric part up to a frequency, rad/s.
void SparseSearch::add_modes_below(double omega) {
  dim_ = 0;
  represented_ = omega;
  for (Eigen::Index i = 0; i < modes_.omega_squared.size(); ++i)
    if (modes_.omega_squared(i) <= omega * omega) add(modes_.shapes.col(i));
}

/// A height with as many pairs below as are wanted, in the middle of a gap; that of the highest
/// pair where there are too few.
double SparseSearch::height_for_count() const {
  std::vector<double> heights;
  for (const Pair& pair : pairs_)
    if (pair.s.imag() > 0.0) heights.push_back(pair.s.imag());
  for (const Complex& s : far_)
    if (s.imag() > 0.0) heights.push_back(s.imag());
  std::sort(heights.begin(), heights.end());
  if (heights.empty()) throw NumericalError("sparse eigenvalues: nothing vibrates");
  const auto count = static_cast<std::size_t>(*window_.count);
  for (std::size_t i = count; i > 0 && i < heights.size(); ++i)
    if (heights[i] - heights[i - 1] > 1e-6 * heights[i]) return 0.5 * (heights[i] + heights[i - 1]);
  return 1.2 * heights.back();
}

/// Whether a pair lies in the window or so close to it that it may come in.
bool SparseSearch::is_near(Complex s) const {
  return s.imag() <= 1.1 * height_ && s.real() >= -0.6 * height_ && s.real() <= 1.4 * height_;
}

/// Adds the new component of a vector to the basis.
void SparseSearch::add(const Eigen::VectorXd& vector) {
  constexpr double negligible = 1e-11;
  const SparseMatrix& mass = pencil_.system().mass;
  Eigen::VectorXd rest = vector;
  const double length = std::sqrt(std::max(0.0, rest.dot(mass * rest)));
  if (!(length > 0.0)) return;
  for (int round = 0; round < 2; ++round)
    rest -= basis_.leftCols(dim_) * (momenta_.leftCols(dim_).transpose() * rest);
  Eigen::VectorXd momentum = mass * rest;
  double rest_length = std::sqrt(std::max(0.0, rest.dot(momentum)));
  if (rest_length <= negligible * length || dim_ == size()) return;
  rest /= rest_length;
  // A stretched vector is no longer orthogonal.
  rest -= basis_.leftCols(dim_) * (momenta_.leftCols(dim_).transpose() * rest);
  momentum = mass * rest;
  rest_length = std::sqrt(rest.dot(momentum));
  if (dim_ == basis_.cols()) {
    basis_.conservativeResize(size(), std::max<Eigen::Index>(64, 2 * dim_));
    momenta_.conservativeResize(size(), basis_.cols());
  }
  basis_.col(dim_) = rest / rest_length;
  momenta_.col(dim_) = momentum / rest_length;
  ++dim_;
}

/// The same of a complex vector. @return the share of it that is new
double SparseSearch::add_complex(const Eigen::VectorXcd& vector) {
  const SparseMatrix& mass = pencil_.system().mass;
  const auto length_of = [&](const Eigen::VectorXcd& x) {
    return std::sqrt(std::max(0.0, x.dot(mass * x).real()));
  };
  const Eigen::VectorXcd unit = vector / length_of(vector);
  Eigen::VectorXcd rest = unit;
  for (int round = 0; round < 2; ++round)
    rest -= basis_.leftCols(dim_) * (momenta_.leftCols(dim_).transpose() * rest);
  const double share = length_of(rest);
  // Less is mostly rounding, and gives the projections eigenvalues that were not asked for.
  if (share > tolerance) {
    add(unit.real());
    add(unit.imag());
  }
  return share;
}

/// Galerkin's projection on the basis.
void SparseSearch::project() {
  pairs_.clear();
  far_.clear();
  // About where those are for which the basis has nothing.
  for (const double square : modes_.omega_squared)
    if (square > represented_ * represented_) far_.emplace_back(0.0, std::sqrt(square));
  if (dim_ == 0) return;
  const auto basis = basis_.leftCols(dim_);
  const SparseSystem& system = pencil_.system();
  LinearSystem reduced;
  reduced.mass = Eigen::MatrixXd::Identity(dim_, dim_);
  reduced.velocity = basis.transpose() * (system.velocity * basis).eval();
  reduced.position = basis.transpose() * (system.position * basis).eval();
  reduced.gaps = reduced.forces = Eigen::MatrixXd(0, dim_);
  const Pencil pencil = make_pencil(reduced);
  const DenseSpectrum spectrum = dense_spectrum(pencil);
  for (std::size_t i = 0; i < spectrum.eigenvalues.size(); ++i) {
    const Complex s = spectrum.eigenvalues[i].s;
    if (!is_near(s)) {
      far_.push_back(s);
      continue;
    }
    const Eigen::VectorXcd q = pencil.ports * spectrum.right.col(static_cast<Eigen::Index>(i));
    pairs_.push_back({s, basis * (q / q.norm())});
  }
}

/// The last step of inverse iteration, which no projection follows: s by Newton's method on
/// xᴴ P(s) x = 0.
void SparseSearch::improve(Pair& pair, const Eigen::VectorXcd& vector) const {
  pair.x = vector.normalized();
  for (int step = 0; step < 3; ++step) {
    const Complex slope = pair.x.dot(pencil_.slope(pair.s, pair.s, pair.x));
    if (slope == 0.0) return;
    pair.s -= pair.x.dot(pencil_.multiply(pair.s, pair.x)) / slope;
  }
}

/// Rounds of inverse iteration until no pair adds anything to the basis.
void SparseSearch::refine() {
  constexpr int max_rounds = 12;
  for (int round = 0; round < max_rounds; ++round) {
    const double width = std::max(0.04 * std::pow(0.5, round), 1e-3) * height_;
    bool have_converged = true;
    std::vector<Pair> improved = pairs_;
    for (std::size_t first = 0; first < pairs_.size();) {
      if (rank_(pairs_[first].s) < least_rank_) {
        ++first;
        continue;
      }
      std::size_t last = first;
      while (last < pairs_.size() && std::abs(pairs_[last].s - pairs_[first].s) <= width) ++last;
      // Beside the group, so that no member of it drowns the others.
      const Complex shift = 0.5 * (pairs_[first].s + pairs_[last - 1].s) + 0.5 * width;
      const SparseFactor factor = pencil_.factorise(shift);
      ++factorisations_;
      for (; first < last; ++first) {
        const Pair& pair = pairs_[first];
        const Eigen::VectorXcd vector = factor.solve(pencil_.slope(pair.s, shift, pair.x));
        have_converged &= add_complex(vector) <= tolerance;
        improve(improved[first], vector);
      }
    }
    if (have_converged) {
      pairs_ = std::move(improved);
      return;
    }
    project();
  }
}

/// All pairs around those of the projection, by shift and invert for groups of neighbours.
/// @param most_at_once pairs of a group
void SparseSearch::search(std::size_t most_at_once) {
  std::vector<Complex> expected;
  for (const Pair& pair : pairs_) expected.push_back(pair.s);
  std::sort(expected.begin(), expected.end(),
            [](Complex a, Complex b) { return a.imag() < b.imag(); });
  const std::size_t num_groups =
      std::max<std::size_t>(1, (expected.size() + most_at_once - 1) / most_at_once);
  double low = 0.0;
  for (std::size_t k = 0; k < num_groups; ++k) {
    const std::size_t first = k * expected.size() / num_groups;
    const std::size_t last = (k + 1) * expected.size() / num_groups;
    // Groups meet halfway between neighbours.
    const double high = last < expected.size()
                            ? 0.5 * (expected[last - 1].imag() + expected[last].imag())
                            : std::max(1.1 * height_, low);
    const auto begin = expected.begin();
    const std::vector<Complex> group(begin + static_cast<std::ptrdiff_t>(first),
                                     begin + static_cast<std::ptrdiff_t>(last));
    search_group(group, low, high);
    low = high;
  }
  project();
}

/// @param group expected eigenvalues, ascending Im s, with low <= Im s <= high
void SparseSearch::search_group(const std::vector<Complex>& group, double low, double high) {
  constexpr Eigen::Index start_width = 2;
  if (!group.empty()) low = std::max(low, 0.9 * group.front().imag());
  NearestPairsWanted wanted;
  wanted.shift = Complex(0.003 * height_, 0.5 * (low + high));
  wanted.radius = 0.5 * (high - low);
  for (const Complex& s : group)
    wanted.radius = std::max(wanted.radius, 1.01 * std::abs(s - wanted.shift));
  wanted.expected = static_cast<Eigen::Index>(group.size());
  wanted.most_steps = 5 * wanted.expected + 60;
  const SparseFactor factor = pencil_.factorise(wanted.shift);
  ++factorisations_;
  std::normal_distribution<double> normal;
  Eigen::MatrixXcd start(size(), start_width);
  for (Complex& entry : start.reshaped()) entry = {normal(generator_), normal(generator_)};
  start = factor.solve(pencil_.system().mass * start);
  const NearestPairs found = nearest_pairs(pencil_, factor, wanted, start);
  for (const Pair& pair : found.pairs) {
    if (pair.s.imag() < -1e-3 * height_ || !is_near(pair.s)) continue;
    // Turned so that most of it is real.
    const Complex square = (pair.x.transpose() * pair.x)(0);
    add_complex(pair.x * std::polar(1.0, -0.5 * std::arg(square)));
  }
}

/// The pairs in a rectangle.
SparseSpectrum SparseSearch::found_up_to(double height) const {
  SparseSpectrum spectrum;
  spectrum.rectangle.height = height;
  const SparseMatrix& mass = pencil_.system().mass;
  spectrum.right.resize(size(), static_cast<Eigen::Index>(pairs_.size()));
  Eigen::Index num = 0;
  for (const Pair& pair : pairs_) {
    const double residual = pencil_.scaled_residual(pair.s, pair.x);
    // A projection may have eigenvalues near which the problem has none. In a rigid motion all
    // terms of the residual are rounding.
    const bool is_rigid =
        std::abs(pair.s) < 1e-6 * height && pencil_.backward_error(pair.s, pair.x) < 1e-13;
    if (!spectrum.rectangle.contains(pair.s) || (residual > largest_residual && !is_rigid))
      continue;
    const double length = std::sqrt(pair.x.dot(mass * pair.x).real());
    spectrum.right.col(num++) = pair.x / length;
    spectrum.eigenvalues.push_back({pair.s, residual});
    spectrum.backward_errors.push_back(pencil_.backward_error(pair.s, pair.x));
    spectrum.num_found += pair.s.imag() > 0.0 ? 2 : 1;
  }
  spectrum.right.conservativeResize(size(), num);
  spectrum.omega = modes_.omega_squared.cwiseMax(0.0).cwiseSqrt();
  spectrum.modes = modes_.shapes;
  return spectrum;
}

/// Compares with the argument principle.
void SparseSearch::count(SparseSpectrum& spectrum) {
  std::vector<Complex> known = far_;
  for (const Pair& pair : pairs_) known.push_back(pair.s);
  const auto logarithm = [&](Complex s) {
    ++factorisations_;
    return pencil_.factorise(s).log_determinant();
  };
  const auto counted =
      count_in_rectangle(logarithm, spectrum.rectangle.left(), spectrum.rectangle.right(),
                         spectrum.rectangle.height, known);
  spectrum.num_counted = counted.value_or(0);
  spectrum.is_complete = counted && *counted == spectrum.num_found;
  spectrum.factorisations = factorisations_;
}

SparseSpectrum SparseSearch::run() {
  constexpr int max_attempts = 4;
  std::size_t most_at_once = 24;
  start();
  for (int attempt = 1;; ++attempt) {
    if (attempt == 1) {
      dim_ = 0;
      represented_ = 1.1 * height_;
    } else {
      // Approximations of what has not been found, beside what has.
      add_modes_below(std::numeric_limits<double>::infinity());
      for (const Pair& pair : pairs_) add_complex(pair.x);
      project();
    }
    search(most_at_once);
    const double height = window_.count ? height_for_count() : height_;
    if (height > height_ && attempt < max_attempts) {
      // Some have come out higher than the first projection had them.
      height_ = 1.05 * height;
      project();
      continue;
    }
    SparseSpectrum spectrum = found_up_to(height);
    count(spectrum);
    if (spectrum.is_complete || attempt == max_attempts) return spectrum;
    most_at_once = std::max<std::size_t>(most_at_once / 2, 2);
  }
}

SparseSpectrum SparseSearch::run(const SpectrumBasis& basis, const Rank& rank, int count) {
  constexpr int max_attempts = 4;
  rank_ = rank;
  height_ = basis.height;
  const SparseMatrix& mass = pencil_.system().mass;
  dim_ = basis.vectors.cols();
  const Eigen::MatrixXd momenta = mass * basis.vectors;
  const Eigen::LLT<Eigen::MatrixXd> product(basis.vectors.transpose() * momenta);
  basis_ = product.matrixL().solve(basis.vectors.transpose()).transpose();
  momenta_ = mass * basis_;
  project();
  for (int attempt = 1; attempt <= max_attempts; ++attempt) {
    std::vector<double> ranks;
    for (const Pair& pair : pairs_) ranks.push_back(rank_(pair.s));
    if (ranks.empty()) break;
    std::sort(ranks.begin(), ranks.end(), std::greater<>());
    const auto last = std::min(ranks.size(), static_cast<std::size_t>(count)) - 1;
    // Refined they may be others.
    if (least_rank_ <= ranks[last] && attempt > 1) break;
    least_rank_ = ranks[last] - 1e-3 * std::abs(ranks[last]);
    refine();
  }
  SparseSpectrum spectrum = found_up_to(height_);
  spectrum.factorisations = factorisations_;
  return spectrum;
}

}  // namespace

SpectrumBasis spectrum_basis(const std::vector<const SparseSpectrum*>& spectra) {
  constexpr double new_share = 1e-7;  // of a direction
  Eigen::Index columns = 0;
  for (const SparseSpectrum* one : spectra) columns += 2 * one->right.cols();
  SpectrumBasis basis;
  basis.height = std::numeric_limits<double>::infinity();
  Eigen::MatrixXd vectors(spectra.front()->right.rows(), columns);
  columns = 0;
  for (const SparseSpectrum* one : spectra) {
    basis.height = std::min(basis.height, one->rectangle.height);
    for (const auto& x : one->right.colwise()) {
      vectors.col(columns++) = x.real() / x.norm();
      vectors.col(columns++) = x.imag() / x.norm();
    }
  }
  Eigen::ColPivHouseholderQR<Eigen::MatrixXd> qr(vectors);
  qr.setThreshold(new_share);
  basis.vectors = qr.householderQ() * Eigen::MatrixXd::Identity(vectors.rows(), qr.rank());
  return basis;
}

std::vector<std::complex<double>> projected_eigenvalues(const SparseSystem& system,
                                                        const SpectrumBasis& basis) {
  const Eigen::MatrixXd& V = basis.vectors;
  LinearSystem reduced;
  reduced.mass = V.transpose() * (system.mass * V).eval();
  reduced.velocity = V.transpose() * (system.velocity * V).eval();
  reduced.position = V.transpose() * (system.position * V).eval();
  reduced.gaps = reduced.forces = Eigen::MatrixXd(0, V.cols());
  const SpectrumRectangle rectangle{basis.height};
  std::vector<Complex> found;
  for (const Eigenvalue& one : dense_eigenvalues(make_pencil(reduced)))
    if (rectangle.contains(one.s)) found.push_back(one.s);
  return found;
}

SparseSpectrum fastest_near(const SparseSystem& system, const SpectrumBasis& basis, int count) {
  if (count < 1) throw std::invalid_argument(fmt::format("sparse eigenvalues: {} are none", count));
  return SparseSearch(system, {})
      .run(
          basis, [](Complex s) { return s.real(); }, count);
}

SparseSpectrum closest_near(const SparseSystem& system, const SpectrumBasis& basis, Complex place,
                            int count) {
  if (count < 1) throw std::invalid_argument(fmt::format("sparse eigenvalues: {} are none", count));
  return SparseSearch(system, {})
      .run(
          basis, [place](Complex s) { return -std::abs(s - place); }, count);
}

SparseSpectrum sparse_spectrum(const SparseSystem& system, const SpectrumWindow& window) {
  const bool has_count = window.count && *window.count > 0;
  const bool has_frequency = window.frequency > 0.0 && std::isfinite(window.frequency);
  if (has_count == has_frequency)
    throw std::invalid_argument(
        "sparse eigenvalues: the window is neither a count nor a frequency");
  return SparseSearch(system, window).run();
}

}  // namespace stridor
