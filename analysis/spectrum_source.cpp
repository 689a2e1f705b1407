#include "analysis/spectrum_source.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <optional>
#include <utility>

#include "core/blas.hpp"
#include "solvers/eigenvalues/dense_eigenvalues.hpp"
#include "solvers/eigenvalues/eigenvector.hpp"
#include "solvers/eigenvalues/secular_eigenvalues.hpp"

namespace stridor {
namespace {

using Complex = std::complex<double>;

constexpr double inf = std::numeric_limits<double>::infinity();

/// So many more than a count asks for, and in the dense method above a frequency: what comes down
/// from above is then known before it counts.
constexpr int num_above = 2;

Eigen::VectorXcd shape_of(const Pencil& pencil, Complex s) {
  const BlasGuard guard;
  return eigenvector(pencil, s).right;
}

class SecularSource : public SpectrumSource {
 public:
  SecularSource(const PencilFamily& family, double value, const LocusOptions& options)
      : family_(family), function_(first_function(value)), window_(options.window) {
    if (window_.count) *window_.count += num_above;
  }

  void move_to(double value) override {
    family_.place(value, pencil_);
    const auto guard = guard_of(pencil_);
    function_.assign(pencil_);
  }

  std::optional<std::vector<Complex>> search() override {
    SecularSpectrum spectrum = secular_spectrum(function_, window_);
    if (!spectrum.is_complete) return std::nullopt;
    searched_ = spectrum.height;
    if (spectrum.height == inf) drop_unwanted(spectrum);
    return std::move(spectrum.found);
  }

  bool is_searched(Complex s) const override { return SecularFunction::height_of(s) < searched_; }

  Followed follow(Complex guess, double spacing, int& hint) override {
    const SecularFunction::Zero zero = function_.find_zero(guess, spacing, hint);
    return {zero.s, zero.is_converged};
  }

  bool covers(const std::vector<Complex>& set, double needed) override {
    int below = 0;
    int total = 0;
    if (!find_line(set, needed)) {
      for (const Complex s : set) total += is_pair(s) ? 2 : 1;
      return total == function_.num_zeros();
    }
    for (const Complex s : set)
      below += SecularFunction::height_of(s) < line_ ? (is_pair(s) ? 2 : 1) : 0;
    return function_.count_zeros_below(line_) == below;
  }

  Eigen::VectorXcd shape(Complex s) override { return shape_of(pencil_, s); }
  double magnitude(Complex s) const override { return std::abs(s); }

 private:
  SecularFunction first_function(double value) {
    family_.place(value, pencil_);
    const auto guard = guard_of(pencil_);
    return SecularFunction(pencil_);
  }

  /// Where bodies have coupled terms, BLAS diagonalises them.
  static std::optional<BlasGuard> guard_of(const Pencil& pencil) {
    std::optional<BlasGuard> guard;
    if (pencil.num_body_ports > 0) guard.emplace();
    return guard;
  }

  /// Where no line was of use, the search had to find all eigenvalues. Those far above the window
  /// would only be in the way: where two of them meet, every step would have to be small.
  void drop_unwanted(SecularSpectrum& spectrum) {
    double needed = 2.0 * std::numbers::pi * window_.frequency;
    int num_pairs = 0;
    for (const Eigenvalue& eigenvalue : spectrum.eigenvalues) {
      if (is_pair(eigenvalue.s) && ++num_pairs == window_.count) needed = eigenvalue.s.imag();
    }
    if (!find_line(spectrum.found, needed)) return;
    searched_ = line_;
    std::erase_if(spectrum.found, [&](Complex s) { return !is_searched(s); });
  }

  double clearance(const std::vector<Complex>& set, double line) const {
    double least = inf;
    for (const Complex s : set)
      least = std::min(least, std::abs(SecularFunction::height_of(s) - line));
    return least;
  }

  /// Sets line_ above a height, between two poles and clear of the set; false above all poles.
  bool find_line(const std::vector<Complex>& set, double needed) {
    constexpr double least_clearance = 0.1;  // of the interval between the poles
    const std::vector<double>& heights = function_.pole_heights();
    // The samples of a line are kept, so the last one is much cheaper than another.
    if (line_ > needed && line_ < heights.back() && line_ < highest_line(needed) &&
        clearance(set, line_) >= least_clearance * line_gap_) {
      return true;
    }
    constexpr double narrowest = 1e-3;  // of the height
    auto upper = std::upper_bound(heights.begin(), heights.end(), needed);
    for (; upper != heights.end(); ++upper) {
      const double lower = upper == heights.begin() ? 0.0 : *(upper - 1);
      line_gap_ = *upper - lower;
      if (line_gap_ <= narrowest * *upper) continue;
      for (const double fraction : {0.5, 0.65, 0.35, 0.8, 0.2}) {
        line_ = lower + fraction * line_gap_;
        if (line_ > needed && clearance(set, line_) >= least_clearance * line_gap_) return true;
      }
    }
    line_ = -1.0;
    return false;
  }

  /// A line farther up than this counts eigenvalues that nobody wants.
  double highest_line(double needed) const {
    const std::vector<double>& heights = function_.pole_heights();
    const auto upper = std::upper_bound(heights.begin(), heights.end(), needed);
    const auto ahead = std::min<std::ptrdiff_t>(3, heights.end() - upper);
    return ahead == 0 ? inf : *(upper + ahead - 1);
  }

  const PencilFamily& family_;
  Pencil pencil_;
  SecularFunction function_;
  SpectrumWindow window_;
  double searched_ = 0.0;  ///< height below which the last search found all
  double line_ = -1.0;
  double line_gap_ = 0.0;
};

class DenseSource : public SpectrumSource {
 public:
  DenseSource(const PencilFamily& family, const LocusOptions& options)
      : family_(family), window_(options.window) {}

  void move_to(double value) override {
    if (value == value_) return;
    family_.place(value, pencil_);
    known_.clear();
    const BlasGuard guard;
    for (const Eigenvalue& eigenvalue : dense_eigenvalues(pencil_, DenseWork::eigenvalues)) {
      known_.push_back(eigenvalue.s);
    }
    value_ = value;
  }

  std::optional<std::vector<Complex>> search() override {
    std::vector<Complex> lowest;
    int num_pairs = 0;
    int num_unwanted = 0;
    for (const Complex s : known_) {
      if (is_pair(s)) ++num_pairs;
      if (window_.ends_before(s.imag(), num_pairs) && ++num_unwanted > num_above) break;
      lowest.push_back(s);
    }
    searched_ = lowest.empty() ? 0.0 : lowest.back().imag();
    return lowest;
  }

  bool is_searched(Complex s) const override { return s.imag() <= searched_; }

  Followed follow(Complex guess, double, int&) override {
    const auto nearest = std::min_element(known_.begin(), known_.end(), [&](Complex a, Complex b) {
      return std::abs(a - guess) < std::abs(b - guess);
    });
    return {*nearest, true};
  }

  bool covers(const std::vector<Complex>& set, double needed) override {
    return std::all_of(known_.begin(), known_.end(), [&](Complex s) {
      return s.imag() > needed || std::find(set.begin(), set.end(), s) != set.end();
    });
  }

  Eigen::VectorXcd shape(Complex s) override { return shape_of(pencil_, s); }
  double magnitude(Complex s) const override {
    return std::max(std::abs(s), pencil_.omega.maxCoeff());
  }

 private:
  const PencilFamily& family_;
  Pencil pencil_;
  SpectrumWindow window_;
  double value_ = std::numeric_limits<double>::quiet_NaN();
  double searched_ = 0.0;       ///< Im s up to which the last search found all
  std::vector<Complex> known_;  ///< ascending imaginary part
};

}  // namespace

std::unique_ptr<SpectrumSource> make_spectrum_source(const PencilFamily& family, double value,
                                                     const LocusOptions& options) {
  if (options.method == LocusMethod::dense) return std::make_unique<DenseSource>(family, options);
  return std::make_unique<SecularSource>(family, value, options);
}

}  // namespace stridor
