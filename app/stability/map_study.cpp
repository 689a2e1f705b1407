#include "app/stability/map_study.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <complex>
#include <functional>
#include <limits>
#include <map>
#include <memory>
#include <utility>

#include "analysis/boundary_continuation.hpp"
#include "app/stability/family_locus.hpp"
#include "app/stability/verdict.hpp"
#include "app/terminal/progress.hpp"
#include "core/activity.hpp"
#include "core/errors.hpp"
#include "core/tasks.hpp"

namespace stridor {
namespace {

/// Results along one line of the grid.
struct LineResult {
  std::vector<double> growth;                                ///< at every value, 1/s
  PointFailures failures;                                    ///< by the index of the value
  std::vector<double> changes;                               ///< of stability, ascending
  double highest = std::numeric_limits<double>::infinity();  ///< up to where all were looked at, Hz
  Locus resolution;  ///< only its method, unresolved and unverified, of all parts of the line
};

/// Adds what may have been missed of one locus to that of others.
void add_resolution(Locus& all, const Locus& one) {
  if (all.method.empty()) all.method = one.method;
  all.unresolved = std::max(all.unresolved, one.unresolved);
  all.unverified.insert(all.unverified.end(), one.unverified.begin(), one.unverified.end());
}

double largest_growth(const std::vector<std::complex<double>>& eigenvalues) {
  double largest = -std::numeric_limits<double>::infinity();
  for (const std::complex<double>& s : eigenvalues) largest = std::max(largest, s.real());
  return largest;
}

std::vector<std::complex<double>> eigenvalues_at(StabilityFamily& family,
                                                 const std::vector<double>& values,
                                                 const LocusOptions& options) {
  const SpectrumMethod how = family.method(values);
  if (how == SpectrumMethod::counted)
    return family.spectra(0, values, options).at(values[0]).eigenvalues;
  const bool is_dense = options.method == LocusMethod::dense || how != SpectrumMethod::followed;
  const EigenvalueMethod method = is_dense ? EigenvalueMethod::dense : EigenvalueMethod::secular;
  std::vector<std::complex<double>> found;
  for (const Eigenvalue& one : lowest_eigenvalues(family.pencil(values), method, options.window))
    found.push_back(one.s);
  return found;
}

/// Appends the values at which the stability changes along one line.
void add_changes(LineResult& result, const KeyAxis& axis, const Locus& locus) {
  for (const StabilityChange& change : stability_changes(locus)) {
    double value = change.value;
    if (axis.key.is_integer) {
      const auto after = std::find(axis.values.begin(), axis.values.end(), value);
      value = 0.5 * (*(after - 1) + value);
    }
    if (result.changes.empty() || value > result.changes.back()) result.changes.push_back(value);
  }
}

/// A line on which there is no equilibrium somewhere: what there is at the single values, and the
/// changes between neighbours where there is one.
LineResult trace_broken_line(StabilityFamily& family, const KeyAxis& axis, std::size_t varied,
                             std::vector<double> values, const LocusOptions& options) {
  LineResult result;
  for (const double value : axis.values) {
    values[varied] = value;
    double growth = std::numeric_limits<double>::quiet_NaN();
    try {
      const std::vector<std::complex<double>> found = eigenvalues_at(family, values, options);
      result.highest = std::min(
          result.highest, verdict_limit(found, options.window, family.trusted_frequency(values)));
      growth = largest_growth(found);
    } catch (const NumericalError& error) {
      result.failures.emplace(result.growth.size(), error.report());
    }
    result.growth.push_back(growth);
  }
  const auto is_known = [](double growth) { return !std::isnan(growth); };
  auto begin = std::find_if(result.growth.begin(), result.growth.end(), is_known);
  while (begin != result.growth.end()) {
    const auto end = std::find_if_not(begin, result.growth.end(), is_known);
    const std::vector<double> part(axis.values.begin() + (begin - result.growth.begin()),
                                   axis.values.begin() + (end - result.growth.begin()));
    values[varied] = part.front();
    try {
      if (part.size() > 1) {
        const Locus locus =
            locus_along(family, axis.key, varied, values, part, options, SearchFor::stability);
        add_changes(result, axis, locus);
        add_resolution(result.resolution, locus);
      }
    } catch (const NumericalError&) {
      // Between two values there may be none either.
    }
    begin = std::find_if(end, result.growth.end(), is_known);
  }
  return result;
}

/// @param varied index of the key along the line: 0 for x
LineResult trace_line(StabilityFamily& family, const std::array<KeyAxis, 2>& axes,
                      std::size_t varied, double other, const LocusOptions& options) {
  const KeyAxis& axis = axes[varied];
  std::vector<double> values(2, other);
  values[varied] = axis.values.front();
  try {
    const Locus locus =
        locus_along(family, axis.key, varied, values, axis.values, options, SearchFor::stability);
    LineResult result;
    result.highest = verdict_limit(locus, options.window, family.trusted_frequency(values));
    for (const auto& eigenvalues : locus.eigenvalues)
      result.growth.push_back(largest_growth(eigenvalues));
    add_changes(result, axis, locus);
    add_resolution(result.resolution, locus);
    return result;
  } catch (const NumericalError&) {
    return trace_broken_line(family, axis, varied, values, options);
  }
}

/// Traces all rows, then all columns. Every line is a task of its own and begins from nothing, so
/// that the results do not depend on which thread takes it.
std::vector<LineResult> trace_lines(const StabilityScene& loaded,
                                    const std::array<KeyAxis, 2>& axes,
                                    const StabilityOptions& stability) {
  const std::size_t num_rows = axes[1].values.size();
  const std::size_t num_lines = num_rows + axes[0].values.size();
  // The dense method lives in LAPACK, which two threads must not enter at once (core/tasks.hpp).
  const bool is_dense = stability.locus_options().method == LocusMethod::dense;
  const int num_threads = is_dense || loaded.needs_one_thread() ? 1 : stability.common.threads;
  std::vector<std::unique_ptr<StabilityFamily>> families(
      static_cast<std::size_t>(std::max(num_threads, 1)));
  std::vector<LineResult> results(num_lines);
  const auto trace = [&](std::size_t line, std::size_t thread) {
    std::unique_ptr<StabilityFamily>& family = families[thread];
    if (!family) family = loaded.family({axes[0].key, axes[1].key}, stability.geometry());
    const bool is_row = line < num_rows;
    results[line] = trace_line(*family, axes, is_row ? 0 : 1,
                               is_row ? axes[1].values[line] : axes[0].values[line - num_rows],
                               stability.locus_options());
  };
  Progress progress("map");
  run_tasks(num_lines, num_threads, trace, [&](std::size_t num_done, std::size_t) {
    progress.report(static_cast<double>(num_done) / static_cast<double>(num_lines),
                    fmt::format("line {} of {}", num_done, num_lines));
  });
  progress.finish();
  return results;
}

/// Why a point failed, without its place: points that fail alike then share a text.
std::string without_place(std::string reason, const std::array<KeyAxis, 2>& axes) {
  const std::size_t begin = reason.find(fmt::format(" at {} = ", axes[0].key.path));
  if (begin == std::string::npos) return reason;
  const std::size_t end = std::min(reason.find(": ", begin), reason.size());
  return reason.erase(begin, end - begin);
}

/// @param failures of each row of the map
void add_failures(StabilityMap& map, const std::vector<PointFailures>& failures,
                  const std::array<KeyAxis, 2>& axes) {
  if (std::ranges::all_of(failures, [](const PointFailures& row) { return row.empty(); })) return;
  std::map<std::string, std::size_t> numbers;
  map.failure.assign(map.y.size(), std::vector<std::size_t>(map.x.size(), 0));
  for (std::size_t row = 0; row < failures.size(); ++row) {
    for (const auto& [column, text] : failures[row]) {
      const auto [known, is_new] = numbers.emplace(without_place(text, axes), numbers.size() + 1);
      if (is_new) map.reasons.push_back(known->first);
      map.failure[row][column] = known->second;
    }
  }
}

}  // namespace

StabilityMap make_stability_map(const StabilityScene& loaded, const std::array<KeyAxis, 2>& axes,
                                const StabilityOptions& stability,
                                std::array<Locus, 2>& resolution) {
  StabilityMap map;
  map.x = axes[0].values;
  map.y = axes[1].values;
  const auto make_field = [&] { return loaded.growth_field({axes[0].key, axes[1].key}); };
  if (make_field() != nullptr) {
    const Activity tracing("growth at every point, then the boundary");
    resolution[0].method = growth_formula;
    GrowthMap found = make_growth_map(make_field, map.x, map.y, stability.common.threads);
    map.growth = std::move(found.growth);
    add_failures(map, found.failures, axes);
    // Between the lines of the grid, on which it is known, the boundary is followed.
    const auto field = make_field();
    const auto spacing = [](const KeyAxis& axis) {
      return axis.is_logarithmic ? GridSpacing::logarithmic : GridSpacing::linear;
    };
    map.boundary =
        trace_boundary([&](double x, double y) { return field->margin(x, y); },
                       {map.x, map.y, {spacing(axes[0]), spacing(axes[1])}}, found.boundary);
    return map;
  }
  const std::vector<LineResult> lines = trace_lines(loaded, axes, stability);
  GridCrossings crossings{map.x, map.y, {}, {}};
  std::vector<PointFailures> failures;
  for (std::size_t i = 0; i < lines.size(); ++i) {
    const bool is_row = i < map.y.size();
    if (is_row) map.growth.push_back(lines[i].growth);
    if (is_row) failures.push_back(lines[i].failures);
    map.highest_frequency = std::min(map.highest_frequency, lines[i].highest);
    add_resolution(resolution[is_row ? 0 : 1], lines[i].resolution);
    (is_row ? crossings.along_x : crossings.along_y).push_back(lines[i].changes);
  }
  add_failures(map, failures, axes);
  map.boundary = boundary_lines(crossings);
  return map;
}

std::vector<FailedPoints> failed_points(const std::vector<std::string>& reasons,
                                        const std::vector<double>& failure) {
  std::vector<FailedPoints> all;
  all.reserve(reasons.size());
  for (const std::string& reason : reasons) all.push_back({all.size() + 1, 0, reason});
  for (const double number : failure) {
    if (number >= 1.0 && number <= static_cast<double>(all.size()))
      ++all[static_cast<std::size_t>(number) - 1].num_points;
  }
  std::ranges::stable_sort(all, std::ranges::greater{}, &FailedPoints::num_points);
  return all;
}

std::vector<FailedPoints> failed_points(const StabilityMap& map) {
  std::vector<double> failure;
  for (const auto& row : map.failure) failure.insert(failure.end(), row.begin(), row.end());
  return failed_points(map.reasons, failure);
}

}  // namespace stridor
