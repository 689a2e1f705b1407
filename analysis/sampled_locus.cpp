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

  bool has_glimpses() const { return family_.glimpse != nullptr; }
  Sample at(double value) { return sample_of(value, family_.at(value)); }
  /// Of which only the fastest matters.
  Sample near(double value) {
    return family_.near ? sample_of(value, family_.near(value)) : at(value);
  }
  Sample glimpse(double value) { return sample_of(value, family_.glimpse(value)); }

 private:
  Sample sample_of(double value, const SampledSpectrum& all) const {
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
    Sample sample = sampler.near(next);
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
/// @param look takes a sample at a value
template <class Look>
Sample climb(Sampler& sampler, const Look& look, double low, const Sample& middle, double high,
             bool until_growing) {
  const int max_steps = sampler.effort().climbing_steps;
  const double ratio = 0.5 * (3.0 - std::sqrt(5.0));
  Sample best = middle;
  const double width = high - low;
  for (int i = 0; i < max_steps && high - low > 1e-6 * width; ++i) {
    if (until_growing && best.is_growing()) return best;
    const bool is_right = high - best.value > best.value - low;
    const double next = is_right ? best.value + ratio * (high - best.value)
                                 : best.value - ratio * (best.value - low);
    Sample sample = look(next);
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
    const auto look = [&](double value) { return sampler.near(value); };
    Sample top = climb(sampler, look, samples[i - 1].value, here, samples[i + 1].value, true);
    if (!top.is_growing()) continue;
    const auto after = static_cast<std::ptrdiff_t>(top.value > here.value ? i + 1 : i);
    samples.insert(samples.begin() + after, std::move(top));
    ++i;
  }
}

/// What two samples do not show of the values between them, by several glimpses there. Ascending.
std::vector<Sample> hidden_between(Sampler& sampler, const Sample& low, const Sample& high,
                                   int num_glimpses) {
  std::vector<Sample> looks{low};
  for (int i = 1; i <= num_glimpses; ++i)
    looks.push_back(
        sampler.glimpse(low.value + (high.value - low.value) * i / (num_glimpses + 1.0)));
  looks.push_back(high);
  std::vector<Sample> hidden;
  const auto look_closely = [&](const Sample& look) {
    Sample sample = look.is_growing() ? sampler.near(look.value) : sampler.at(look.value);
    if (sample.is_growing() == look.is_growing()) hidden.push_back(std::move(sample));
  };
  // Stretches of growth and of none, without those that either end belongs to.
  for (std::size_t first = 1; first + 1 < looks.size();) {
    std::size_t last = first;
    while (last + 1 < looks.size() && looks[last + 1].is_growing() == looks[first].is_growing())
      ++last;
    const bool is_at_end =
        last + 1 == looks.size() || looks[first].is_growing() == looks[first - 1].is_growing();
    if (!is_at_end) {
      const auto begin = looks.begin() + static_cast<std::ptrdiff_t>(first);
      const auto end = looks.begin() + static_cast<std::ptrdiff_t>(last) + 1;
      const auto by_excess = [](const Sample& a, const Sample& b) { return a.excess < b.excess; };
      look_closely(looks[first].is_growing() ? *std::max_element(begin, end, by_excess)
                                             : *std::min_element(begin, end, by_excess));
    }
    first = last + 1;
  }
  if (!hidden.empty() || low.is_growing() || high.is_growing()) return hidden;
  // Nothing grows by any of them: the largest may be the foot of a narrow window.
  const auto top =
      std::max_element(looks.begin(), looks.end(),
                       [](const Sample& a, const Sample& b) { return a.excess < b.excess; });
  if (top == looks.begin() || top + 1 == looks.end()) return hidden;
  const Sample peak = climb(
      sampler, [&](double value) { return sampler.glimpse(value); }, (top - 1)->value, *top,
      (top + 1)->value, true);
  Sample sample = sampler.near(peak.value);
  if (sample.is_growing()) hidden.push_back(std::move(sample));
  return hidden;
}

UnstableWindow window_of(Sampler& sampler, const std::vector<Sample>& samples) {
  UnstableWindow window;
  window.from = samples.front().value;
  window.to = samples.back().value;
  const auto top =
      std::max_element(samples.begin(), samples.end(),
                       [](const Sample& a, const Sample& b) { return a.growth() < b.growth(); });
  Sample peak = *top;
  if (top != samples.begin() && top + 1 != samples.end()) {
    const auto look = [&](double value) { return sampler.near(value); };
    peak = climb(sampler, look, (top - 1)->value, *top, (top + 1)->value, false);
  }
  for (std::size_t i = 0; i + 1 < samples.size(); ++i) {
    const Sample& a = samples[i];
    const Sample& b = samples[i + 1];
    const Sample middle = sampler.near(0.5 * (a.value + b.value));
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
  return sample_locus(SpectrumFamily{DenseSpectra(family), nullptr, nullptr}, values, options,
                      SamplingEffort{});
}

Locus sample_locus(const SpectrumFamily& family, const std::vector<double>& values,
                   const LocusOptions& options, const SamplingEffort& effort) {
  check(family.at != nullptr, values, options);
  Sampler sampler(family, options, effort);
  std::vector<Sample> samples;
  Locus locus;
  locus.values = values;
  const auto num_intervals = static_cast<int>(values.size()) - 1;
  const int num_glimpses = std::max(7, effort.least_glimpses / std::max(1, num_intervals));
  for (const double value : fill_in(values, effort.least_values)) {
    Sample sample = sampler.at(value);
    ++locus.num_places;
    if (sampler.has_glimpses() && !samples.empty()) {
      for (Sample& hidden : hidden_between(sampler, samples.back(), sample, num_glimpses))
        samples.push_back(std::move(hidden));
    }
    samples.push_back(std::move(sample));
  }
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
