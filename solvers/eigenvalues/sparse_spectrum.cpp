#include "solvers/eigenvalues/sparse_spectrum.hpp"

#include <fmt/format.h>

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <numeric>
#include <random>
#include <stdexcept>

#include "core/errors.hpp"
#include "solvers/eigenvalues/dense_eigenvalues.hpp"
#include "solvers/eigenvalues/eigenvalue_count.hpp"
#include "solvers/eigenvalues/linear_pencil.hpp"
#include "solvers/eigenvalues/mass_basis.hpp"
#include "solvers/eigenvalues/shift_invert.hpp"
#include "solvers/eigenvalues/symmetric_part.hpp"

namespace stridor {
namespace {

using Complex = std::complex<double>;

constexpr Eigen::Index most_modes = 1000;  ///< of the symmetric part in the first space
constexpr double largest_residual = 1e-6;  ///< of a pair
constexpr double refined_tolerance = 1e-9;  ///< of a pair that serves as a basis

/// The search of sparse_spectrum() and pairs_near().
class SparseSearch {
 public:
  SparseSearch(const SparseSystem& system, const SpectrumWindow& window, const SpectrumWork& work)
      : pencil_(system), window_(window), work_(work) {}

  SparseSpectrum run();
  TwoSidedPairs run(const TwoSidedPairs& guesses, double height);
  int factorisations() const { return factorisations_; }

 private:
  Eigen::Index size() const { return pencil_.size(); }
  void start();
  void project();
  void search(std::size_t most_at_once);
  void search_group(std::size_t first, std::size_t last, double low, double high);
  Eigen::Index most_coincident(std::size_t first, std::size_t last) const;
  Eigen::MatrixXcd start_of(std::size_t first, std::size_t last, const SparseFactor& factor);
  void keep_sides(const NearestPairs& found, Complex shift, const SparseFactor& factor, double low,
                  double high);
  TwoSidedPairs sorted_sides() const;
  void add_modes_below(double omega);
  double height_for_count() const;
  bool is_near(Complex s) const;
  SparseSpectrum found_up_to(double height) const;
  void count(SparseSpectrum& spectrum);

  SparsePencil pencil_;
  SpectrumWindow window_;
  const SpectrumWork& work_;
  double height_ = 0.0;          ///< up to where pairs are searched
  bool starts_at_pairs_ = false;  ///< whether pairs_ are good enough to begin with
  Modes modes_;
  MassBasis basis_{pencil_.system().mass};
  double represented_ =
      std::numeric_limits<double>::infinity();  ///< ω up to where basis_ has modes
  std::vector<SparsePair> pairs_;               ///< near the window
  std::vector<Complex> far_;                                      ///< approximations above
  std::vector<SparsePair> rights_, lefts_;                        ///< of both sides, as found
  std::mt19937 generator_{1};
  int factorisations_ = 0;
};

void SparseSearch::start() {
  const double wanted = 2.0 * std::numbers::pi * window_.frequency;
  Eigen::Index count = window_.count ? 2 * *window_.count + 20 : 40;
  while (true) {
    count = std::min(count, size());
    if (count > most_modes) {
      throw NumericalError(Refusal::eigenvalues_incomplete,
                           fmt::format("sparse eigenvalues: the window takes more than {} modes of "
                                       "the symmetric part; ask for "
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
  basis_.reserve(2 * count);
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
  basis_.clear();
  represented_ = omega;
  for (Eigen::Index i = 0; i < modes_.omega_squared.size(); ++i)
    if (modes_.omega_squared(i) <= omega * omega) basis_.add(modes_.shapes.col(i));
}

/// A height with as many pairs below as are wanted.
double SparseSearch::height_for_count() const {
  std::vector<double> heights;
  for (const SparsePair& pair : pairs_)
    if (pair.s.imag() > 0.0) heights.push_back(pair.s.imag());
  for (const Complex& s : far_)
    if (s.imag() > 0.0) heights.push_back(s.imag());
  std::sort(heights.begin(), heights.end());
  if (heights.empty())
    throw NumericalError(Refusal::eigenvalues_incomplete, "sparse eigenvalues: nothing vibrates");
  return height_above(heights, *window_.count);
}

/// Whether a pair lies in the window or so close to it that it may come in.
bool SparseSearch::is_near(Complex s) const {
  return s.imag() <= 1.1 * height_ && s.real() >= -0.6 * height_ && s.real() <= 1.4 * height_;
}

/// Galerkin's projection on the basis.
void SparseSearch::project() {
  pairs_.clear();
  far_.clear();
  // About where those are for which the basis has nothing.
  for (const double square : modes_.omega_squared)
    if (square > represented_ * represented_) far_.emplace_back(0.0, std::sqrt(square));
  const Eigen::Index dim = basis_.dim();
  if (dim == 0) return;
  const auto basis = basis_.vectors();
  const SparseSystem& system = pencil_.system();
  LinearSystem reduced;
  reduced.mass = Eigen::MatrixXd::Identity(dim, dim);
  reduced.velocity = basis.transpose() * (system.velocity * basis).eval();
  reduced.position = basis.transpose() * (system.position * basis).eval();
  reduced.gaps = reduced.forces = Eigen::MatrixXd(0, dim);
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

/// All pairs around those of the projection, by shift and invert for groups of neighbours.
/// @param most_at_once pairs of a group
void SparseSearch::search(std::size_t most_at_once) {
  rights_.clear();
  lefts_.clear();
  std::sort(pairs_.begin(), pairs_.end(),
            [](const SparsePair& a, const SparsePair& b) { return a.s.imag() < b.s.imag(); });
  const std::size_t num = pairs_.size();
  const std::size_t num_groups =
      std::max<std::size_t>(1, (num + most_at_once - 1) / most_at_once);
  double low = 0.0;
  for (std::size_t k = 0; k < num_groups; ++k) {
    const std::size_t first = k * num / num_groups;
    const std::size_t last = (k + 1) * num / num_groups;
    // Groups meet halfway between neighbours.
    const double high = last < num ? 0.5 * (pairs_[last - 1].s.imag() + pairs_[last].s.imag())
                                   : std::max(1.1 * height_, low);
    search_group(first, last, low, high);
    low = high;
  }
}

/// The largest number of neighbours among the pairs that no Krylov space of one vector tells apart.
Eigen::Index SparseSearch::most_coincident(std::size_t first, std::size_t last) const {
  const double same = 1e-6 * height_;
  Eigen::Index most = 1;
  for (std::size_t i = first; i < last; ++i) {
    Eigen::Index num = 0;
    for (std::size_t j = first; j < last; ++j)
      if (std::abs(pairs_[j].s - pairs_[i].s) <= same) ++num;
    most = std::max(most, num);
  }
  return most;
}

/// Starting vectors of a Krylov space: mixtures of the vectors at hand, as many as eigenvalues of
/// theirs coincide, or two random ones, so that it finds all that coincide. More would be of no
/// use: its degree counts, not its width.
Eigen::MatrixXcd SparseSearch::start_of(std::size_t first, std::size_t last,
                                        const SparseFactor& factor) {
  const Eigen::Index width = starts_at_pairs_ ? most_coincident(first, last) : 2;
  std::normal_distribution<double> normal;
  const auto random = [&] { return Complex(normal(generator_), normal(generator_)); };
  Eigen::MatrixXcd start(size(), width);
  for (Complex& entry : start.reshaped()) entry = random();
  start = factor.solve(pencil_.system().mass * start);
  if (!starts_at_pairs_ || first == last) return start;
  // A share of any other vectors, so that what comes anew is found too.
  constexpr double other = 1e-2;
  for (Eigen::Index j = 0; j < width; ++j) {
    Eigen::VectorXcd mixture = Eigen::VectorXcd::Zero(size());
    for (std::size_t i = first; i < last; ++i) mixture += random() * pairs_[i].x;
    start.col(j) = mixture + other * mixture.norm() * start.col(j).normalized();
  }
  return start;
}

/// @param first, last of pairs_: expected, with low <= Im s <= high
void SparseSearch::search_group(std::size_t first, std::size_t last, double low, double high) {
  const double begin = first == 0 ? -1e-3 * height_ : low;
  if (first < last) low = std::max(low, 0.9 * pairs_[first].s.imag());
  NearestPairsWanted wanted;
  wanted.shift = Complex(0.003 * height_, 0.5 * (low + high));
  wanted.radius = 0.5 * (high - low);
  for (std::size_t i = first; i < last; ++i)
    wanted.radius = std::max(wanted.radius, 1.01 * std::abs(pairs_[i].s - wanted.shift));
  wanted.expected = static_cast<Eigen::Index>(last - first);
  wanted.most_steps = 5 * wanted.expected + 60;
  if (starts_at_pairs_) wanted.tolerance = refined_tolerance;
  const SparseFactor factor = pencil_.factorise(wanted.shift);
  ++factorisations_;
  const NearestPairs found = nearest_pairs(pencil_, factor, wanted, start_of(first, last, factor));
  for (const SparsePair& pair : found.pairs) {
    if (pair.s.imag() < -1e-3 * height_ || !is_near(pair.s) || starts_at_pairs_) continue;
    // Turned so that most of it is real.
    const Complex square = (pair.x.transpose() * pair.x)(0);
    basis_.add_complex(pair.x * std::polar(1.0, -0.5 * std::arg(square)));
  }
  if (work_.sides == SpectrumWork::Sides::both || starts_at_pairs_)
    keep_sides(found, wanted.shift, factor, begin, high);
}

/// Vectors of the sides asked for of the pairs of a group, begin <= Im s < end, by a step of
/// inverse iteration.
void SparseSearch::keep_sides(const NearestPairs& found, Complex shift, const SparseFactor& factor,
                              double begin, double end) {
  for (const SparsePair& pair : found.pairs) {
    if (pair.s.imag() < begin || pair.s.imag() >= end || !is_near(pair.s)) continue;
    // Conjugates are counted with what is above the real axis. Pairs converge relative to their
    // distance from the shift.
    constexpr double of_size = 1e-9, of_distance = 1e-10;
    const double rounding = of_size * std::abs(pair.s) + of_distance * std::abs(pair.s - shift);
    if (pair.s.imag() < -rounding) continue;
    const Complex s = pair.s.imag() <= rounding ? Complex(pair.s.real(), 0.0) : pair.s;
    // The rough part of an error of 1e-9 has a residual that grows with the fineness of the mesh,
    // up to 1e-4; a step of inverse iteration removes it: P(σ) x = (σ − s) ((s + σ) M + P) x.
    Eigen::VectorXcd x = factor.solve(pencil_.slope(pair.s, shift, pair.x)).normalized();
    rights_.push_back({s, std::move(x)});
    if (work_.sides == SpectrumWork::Sides::right) continue;
    Eigen::VectorXcd y =
        factor.solve_adjoint(pencil_.slope_adjoint(pair.s, shift, pair.x)).normalized();
    lefts_.push_back({s, std::move(y)});
  }
}

TwoSidedPairs SparseSearch::sorted_sides() const {
  std::vector<std::size_t> order(rights_.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::stable_sort(order.begin(), order.end(), [&](std::size_t i, std::size_t j) {
    const Complex a = rights_[i].s, b = rights_[j].s;
    return std::pair(a.imag(), a.real()) < std::pair(b.imag(), b.real());
  });
  TwoSidedPairs pairs;
  const auto num = static_cast<Eigen::Index>(order.size());
  pairs.right.resize(size(), num);
  pairs.left.resize(size(), lefts_.empty() ? 0 : num);
  for (Eigen::Index j = 0; j < num; ++j) {
    const std::size_t i = order[static_cast<std::size_t>(j)];
    pairs.s.push_back(rights_[i].s);
    pairs.right.col(j) = rights_[i].x;
    if (!lefts_.empty()) pairs.left.col(j) = lefts_[i].x;
  }
  return pairs;
}

/// The pairs in a rectangle.
SparseSpectrum SparseSearch::found_up_to(double height) const {
  SparseSpectrum spectrum;
  spectrum.rectangle.height = height;
  const SparseMatrix& mass = pencil_.system().mass;
  spectrum.right.resize(size(), static_cast<Eigen::Index>(pairs_.size()));
  Eigen::Index num = 0;
  for (const SparsePair& pair : pairs_) {
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
  for (const SparsePair& pair : pairs_) known.push_back(pair.s);
  const auto logarithm = [&](Complex s) {
    ++factorisations_;
    const SparseFactor factor = pencil_.factorise(s);
    if (work_.on_count) work_.on_count(s, factor);
    return factor.log_determinant();
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
  SparseCholesky(with_little_mass(pencil_.system().mass), "the mass matrix");
  std::size_t most_at_once = 24;
  start();
  for (int attempt = 1;; ++attempt) {
    if (attempt == 1) {
      basis_.clear();
      represented_ = 1.1 * height_;
    } else {
      // Approximations of what has not been found, beside what has.
      add_modes_below(std::numeric_limits<double>::infinity());
      for (const SparsePair& pair : pairs_) basis_.add_complex(pair.x);
      project();
    }
    search(most_at_once);
    project();
    const double height = window_.count ? height_for_count() : height_;
    if (height > height_ && attempt < max_attempts) {
      // Some have come out higher than the first projection had them.
      height_ = 1.05 * height;
      project();
      continue;
    }
    SparseSpectrum spectrum = found_up_to(height);
    count(spectrum);
    if (spectrum.is_complete || attempt == max_attempts) {
      spectrum.pairs = sorted_sides();
      return spectrum;
    }
    most_at_once = std::max<std::size_t>(most_at_once / 2, 2);
  }
}

TwoSidedPairs SparseSearch::run(const TwoSidedPairs& guesses, double height) {
  // A factorisation of full matrices takes as long as the steps for some ten pairs more.
  const std::size_t most_at_once = is_full(pencil_.system().position) ? 48 : 24;
  height_ = height;
  starts_at_pairs_ = true;
  for (Eigen::Index j = 0; j < guesses.size(); ++j)
    pairs_.push_back({guesses.s[static_cast<std::size_t>(j)], guesses.right.col(j)});
  search(most_at_once);
  return sorted_sides();
}

}  // namespace

double height_above(const std::vector<double>& heights, int count) {
  for (auto i = static_cast<std::size_t>(count); i > 0 && i < heights.size(); ++i)
    if (heights[i] - heights[i - 1] > 1e-6 * heights[i]) return 0.5 * (heights[i] + heights[i - 1]);
  return 1.2 * heights.back();
}

SparseSpectrum sparse_spectrum(const SparseSystem& system, const SpectrumWindow& window,
                               const SpectrumWork& work) {
  const bool has_count = window.count && *window.count > 0;
  const bool has_frequency = window.frequency > 0.0 && std::isfinite(window.frequency);
  if (has_count == has_frequency)
    throw std::invalid_argument(
        "sparse eigenvalues: the window is neither a count nor a frequency");
  return SparseSearch(system, window, work).run();
}

TwoSidedPairs pairs_near(const SparseSystem& system, const TwoSidedPairs& guesses, double height,
                         int& factorisations, SpectrumWork::Sides sides) {
  const SpectrumWork work{sides, nullptr};
  SparseSearch search(system, {}, work);
  TwoSidedPairs pairs = search.run(guesses, height);
  factorisations += search.factorisations();
  return pairs;
}

}  // namespace stridor
