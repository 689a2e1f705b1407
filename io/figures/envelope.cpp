#include "io/figures/envelope.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>

#include "io/figures/axes.hpp"

namespace stridor {

void check_curve(const Curve& curve) {
  if (curve.times.size() != curve.values.size()) {
    throw std::invalid_argument(fmt::format("history plot: {} times for {} values",
                                            curve.times.size(), curve.values.size()));
  }
  const auto descends = [](double a, double b) { return !(a <= b); };
  if (std::adjacent_find(curve.times.begin(), curve.times.end(), descends) != curve.times.end()) {
    throw std::invalid_argument("history plot: the times do not ascend");
  }
}

void check_band(const ValueBand& band) {
  if (band.times.size() != band.lower.size() || band.times.size() != band.upper.size())
    throw std::invalid_argument(fmt::format("history plot: a band of {} times has {} and {} values",
                                            band.times.size(), band.lower.size(),
                                            band.upper.size()));
}

Curve envelope(const Curve& curve, std::size_t columns) {
  check_curve(curve);
  if (columns == 0)
    throw std::invalid_argument("history plot: an envelope needs at least one column");
  const std::size_t count = curve.times.size();
  if (count <= 2 * columns) return curve;
  Curve reduced;
  reduced.name = curve.name;
  const double first = curve.times.front();
  const double width = (curve.times.back() - first) / static_cast<double>(columns);
  const auto add = [&](std::size_t i) {
    reduced.times.push_back(curve.times[i]);
    reduced.values.push_back(curve.values[i]);
  };
  for (std::size_t begin = 0, column = 1; begin < count; ++column) {
    const double limit = column >= columns ? std::numeric_limits<double>::infinity()
                                           : first + width * static_cast<double>(column);
    std::size_t lowest = count;
    std::size_t highest = count;
    std::size_t i = begin;
    for (; i < count && curve.times[i] < limit; ++i) {
      if (!std::isfinite(curve.values[i])) continue;
      if (lowest == count || curve.values[i] < curve.values[lowest]) lowest = i;
      if (highest == count || curve.values[i] > curve.values[highest]) highest = i;
    }
    if (lowest != count) {
      add(std::min(lowest, highest));
      if (lowest != highest) add(std::max(lowest, highest));
    } else if (i > begin) {
      reduced.times.push_back(curve.times[begin]);
      reduced.values.push_back(std::numeric_limits<double>::quiet_NaN());
    }
    begin = i;
  }
  return reduced;
}

ValueBand thinned(const ValueBand& band, std::size_t columns) {
  const std::size_t count = band.times.size();
  if (count <= columns) return band;
  ValueBand thin;
  const double first = band.times.front();
  const double width = (band.times.back() - first) / static_cast<double>(columns);
  for (std::size_t begin = 0, column = 1; begin < count; ++column) {
    const double limit = column >= columns ? std::numeric_limits<double>::infinity()
                                           : first + width * static_cast<double>(column);
    std::size_t end = begin;
    ValueRange range;
    for (; end < count && band.times[end] < limit; ++end) {
      range.include({&band.lower[end], 1});
      range.include({&band.upper[end], 1});
    }
    if (end > begin && !range.is_empty()) {
      thin.times.push_back(band.times[end - 1]);
      thin.lower.push_back(range.lower);
      thin.upper.push_back(range.upper);
    }
    begin = end;
  }
  return thin;
}

}  // namespace stridor
