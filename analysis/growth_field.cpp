#include "analysis/growth_field.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/tasks.hpp"

namespace stridor {
namespace {

/// The change of sign between two values of unlike sign: the Illinois form of regula falsi, with a
/// bisection wherever it has not halved the interval in three steps.
double change_between(const StabilityMargin& margin, double a, double fa, double b, double fb) {
  double width = std::abs(b - a);
  for (int i = 1; i <= 400; ++i) {
    const double tolerance = 1e-15 * (std::abs(a) + std::abs(b));
    if (std::abs(b - a) <= tolerance) break;
    double c = b - fb * (b - a) / (fb - fa);
    if (i % 3 == 0) {
      if (std::abs(b - a) > 0.5 * width) c = 0.5 * (a + b);
      width = std::abs(b - a);
    }
    const double low = std::min(a, b);
    const double high = std::max(a, b);
    if (!(c > low && c < high)) c = 0.5 * (a + b);
    if (!(c > low && c < high)) break;
    const double fc = margin(c);
    if (std::isnan(fc)) return std::numeric_limits<double>::quiet_NaN();
    if (fc == 0.0) return c;
    if ((fc > 0.0) != (fb > 0.0)) {
      a = b;
      fa = fb;
    } else {
      fa *= 0.5;
    }
    b = c;
    fb = fc;
  }
  return 0.5 * (a + b);
}

/// A value and the margin there.
struct Place {
  double value;
  double margin;
};

/// Whether three places of one sign may hide one of the other: the parabola through them comes from
/// the middle one half of the way to zero.
bool may_dip(const Place& a, const Place& b, const Place& c) {
  const double sign = b.margin > 0.0 ? 1.0 : -1.0;
  const bool is_closest = sign * b.margin < sign * a.margin && sign * b.margin < sign * c.margin;
  if (!is_closest || (a.margin > 0.0) != (b.margin > 0.0) || (c.margin > 0.0) != (b.margin > 0.0))
    return false;
  const double left = (b.margin - a.margin) / (b.value - a.value);
  const double right = (c.margin - b.margin) / (c.value - b.value);
  const double curvature = (right - left) / (c.value - a.value);
  const double slope = left + curvature * (b.value - a.value);
  return sign * (b.margin - 0.25 * slope * slope / curvature) < 0.5 * sign * b.margin;
}

/// Golden sections towards zero until the sign changes; the last place where it does not.
Place dip(const StabilityMargin& margin, Place a, Place b, Place c) {
  constexpr int most_steps = 50;
  const double ratio = 0.5 * (3.0 - std::sqrt(5.0));
  const bool is_positive = b.margin > 0.0;
  for (int i = 0; i < most_steps; ++i) {
    const bool is_right = c.value - b.value > b.value - a.value;
    const double value = b.value + ratio * ((is_right ? c.value : a.value) - b.value);
    const Place place{value, margin(value)};
    if (std::isnan(place.margin)) return b;
    if ((place.margin > 0.0) != is_positive) return place;
    if (std::abs(place.margin) < std::abs(b.margin)) {
      (is_right ? a : c) = b;
      b = place;
    } else {
      (is_right ? c : a) = place;
    }
  }
  return b;
}

}  // namespace

std::vector<double> sign_changes(const StabilityMargin& margin, const std::vector<double>& values) {
  std::vector<Place> given;
  for (const double value : values) given.push_back({value, margin(value)});
  std::vector<Place> places;
  for (std::size_t i = 0; i < given.size(); ++i) {
    places.push_back(given[i]);
    if (i == 0 || i + 1 == given.size() || !may_dip(given[i - 1], given[i], given[i + 1])) continue;
    const Place found = dip(margin, given[i - 1], given[i], given[i + 1]);
    if (found.value != given[i].value)
      places.insert(found.value < given[i].value ? places.end() - 1 : places.end(), found);
  }
  std::vector<double> changes;
  for (std::size_t i = 1; i < places.size(); ++i) {
    const Place& before = places[i - 1];
    const Place& here = places[i];
    if (std::isnan(before.margin) || std::isnan(here.margin) ||
        (here.margin > 0.0) == (before.margin > 0.0))
      continue;
    const double change =
        change_between(margin, before.value, before.margin, here.value, here.margin);
    if (!std::isnan(change) && (changes.empty() || change > changes.back()))
      changes.push_back(change);
  }
  return changes;
}

GrowthMap make_growth_map(const std::function<std::unique_ptr<GrowthField>()>& make_field,
                          const std::vector<double>& x, const std::vector<double>& y,
                          int num_threads, const std::function<void(double)>& report) {
  GrowthMap map;
  map.growth.resize(y.size());
  map.failures.resize(y.size());
  GridCrossings crossings{x, y, {}, {}};
  crossings.along_x.resize(y.size());
  crossings.along_y.resize(x.size());
  const std::size_t num_lines = x.size() + y.size();
  std::vector<std::unique_ptr<GrowthField>> fields(
      static_cast<std::size_t>(std::max(num_threads, 1)));
  const auto trace = [&](std::size_t line, std::size_t thread) {
    std::unique_ptr<GrowthField>& field = fields[thread];
    if (!field) field = make_field();
    // Every line begins from nothing, or its start would depend on the lines of this thread.
    field->restart();
    if (line < y.size()) {
      const double at = y[line];
      for (const double value : x) {
        const double growth = field->leading(value, at).real();
        if (std::isnan(growth))
          map.failures[line].emplace(map.growth[line].size(), field->failure());
        map.growth[line].push_back(growth);
      }
      crossings.along_x[line] =
          sign_changes([&](double value) { return field->margin(value, at); }, x);
    } else {
      const double at = x[line - y.size()];
      crossings.along_y[line - y.size()] =
          sign_changes([&](double value) { return field->margin(at, value); }, y);
    }
  };
  run_tasks(num_lines, num_threads, trace, [&](std::size_t num_done, std::size_t) {
    if (report) report(static_cast<double>(num_done) / static_cast<double>(num_lines));
  });
  map.boundary = boundary_lines(crossings);
  return map;
}

}  // namespace stridor
