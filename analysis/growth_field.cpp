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

}  // namespace

std::vector<double> sign_changes(const StabilityMargin& margin, const std::vector<double>& values) {
  std::vector<double> changes;
  double before = std::numeric_limits<double>::quiet_NaN();
  for (std::size_t i = 0; i < values.size(); ++i) {
    const double here = margin(values[i]);
    if (i > 0 && !std::isnan(before) && !std::isnan(here) && (here > 0.0) != (before > 0.0)) {
      const double change = change_between(margin, values[i - 1], before, values[i], here);
      if (!std::isnan(change) && (changes.empty() || change > changes.back()))
        changes.push_back(change);
    }
    before = here;
  }
  return changes;
}

GrowthMap make_growth_map(const std::function<std::unique_ptr<GrowthField>()>& make_field,
                          const std::vector<double>& x, const std::vector<double>& y,
                          int num_threads, const std::function<void(double)>& report) {
  GrowthMap map;
  map.growth.resize(y.size());
  GridCrossings crossings{x, y, {}, {}};
  crossings.along_x.resize(y.size());
  crossings.along_y.resize(x.size());
  const std::size_t num_lines = x.size() + y.size();
  const auto trace = [&](std::size_t line, std::size_t) {
    // Anew for every line, or what it begins from would depend on the lines of this thread.
    const std::unique_ptr<GrowthField> field = make_field();
    if (line < y.size()) {
      const double at = y[line];
      for (const double value : x) map.growth[line].push_back(field->leading(value, at).real());
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
