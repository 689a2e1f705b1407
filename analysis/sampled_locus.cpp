#include "analysis/sampled_locus.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <iterator>
#include <stdexcept>
#include <utility>

#include "analysis/interval_search.hpp"

namespace stridor {
namespace {

/// Climbs to the largest growth between three glimpses by golden sections; stops early where
/// something grows.
Sample climb(const SpectrumSampler& sampler, int max_steps, double low, const Sample& middle,
             double high) {
  const double ratio = 0.5 * (3.0 - std::sqrt(5.0));
  Sample best = middle;
  const double width = high - low;
  for (int i = 0; i < max_steps && high - low > 1e-6 * width && best.num_growing() == 0; ++i) {
    const bool is_right = high - best.value > best.value - low;
    const double next = is_right ? best.value + ratio * (high - best.value)
                                 : best.value - ratio * (best.value - low);
    Sample sample = sampler.glimpse(next);
    if (sample.ranked_excess(1) > best.ranked_excess(1)) {
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

bool has_less_excess(const Sample& a, const Sample& b) {
  return a.ranked_excess(1) < b.ranked_excess(1);
}

/// Samples hidden between two samples, found by several glimpses there. Ascending.
std::vector<Sample> hidden_between(const SpectrumSampler& sampler, const SamplingEffort& effort,
                                   const Sample& low, const Sample& high, int num_glimpses) {
  std::vector<Sample> looks{low};
  for (int i = 1; i <= num_glimpses; ++i)
    looks.push_back(
        sampler.glimpse(low.value + (high.value - low.value) * i / (num_glimpses + 1.0)));
  looks.push_back(high);
  std::vector<Sample> hidden;
  const auto is_growing = [](const Sample& look) { return look.num_growing() > 0; };
  const auto look_closely = [&](const Sample& look) {
    Sample sample = is_growing(look) ? sampler.near(look.value) : sampler.at(look.value);
    if (is_growing(sample) == is_growing(look)) hidden.push_back(std::move(sample));
  };
  // Stretches of growth and of none, without those that either end belongs to.
  for (std::size_t first = 1; first + 1 < looks.size();) {
    std::size_t last = first;
    while (last + 1 < looks.size() && is_growing(looks[last + 1]) == is_growing(looks[first]))
      ++last;
    const bool is_at_end =
        last + 1 == looks.size() || is_growing(looks[first]) == is_growing(looks[first - 1]);
    if (!is_at_end) {
      const auto begin = looks.begin() + static_cast<std::ptrdiff_t>(first);
      const auto end = looks.begin() + static_cast<std::ptrdiff_t>(last) + 1;
      look_closely(is_growing(looks[first]) ? *std::max_element(begin, end, has_less_excess)
                                            : *std::min_element(begin, end, has_less_excess));
    }
    first = last + 1;
  }
  if (!hidden.empty() || is_growing(low) || is_growing(high)) return hidden;
  // Nothing grows by any of them: the largest may be the foot of a narrow window.
  const auto top = std::max_element(looks.begin(), looks.end(), has_less_excess);
  if (top == looks.begin() || top + 1 == looks.end()) return hidden;
  const Sample peak =
      climb(sampler, effort.windows.climbing_steps, (top - 1)->value, *top, (top + 1)->value);
  Sample sample = sampler.near(peak.value);
  if (is_growing(sample)) hidden.push_back(std::move(sample));
  return hidden;
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
  return sample_locus(family, values, options, SamplingEffort{});
}

Locus sample_locus(const PencilFamily& family, const std::vector<double>& values,
                   const LocusOptions& options, const SamplingEffort& effort) {
  check(family.place != nullptr, values, options);
  return sample_locus(dense_spectra(family), values, options, effort);
}

Locus sample_locus(const SpectrumFamily& family, const std::vector<double>& values,
                   const LocusOptions& options, const SamplingEffort& effort) {
  check(family.at != nullptr, values, options);
  const SpectrumSampler sampler(family, options);
  std::vector<Sample> whole;
  std::vector<Sample> samples;
  Locus locus;
  locus.values = values;
  const auto num_intervals = static_cast<int>(values.size()) - 1;
  const int num_glimpses = std::max(7, effort.least_glimpses / std::max(1, num_intervals));
  for (const double value : fill_in(values, effort.least_values)) {
    Sample sample = sampler.at(value);
    if (sampler.has_glimpses() && !whole.empty()) {
      for (Sample& hidden : hidden_between(sampler, effort, whole.back(), sample, num_glimpses))
        samples.push_back(std::move(hidden));
    }
    whole.push_back(std::move(sample));
  }
  IntervalSearch search = search_intervals(sampler, whole, effort.most_added, effort.wanted);
  locus.unresolved = search.unresolved;
  locus.num_places = static_cast<int>(whole.size());
  auto wanted = values.begin();
  for (const Sample& sample : whole) {
    if (wanted == values.end() || sample.value != *wanted) continue;
    locus.eigenvalues.push_back(sample.eigenvalues);
    ++wanted;
  }
  for (std::vector<Sample>* more : {&whole, &search.between})
    std::move(more->begin(), more->end(), std::back_inserter(samples));
  std::stable_sort(samples.begin(), samples.end(),
                   [](const Sample& a, const Sample& b) { return a.value < b.value; });
  if (effort.wanted == SearchFor::stability) {
    find_unstable_stretches(sampler, effort.windows, std::move(samples), locus);
  } else {
    find_sampled_windows(sampler, effort.windows, std::move(samples), locus);
  }
  return locus;
}

}  // namespace stridor
