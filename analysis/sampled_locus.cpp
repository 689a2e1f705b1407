#include "analysis/sampled_locus.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <iterator>
#include <stdexcept>
#include <utility>

#include "analysis/interval_search.hpp"
#include "analysis/sampled_branches.hpp"

namespace stridor {
namespace {

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

void check(bool has_family, const std::vector<double>& values, const LocusOptions& options) {
  const auto reject = [](const std::string& message) {
    throw std::invalid_argument("locus: " + message);
  };
  if (!has_family) reject("there is no family");
  if (values.empty()) reject("there are no values");
  const bool ascends =
      std::adjacent_find(values.begin(), values.end(), std::greater_equal<>()) == values.end();
  if (!ascends) reject("the values must ascend");
  check_window(options);
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
  for (const double value : fill_in(values, effort.least_values))
    whole.push_back(sampler.at(value));
  IntervalSearch search = search_intervals(sampler, whole, effort.most_added, effort.wanted);
  locus.unresolved = search.unresolved;
  locus.num_places = static_cast<int>(whole.size());
  auto wanted = values.begin();
  for (const Sample& sample : whole) {
    if (!sample.is_counted) locus.unverified.push_back(sample.value);
    if (wanted == values.end() || sample.value != *wanted) continue;
    locus.eigenvalues.push_back(sample.eigenvalues);
    ++wanted;
  }
  samples = whole;
  std::move(search.between.begin(), search.between.end(), std::back_inserter(samples));
  std::stable_sort(samples.begin(), samples.end(),
                   [](const Sample& a, const Sample& b) { return a.value < b.value; });
  if (effort.wanted == SearchFor::stability) {
    find_unstable_stretches(sampler, effort.windows, std::move(samples), locus);
  } else {
    find_sampled_windows(sampler, effort.windows, std::move(samples), locus);
    add_branches(whole, locus);
  }
  return locus;
}

}  // namespace stridor
