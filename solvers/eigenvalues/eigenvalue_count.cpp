#include "solvers/eigenvalues/eigenvalue_count.hpp"

#include <Eigen/Dense>
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>

namespace stridor {
namespace {

using Complex = std::complex<double>;

/// A phase between −π and π.
double wrapped(double phase) {
  return std::remainder(phase, 2.0 * std::numbers::pi);
}

/// A place on the path, and log f there without the known zeros; any branch.
struct Sample {
  Complex s;
  Complex value;
};

class PhaseCounter {
 public:
  PhaseCounter(const std::function<Complex(Complex)>& logarithm, const std::vector<Complex>& known,
               const std::array<Complex, 4>& corners)
      : logarithm_(logarithm),
        known_(known),
        centre_(0.5 * (corners.front() + corners.back()).real()),
        radius_(std::abs(corners[1] - centre_)),
        height_(corners[1].imag()) {
    constexpr double longest = 0.25;  // of the height
    for (std::size_t i = 0; i + 1 < corners.size(); ++i) {
      const Complex way = corners[i + 1] - corners[i];
      const int parts =
          std::max(4, static_cast<int>(std::ceil(std::abs(way) / (longest * height_))));
      for (int k = 0; k < parts; ++k) samples_.push_back(at(corners[i] + way * (1.0 * k / parts)));
    }
    samples_.push_back(at(corners.back()));
  }

  /// Change of phase along the path, known zeros left out; nothing where it cannot be followed.
  std::optional<double> change() {
    constexpr std::size_t most_samples = 20000;
    constexpr double largest_change = 0.5;  // of log h in a step
    const double smallest = 1e-9 * height_;
    while (samples_.size() < most_samples) {
      if (!std::all_of(samples_.begin(), samples_.end(),
                       [](const Sample& one) { return std::isfinite(one.value.real()); }))
        return std::nullopt;
      fit();
      std::vector<Sample> finer;
      double turned = 0.0;
      bool is_followed = true;
      for (std::size_t i = 0; i + 1 < samples_.size(); ++i) {
        const Sample& a = samples_[i];
        const Sample& b = samples_[i + 1];
        const Complex smooth = trend(b.s) - trend(a.s);
        Complex step = b.value - a.value - smooth;
        step.imag(wrapped(step.imag()));
        finer.push_back(a);
        turned += step.imag() + smooth.imag();
        if (std::max(std::abs(step.real()), std::abs(step.imag())) < largest_change &&
            !is_longer_than_neighbours(i))
          continue;
        if (std::abs(b.s - a.s) < smallest) return std::nullopt;
        finer.push_back(at(0.5 * (a.s + b.s)));
        is_followed = false;
      }
      if (is_followed) return turned;
      finer.push_back(samples_.back());
      samples_ = std::move(finer);
    }
    return std::nullopt;
  }

 private:
  Sample at(Complex s) const {
    Complex value = logarithm_(s);
    for (const Complex& zero : known_) {
      const Complex factor = zero.imag() > 0.0 ? (s - zero) * (s - std::conj(zero)) : s - zero;
      if (factor == 0.0) return {s, -std::numeric_limits<double>::infinity()};
      value -= std::log(factor);
    }
    return {s, value};
  }

  /// A zero at the middle of a step leaves no more than a turn at its ends, but makes the steps
  /// beside it short.
  bool is_longer_than_neighbours(std::size_t i) const {
    const auto length = [&](std::size_t k) { return std::abs(samples_[k + 1].s - samples_[k].s); };
    constexpr double largest_ratio = 2.01;
    return (i > 0 && length(i) > largest_ratio * length(i - 1)) ||
           (i + 2 < samples_.size() && length(i) > largest_ratio * length(i + 1));
  }

  /// g, without its constant, which changes nothing.
  Complex trend(Complex s) const {
    const Complex t = (s - centre_) / radius_;
    Complex sum = 0.0;
    for (Eigen::Index k = coefficients_.size(); k-- > 1;) sum = (sum + coefficients_(k)) * t;
    return sum;
  }

  /// The size of f alone determines g, without a doubt about turns; the phases, which are known to
  /// a turn then, make it better.
  void fit() {
    constexpr Eigen::Index highest_degree = 24;
    const auto num = static_cast<Eigen::Index>(samples_.size());
    const Eigen::Index first_degree = std::min(num / 2, highest_degree / 2);
    const Eigen::Index degree = std::min(num / 2, highest_degree);
    Eigen::MatrixXcd powers(num, degree + 1);
    Eigen::VectorXd sizes(num);
    for (Eigen::Index i = 0; i < num; ++i) {
      const Sample& sample = samples_[static_cast<std::size_t>(i)];
      const Complex t = (sample.s - centre_) / radius_;
      powers(i, 0) = 1.0;
      for (Eigen::Index k = 1; k <= degree; ++k) powers(i, k) = powers(i, k - 1) * t;
      sizes(i) = sample.value.real();
    }
    coefficients_ = powers.leftCols(first_degree + 1).real().colPivHouseholderQr().solve(sizes);

    Eigen::VectorXd phases(num);
    for (Eigen::Index i = 0; i < num; ++i) {
      const Sample& sample = samples_[static_cast<std::size_t>(i)];
      const double expected = trend(sample.s).imag();
      const double before =
          i == 0 ? 0.0 : phases(i - 1) - trend(samples_[static_cast<std::size_t>(i - 1)].s).imag();
      phases(i) = expected + before + wrapped(sample.value.imag() - expected - before);
    }
    phases.array() -= phases(0);  // on the real axis, where g is real
    Eigen::MatrixXd system(2 * num, degree + 1);
    system << powers.real(), powers.imag();
    Eigen::VectorXd values(2 * num);
    values << sizes, phases;
    coefficients_ = system.colPivHouseholderQr().solve(values);
  }

  const std::function<Complex(Complex)>& logarithm_;
  const std::vector<Complex>& known_;
  double centre_, radius_, height_;
  std::vector<Sample> samples_;   ///< along the path
  Eigen::VectorXd coefficients_;  ///< of g, by powers of (s − centre)/radius
};

}  // namespace

std::optional<int> count_in_rectangle(const std::function<Complex(Complex)>& logarithm, double left,
                                      double right, double height,
                                      const std::vector<Complex>& known) {
  const std::array<Complex, 4> corners{Complex(right, 0.0), Complex(right, height),
                                       Complex(left, height), Complex(left, 0.0)};
  const auto turned = PhaseCounter(logarithm, known, corners).change();
  if (!turned) return std::nullopt;
  // A phase that does not come back to where it began is that of no determinant.
  constexpr double rounding = 0.2;
  const double half_turns = *turned / std::numbers::pi;
  if (!(std::abs(half_turns - std::round(half_turns)) <= rounding)) return std::nullopt;
  int count = static_cast<int>(std::lround(half_turns));
  for (const Complex& zero : known) {
    const bool is_inside = zero.imag() <= height && zero.real() >= left && zero.real() <= right;
    if (is_inside) count += zero.imag() > 0.0 ? 2 : 1;
  }
  return count;
}

}  // namespace stridor
