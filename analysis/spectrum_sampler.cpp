#include "analysis/spectrum_sampler.hpp"

#include <algorithm>
#include <functional>
#include <limits>
#include <map>
#include <numbers>
#include <tuple>

#include "solvers/eigenvalues/dense_eigenvalues.hpp"

namespace stridor {
namespace {

using Complex = std::complex<double>;

constexpr double infinite = std::numeric_limits<double>::infinity();

/// All eigenvalues of the dense problem, and their possible rounding errors.
class DenseSpectra {
 public:
  explicit DenseSpectra(const PencilFamily& family) : family_(&family) {}

  /// Windows that overlap ask for the same values.
  SampledSpectrum operator()(double value) {
    const auto known = known_.find(value);
    return known != known_.end() ? known->second : known_[value] = compute(value);
  }

 private:
  static constexpr double largest_rounding = 1e-6;  ///< of |s|

  SampledSpectrum compute(double value) {
    family_->place(value, pencil_);
    const DenseSpectrum all = dense_spectrum(pencil_, DenseWork::near_axis);
    SampledSpectrum spectrum;
    for (std::size_t i = 0; i < all.eigenvalues.size(); ++i) {
      spectrum.eigenvalues.push_back(all.eigenvalues[i].s);
      spectrum.rounding.push_back(rounding_of(all, i));
    }
    return spectrum;
  }

  /// Possible rounding error of the real part.
  static double rounding_of(const DenseSpectrum& all, std::size_t i) {
    if (!is_near_axis(all.eigenvalues[i].s)) return 0.0;
    const double rounding = 20.0 * std::numeric_limits<double>::epsilon() * all.norm;
    // In this order NaN, of an eigenvalue without condition, gives the largest.
    return std::min(largest_rounding * std::abs(all.eigenvalues[i].s),
                    rounding * all.conditions[i]);
  }

  const PencilFamily* family_;
  Pencil pencil_;
  std::map<double, SampledSpectrum> known_;
};

}  // namespace

SpectrumFamily dense_spectra(const PencilFamily& family) {
  return {DenseSpectra(family), nullptr, nullptr};
}

std::size_t Sample::num_growing() const {
  return static_cast<std::size_t>(
      std::count_if(excess.begin(), excess.end(), [](double one) { return one > 0.0; }));
}

std::vector<Complex> Sample::growing() const {
  std::vector<Complex> list;
  for (std::size_t i = 0; i < eigenvalues.size(); ++i)
    if (is_growing(i)) list.push_back(eigenvalues[i]);
  return list;
}

double Sample::ranked_excess(std::size_t rank) const {
  if (rank > excess.size()) return -infinite;
  std::vector<double> sorted = excess;
  const auto place = sorted.begin() + static_cast<std::ptrdiff_t>(rank) - 1;
  std::nth_element(sorted.begin(), place, sorted.end(), std::greater<>());
  return *place;
}

Complex Sample::fastest() const {
  const auto top = std::max_element(excess.begin(), excess.end());
  return eigenvalues[static_cast<std::size_t>(top - excess.begin())];
}

Sample SpectrumSampler::sample_of(double value, SampledSpectrum all) const {
  Sample sample;
  sample.value = value;
  sample.is_counted = all.is_counted;
  const double trusted = 2.0 * std::numbers::pi * options_.trusted;
  int num_pairs = 0;
  for (std::size_t i = 0; i < all.eigenvalues.size(); ++i) {
    const Complex s = all.eigenvalues[i];
    if (s.imag() > 0.0) ++num_pairs;
    if (options_.window.ends_before(s.imag(), num_pairs)) break;
    sample.eigenvalues.push_back(s);
    sample.excess.push_back(s.imag() > trusted ? -infinite : s.real() - all.rounding[i]);
  }
  return sample;
}

std::vector<int> continuations(const std::vector<Complex>& expected,
                               const std::vector<Complex>& found) {
  struct Candidate {
    double distance;
    int from, to;
  };
  std::vector<Candidate> candidates;
  candidates.reserve(expected.size() * found.size());
  for (std::size_t j = 0; j < expected.size(); ++j) {
    for (std::size_t k = 0; k < found.size(); ++k)
      candidates.push_back(
          {std::norm(expected[j] - found[k]), static_cast<int>(j), static_cast<int>(k)});
  }
  std::sort(candidates.begin(), candidates.end(), [](const Candidate& a, const Candidate& b) {
    return std::tuple(a.distance, a.from, a.to) < std::tuple(b.distance, b.from, b.to);
  });
  std::vector<int> partner(expected.size(), -1);
  std::vector<bool> is_taken(found.size(), false);
  for (const Candidate& one : candidates) {
    const auto j = static_cast<std::size_t>(one.from);
    const auto k = static_cast<std::size_t>(one.to);
    if (partner[j] >= 0 || is_taken[k]) continue;
    partner[j] = one.to;
    is_taken[k] = true;
  }
  return partner;
}

}  // namespace stridor
