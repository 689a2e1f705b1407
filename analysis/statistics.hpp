// Numbers read off a piece of a signal.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <span>
#include <stdexcept>

namespace stridor {

/// Root mean square √(Σ xᵢ²/n). @throws std::invalid_argument if there are no samples
inline double rms(std::span<const double> samples) {
  if (samples.empty()) throw std::invalid_argument("rms: no samples");
  double sum = 0.0;
  for (const double x : samples) sum += x * x;
  return std::sqrt(sum / static_cast<double>(samples.size()));
}

/// Largest absolute value; NaN if any sample is NaN. @throws std::invalid_argument if there are no
/// samples
inline double peak(std::span<const double> samples) {
  if (samples.empty()) throw std::invalid_argument("peak: no samples");
  double largest = 0.0;
  for (const double x : samples) {
    if (std::isnan(x)) return x;
    largest = std::max(largest, std::abs(x));
  }
  return largest;
}

/// A piece of time, both ends included, in s.
struct Window {
  double from = -std::numeric_limits<double>::infinity();
  double to = std::numeric_limits<double>::infinity();
};

/// Samples begin, …, end − 1.
struct IndexRange {
  std::size_t begin = 0;
  std::size_t end = 0;

  bool is_empty() const { return begin == end; }
  std::size_t size() const { return end - begin; }
  /// The part of a series that the range names.
  std::span<const double> of(std::span<const double> series) const {
    return series.subspan(begin, size());
  }
};

/// The samples of a uniform series that lie in a window.
///
/// Sample i is at first + i·interval. An end of the window that falls onto a sample but for
/// rounding (10⁻⁶ of the interval) includes it.
///
/// @param window   from ≤ to; may lie outside the series
/// @param first    time of sample 0 in s
/// @param interval s, positive
/// @param count    number of samples
/// @return an empty range if no sample lies in the window
/// @throws std::invalid_argument if interval is not positive and finite, or not from ≤ to
inline IndexRange samples_in(Window window, double first, double interval, std::size_t count) {
  if (!(interval > 0.0) || !std::isfinite(interval) || !std::isfinite(first)) {
    throw std::invalid_argument("samples_in: the interval must be positive and finite");
  }
  if (!(window.from <= window.to))
    throw std::invalid_argument("samples_in: the window ends before it starts");
  constexpr double rounding = 1e-6;
  const auto last = static_cast<double>(count);
  const double begin = std::ceil((window.from - first) / interval - rounding);
  const double end = std::floor((window.to - first) / interval + rounding) + 1.0;
  const IndexRange range{static_cast<std::size_t>(std::clamp(begin, 0.0, last)),
                         static_cast<std::size_t>(std::clamp(end, 0.0, last))};
  return range.begin < range.end ? range : IndexRange{range.begin, range.begin};
}

}  // namespace stridor
