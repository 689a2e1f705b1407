#include "app/stability/family_locus.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <limits>
#include <numbers>
#include <optional>
#include <utility>

#include "app/stability/key_range.hpp"
#include "app/stability/lowest_eigenvalues.hpp"
#include "app/terminal/remark.hpp"
#include "core/memory.hpp"
#include "models/set_up_estimate.hpp"
#include "solvers/eigenvalues/search_failure.hpp"

namespace stridor {
namespace {

/// About how many pairs a window holds. Contacts move few of them down past the frequencies of the
/// bodies.
Eigen::Index most_wanted(const Pencil& pencil, const SpectrumWindow& window) {
  const double top = 2.0 * std::numbers::pi * window.frequency;
  const Eigen::Index below = (pencil.omega.array() <= top).count() + pencil.num_constraints();
  const Eigen::Index most = window.count.value_or(std::numeric_limits<int>::max());
  return std::min({below, pencil.num_eigenvalues() / 2, most});
}

/// The locus along whole numbers.
Locus locus_at(const PencilFamily& family, const std::vector<double>& range,
               const LocusOptions& options) {
  Locus locus;
  locus.values = range;
  Pencil pencil;
  const EigenvalueMethod method =
      options.method == LocusMethod::dense ? EigenvalueMethod::dense : EigenvalueMethod::secular;
  bool was_growing = false;
  for (const double value : range) {
    family.place(value, pencil);
    locus.eigenvalues.emplace_back();
    const Eigenvalue* fastest = nullptr;
    const std::vector<Eigenvalue> eigenvalues = lowest_eigenvalues(pencil, method, options.window);
    for (const Eigenvalue& one : eigenvalues) {
      locus.eigenvalues.back().push_back(one.s);
      if (is_growing(one) && (fastest == nullptr || one.growth() > fastest->growth()))
        fastest = &one;
    }
    if (fastest != nullptr) {
      if (!was_growing) locus.unstable.push_back({value, value, 0.0, 0.0, 0.0, value, 0});
      UnstableWindow& window = locus.unstable.back();
      window.to = value;
      if (fastest->growth() > window.growth_max) {
        window.growth_max = fastest->growth();
        window.frequency = fastest->frequency();
        window.value_max = value;
      }
    }
    const bool is_change = !locus.eigenvalues.empty() && locus.eigenvalues.size() > 1 &&
                           was_growing != (fastest != nullptr);
    if (is_change) {
      locus.crossings.push_back({value, locus.unstable.back().frequency, was_growing ? -1 : 1, 0});
    }
    was_growing = fastest != nullptr;
  }
  return locus;
}

Locus by(const char* method, Locus locus) {
  locus.method = method;
  return locus;
}

const char* name_of(LocusMethod method) {
  return method == LocusMethod::dense ? "dense" : "secular";
}

/// The branches along a range, by the dense method where the search for zeros of the secular
/// function fails.
/// @throws NumericalError as trace_locus()
Locus trace(const PencilFamily& family, const NumericKey& varied, const std::vector<double>& range,
            const LocusOptions& options) {
  try {
    return by(name_of(options.method), trace_locus(family, range, options));
  } catch (const SearchFailure& error) {
    if (options.method == LocusMethod::dense) throw;
    Pencil first;
    family.place(range.front(), first);
    if (first.num_eigenvalues() > most_dense) throw;
    print_remark(
        "{} ({}) as zeros of the secular function: all {} eigenvalues by the dense method; fewer "
        "modes (time.retain) are faster\n",
        error.what(), varied.path, first.num_eigenvalues());
  }
  LocusOptions dense = options;
  dense.method = LocusMethod::dense;
  return by(name_of(dense.method), trace_locus(family, range, dense));
}

}  // namespace

Locus locus_along(StabilityFamily& family, const NumericKey& varied, std::size_t key,
                  const std::vector<double>& values, const std::vector<double>& range,
                  const LocusOptions& options, SearchFor wanted) {
  // An end that is not allowed is named as it was given, before anything is computed in between.
  std::vector<double> ends = values;
  ends[key] = range.front();
  SpectrumMethod method = family.method(ends);
  if (method == SpectrumMethod::from_neighbours && options.method == LocusMethod::dense)
    method = SpectrumMethod::sampled;
  double trusted = std::numeric_limits<double>::infinity();
  Eigen::Index num_wanted = 0;
  for (const double end : {range.front(), range.back()}) {
    ends[key] = end;
    if (method != SpectrumMethod::counted) {
      const Pencil pencil = family.pencil(ends);
      num_wanted = std::max(num_wanted, most_wanted(pencil, options.window));
    }
    trusted = std::min(trusted, family.trusted_frequency(ends));
  }
  // How many large sparse matrices have below a frequency is known only once they are found.
  if (method == SpectrumMethod::counted) num_wanted = options.window.count.value_or(0);
  // Measured: tracks, results and their JSON.
  constexpr double bytes_per_eigenvalue = 500.0;
  const auto num_values = static_cast<double>(range.size());
  require_memory_for(
      {"--points", fmt::format("{} eigenvalues at {} values", num_wanted, range.size()),
       "ask for fewer values, or eigenvalues (--count, --below)",
       bytes_per_eigenvalue * num_values * static_cast<double>(num_wanted)},
      memory_limit());
  LocusOptions within = options;
  within.trusted = trusted;
  if (method == SpectrumMethod::counted || method == SpectrumMethod::from_neighbours) {
    // Between the values of a whole number there are none.
    std::optional<std::pair<double, double>> between;
    if (!varied.is_integer) between.emplace(range.front(), range.back());
    return by(
        method == SpectrumMethod::counted ? "sparse" : "followed",
        sample_locus(family.spectra(key, values, within, between), range, within, sparing_effort));
  }
  const PencilFamily pencils = family.along(key, values, range.front(), range.back());
  if (varied.is_integer) {
    LocusOptions wholes = options;
    if (method == SpectrumMethod::sampled) wholes.method = LocusMethod::dense;
    return by(name_of(wholes.method), locus_at(pencils, range, wholes));
  }
  if (method == SpectrumMethod::followed) return trace(pencils, varied, range, options);
  return by(name_of(LocusMethod::dense),
            sample_locus(pencils, range, within,
                         wanted == SearchFor::stability ? stability_effort : SamplingEffort{}));
}

std::vector<StabilityChange> stability_changes(const Locus& locus) {
  // Between two crossings the number of growing eigenvalues is that of the windows there.
  const auto num_growing = [&](double value) {
    return std::count_if(locus.unstable.begin(), locus.unstable.end(), [&](const auto& window) {
      return window.from < value && value < window.to;
    });
  };
  std::vector<StabilityChange> changes;
  for (std::size_t i = 0; i < locus.crossings.size(); ++i) {
    const Crossing& crossing = locus.crossings[i];
    const double before = i == 0 ? locus.values.front() : locus.crossings[i - 1].value;
    const double after =
        i + 1 == locus.crossings.size() ? locus.values.back() : locus.crossings[i + 1].value;
    const bool was_stable = num_growing(0.5 * (before + crossing.value)) == 0;
    const bool is_stable = num_growing(0.5 * (crossing.value + after)) == 0;
    if (was_stable != is_stable)
      changes.push_back({crossing.value, crossing.frequency, was_stable});
  }
  return changes;
}

}  // namespace stridor
