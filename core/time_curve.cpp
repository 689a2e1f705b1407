#include "core/time_curve.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>

namespace stridor {

TimeCurve::TimeCurve(TimeTable table) : table_(std::move(table)) {
  const auto& [times, values] = table_;
  if (times.empty() || times.size() != values.size()) {
    throw std::invalid_argument("TimeCurve: times and values need the same length, at least 1");
  }
  for (std::size_t i = 0; i < times.size(); ++i) {
    if (!std::isfinite(times[i]) || !std::isfinite(values[i])) {
      throw std::invalid_argument("TimeCurve: times and values must be finite");
    }
    if (i > 0 && times[i] <= times[i - 1]) {
      throw std::invalid_argument("TimeCurve: times must increase strictly");
    }
  }
  integrals_.assign(times.size(), 0.0);
  for (std::size_t i = 1; i < times.size(); ++i) {
    // The smoothstep is antisymmetric about its middle, so its mean is that of the end values.
    integrals_[i] =
        integrals_[i - 1] + (times[i] - times[i - 1]) * 0.5 * (values[i - 1] + values[i]);
  }
}

TimeCurve TimeCurve::ramp(double value, double duration) {
  if (duration == 0.0) return TimeCurve(value);
  return TimeCurve(TimeTable{{0.0, duration}, {0.0, value}});
}

std::size_t TimeCurve::interval(double time) const {
  const auto& times = table_.times;
  return static_cast<std::size_t>(std::upper_bound(times.begin(), times.end(), time) -
                                  times.begin());
}

double TimeCurve::value(double time) const {
  const auto& [times, values] = table_;
  if (time >= times.back()) return values.back();  // without a search: it is asked in every step
  const std::size_t i = interval(time);
  if (i == 0) return values.front();
  const double x = (time - times[i - 1]) / (times[i] - times[i - 1]);
  const double r = x * x * x * (10.0 + x * (-15.0 + 6.0 * x));
  return values[i - 1] + (values[i] - values[i - 1]) * r;
}

double TimeCurve::slope(double time) const {
  const auto& [times, values] = table_;
  const std::size_t i = interval(time);
  if (i == 0 || i == times.size()) return 0.0;
  const double width = times[i] - times[i - 1];
  const double x = (time - times[i - 1]) / width;
  return (values[i] - values[i - 1]) * 30.0 * x * x * (1.0 - x) * (1.0 - x) / width;
}

double TimeCurve::integral_from_first(double time) const {
  const auto& [times, values] = table_;
  const std::size_t i = interval(time);
  if (i == 0) return values.front() * (time - times.front());
  if (i == times.size()) return integrals_.back() + values.back() * (time - times.back());
  const double width = times[i] - times[i - 1];
  const double x = (time - times[i - 1]) / width;
  const double ramp_area = x * x * x * x * (2.5 + x * (-3.0 + x));
  return integrals_[i - 1] + width * (values[i - 1] * x + (values[i] - values[i - 1]) * ramp_area);
}

double TimeCurve::integral(double time) const {
  return integral_from_first(time) - integral_from_first(0.0);
}

bool TimeCurve::is_zero() const {
  return std::all_of(table_.values.begin(), table_.values.end(),
                     [](double value) { return value == 0.0; });
}

}  // namespace stridor
