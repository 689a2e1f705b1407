#include "analysis/sampled_locus.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <stdexcept>

#include "solvers/dense_eigenvalues.hpp"

namespace stridor {
namespace {

using Complex = std::complex<double>;

/// The eigenvalues wanted at one value, and how fast the fastest grows.
struct Sample {
  double value = 0.0;
  std::vector<Complex> eigenvalues;
  Complex fastest;      ///< of the largest real part beyond rounding
  double excess = 0.0;  ///< that real part less what may be rounding, 1/s

  bool is_growing() const { return excess > 0.0; }
  double growth() const { return std::max(fastest.real(), 0.0); }
};

/// All eigenvalues of the dense problem, and what may be rounding of them.
class DenseSpectra {
 public:
  explicit DenseSpectra(const PencilFamily& family) : family_(&family) {}

  SampledSpectrum operator()(double value) {
    family_->place(value, pencil_);
    // What is beyond doubt needs no condition numbers.
    DenseSpectrum all = dense_spectrum(pencil_, DenseWork::eigenvalues);
    if (std::any_of(all.eigenvalues.begin(), all.eigenvalues.end(), is_doubtful))
      all = dense_spectrum(pencil_, DenseWork::conditions);
    SampledSpectrum spectrum;
    for (std::size_t i = 0; i < all.eigenvalues.size(); ++i) {
      spectrum.eigenvalues.push_back(all.eigenvalues[i].s);
      spectrum.rounding.push_back(rounding_of(all, i));
    }
    return spectrum;
  }

 private:
  static constexpr double largest_rounding = 1e-6;  ///< of |s|

  static bool is_doubtful(const Eigenvalue& one) {
    return std::abs(one.s.real()) <= largest_rounding * std::abs(one.s);
  }

  /// What rounding may have added to the real part.
  double rounding_of(const DenseSpectrum& all, std::size_t i) const {
    if (!is_doubtful(all.eigenvalues[i])) return 0.0;
    const double rounding =
        20.0 * std::numeric_limits<double>::epsilon() * pencil_.omega.maxCoeff();
    return std::min(rounding * all.conditions[i],
                    largest_rounding * std::abs(all.eigenvalues[i].s));
  }

  const PencilFamily* family_;
  Pencil pencil_;
};

class Sampler {
 public:
  Sampler(const SpectrumFamily& family, const LocusOptions& options, const SamplingEffort& effort)
      : family_(family), options_(options), effort_(effort) {}

  const SamplingEffort& effort() const { return effort_; }

  Sample at(double value) {
    const SampledSpectrum all = family_(value);
    Sample sample;
    sample.value = value;
    sample.excess = -std::numeric_limits<double>::infinity();
    const double top = 2.0 * std::numbers::pi * options_.frequency;
    const double trusted = 2.0 * std::numbers::pi * options_.trusted;
    int num_pairs = 0;
    for (std::size_t i = 0; i < all.eigenvalues.size(); ++i) {
      const Complex s = all.eigenvalues[i];
      if (s.imag() > top || (s.imag() > 0.0 && ++num_pairs > options_.count)) break;
      sample.eigenvalues.push_back(s);
      const double excess = s.real() - all.rounding[i];
      if (excess <= sample.excess || s.imag() > trusted) continue;
      sample.excess = excess;
      sample.fastest = s;
    }
    return sample;
  }

 private:
  const SpectrumFamily& family_;
  const LocusOptions& options_;
  SamplingEffort effort_;
};

/// Narrows the interval between a sample that grows and one that does not until nothing lies
/// between; `stable` and `growing` are its ends afterwards.
void narrow(Sampler& sampler, Sample& stable, Sample& growing) {
  constexpr int max_steps = 200;
  const bool has_secants = sampler.effort().ends == SamplingEffort::Ends::secants;
  double stable_weight = 1.0, growing_weight = 1.0;
  int num_growing = 0, num_stable = 0;  // in a row
  for (int i = 0; i < max_steps; ++i) {
    double next = 0.5 * (stable.value + growing.value);
    const double width = std::abs(growing.value - stable.value);
    if (next == stable.value || next == growing.value ||
        width <= sampler.effort().tolerance * std::abs(next)) {
      return;
    }
    // The secant, with the excess halved at an end that stays again (Illinois); now and then the
    // middle, as the excess may have a kink.
    const double below = stable_weight * stable.excess;
    const double above = growing_weight * growing.excess;
    if (has_secants && i % 6 != 5 && std::isfinite(below)) {
      const double at = stable.value + (growing.value - stable.value) * below / (below - above);
      const double margin = 0.3 * sampler.effort().tolerance * std::abs(next);
      next = std::clamp(at, std::min(stable.value, growing.value) + margin,
                        std::max(stable.value, growing.value) - margin);
    }
    Sample sample = sampler.at(next);
    const bool is_growing = sample.is_growing();
    num_growing = is_growing ? num_growing + 1 : 0;
    num_stable = is_growing ? 0 : num_stable + 1;
    stable_weight = num_growing > 1 ? 0.5 * stable_weight : 1.0;
    growing_weight = num_stable > 1 ? 0.5 * growing_weight : 1.0;
    (is_growing ? growing : stable) = std::move(sample);
  }
}

/// Climbs to the largest growth between three samples by golden sections; stops early where
/// something grows if `until_growing`.
Sample climb(Sampler& sampler, double low, const Sample& middle, double high, bool until_growing) {
  const int max_steps = sampler.effort().climbing_steps;
  const double ratio = 0.5 * (3.0 - std::sqrt(5.0));
  Sample best = middle;
  const double width = high - low;
  for (int i = 0; i < max_steps && high - low > 1e-6 * width; ++i) {
    if (until_growing && best.is_growing()) return best;
    const bool is_right = high - best.value > best.value - low;
    const double next = is_right ? best.value + ratio * (high - best.value)
                                 : best.value - ratio * (best.value - low);
    Sample sample = sampler.at(next);
    if (sample.excess > best.excess) {
      (is_right ? low : high) = best.value;
      best = std::move(sample);
    } else {
      (is_right ? high : low) = next;
    }
  }
  return best;
}

/// Values asked for, and others between them where they are sparse.
std::vector<double> fill_in(const std::vector<double>& wanted, int least_in_all) {
  std::vector<double> grid{wanted.front()};
  const double longest = (wanted.back() - wanted.front()) / least_in_all;
  for (std::size_t i = 0; i + 1 < wanted.size(); ++i) {
    const double length = wanted[i + 1] - wanted[i];
    const auto parts = std::max(1, static_cast<int>(std::ceil(length / longest * (1.0 - 1e-9))));
    for (int part = 1; part < parts; ++part) grid.push_back(wanted[i] + length * part / parts);
    grid.push_back(wanted[i + 1]);
  }
  return grid;
}

/// Adds samples where the growth has a maximum below zero that may reach above it.
void add_maxima(Sampler& sampler, std::vector<Sample>& samples) {
  for (std::size_t i = 1; i + 1 < samples.size(); ++i) {
    const Sample& here = samples[i];
    const bool is_maximum =
        here.excess > samples[i - 1].excess && here.excess > samples[i + 1].excess;
    const bool is_damped = here.excess < -1e-6 * std::abs(here.fastest);
    const bool is_stable =
        !samples[i - 1].is_growing() && !here.is_growing() && !samples[i + 1].is_growing();
    if (!is_maximum || !is_damped || !is_stable) continue;
    Sample top = climb(sampler, samples[i - 1].value, here, samples[i + 1].value, true);
    if (!top.is_growing()) continue;
    const auto after = static_cast<std::ptrdiff_t>(top.value > here.value ? i + 1 : i);
    samples.insert(samples.begin() + after, std::move(top));
    ++i;
  }
}

UnstableWindow window_of(Sampler& sampler, const std::vector<Sample>& samples) {
  UnstableWindow window;
  window.from = samples.front().value;
  window.to = samples.back().value;
  const auto top =
      std::max_element(samples.begin(), samples.end(),
                       [](const Sample& a, const Sample& b) { return a.growth() < b.growth(); });
  Sample peak = *top;
  if (top != samples.begin() && top + 1 != samples.end())
    peak = climb(sampler, (top - 1)->value, *top, (top + 1)->value, false);
  for (std::size_t i = 0; i + 1 < samples.size(); ++i) {
    const Sample& a = samples[i];
    const Sample& b = samples[i + 1];
    const Sample middle = sampler.at(0.5 * (a.value + b.value));
    if (middle.growth() > peak.growth()) peak = middle;
    // Simpson's rule.
    window.growth_integral +=
        (b.value - a.value) / 6.0 * (a.growth() + 4.0 * middle.growth() + b.growth());
  }
  window.growth_max = peak.growth();
  window.frequency = peak.fastest.imag() / (2.0 * std::numbers::pi);
  window.value_max = peak.value;
  return window;
}

/// Windows and crossings between samples in ascending order.
void find_windows(Sampler& sampler, const std::vector<Sample>& samples, Locus& locus) {
  std::vector<Sample> open;
  const auto add_crossing = [&](const Sample& growing, int direction) {
    locus.crossings.push_back(
        {growing.value, growing.fastest.imag() / (2.0 * std::numbers::pi), direction, 0});
  };
  const auto close = [&] {
    locus.unstable.push_back(window_of(sampler, open));
    open.clear();
  };
  for (std::size_t i = 0; i < samples.size(); ++i) {
    const bool was_growing = i > 0 && samples[i - 1].is_growing();
    const bool is_growing = samples[i].is_growing();
    if (i > 0 && was_growing != is_growing) {
      Sample stable = was_growing ? samples[i] : samples[i - 1];
      Sample growing = was_growing ? samples[i - 1] : samples[i];
      narrow(sampler, stable, growing);
      add_crossing(growing, was_growing ? -1 : 1);
      open.push_back(growing);
      if (was_growing) close();
    }
    if (is_growing) open.push_back(samples[i]);
  }
  if (!open.empty()) close();
}

void check(bool has_family, const std::vector<double>& values, const LocusOptions& options) {
  const auto reject = [](const std::string& message) {
    throw std::invalid_argument("locus: " + message);
  };
  if (!has_family) reject("there is no family");
  if (values.empty()) reject("there are no values");
  const bool ascends =
      std::adjacent_find(values.begin(), values.end(), std::greater_equal<>()) == values.end();
  if (!ascends) reject("the values must ascend");
  if (options.count < 1) reject(fmt::format("{} eigenvalues are none", options.count));
}

}  // namespace

Locus sample_locus(const PencilFamily& family, const std::vector<double>& values,
                   const LocusOptions& options) {
  check(family.place != nullptr, values, options);
  return sample_locus(SpectrumFamily(DenseSpectra(family)), values, options, SamplingEffort{});
}

Locus sample_locus(const SpectrumFamily& family, const std::vector<double>& values,
                   const LocusOptions& options, const SamplingEffort& effort) {
  check(family != nullptr, values, options);
  Sampler sampler(family, options, effort);
  std::vector<Sample> samples;
  for (const double value : fill_in(values, effort.least_values))
    samples.push_back(sampler.at(value));
  Locus locus;
  locus.values = values;
  locus.num_places = static_cast<int>(samples.size());
  auto wanted = values.begin();
  for (const Sample& sample : samples) {
    if (wanted == values.end() || sample.value != *wanted) continue;
    locus.eigenvalues.push_back(sample.eigenvalues);
    ++wanted;
  }
  add_maxima(sampler, samples);
  find_windows(sampler, samples, locus);
  return locus;
}

}  // namespace stridor
