#include "analysis/response_peaks.hpp"

#include <algorithm>
#include <limits>

namespace stridor {
namespace {

/// The lowest level from a peak on until it is exceeded, or the end comes.
double foot_of(std::span<const double> level, std::size_t peak, int direction) {
  double lowest = level[peak];
  for (auto i = static_cast<std::ptrdiff_t>(peak) + direction;
       i >= 0 && i < static_cast<std::ptrdiff_t>(level.size()); i += direction) {
    const double there = level[static_cast<std::size_t>(i)];
    if (there > level[peak]) break;
    lowest = std::min(lowest, there);
  }
  return lowest;
}

}  // namespace

std::vector<std::size_t> response_peaks(std::span<const double> level, double prominence,
                                        std::size_t most) {
  struct Peak {
    std::size_t at;
    double rise;  ///< over the higher of the feet on both sides
  };
  std::vector<Peak> peaks;
  for (std::size_t i = 1; i + 1 < level.size(); ++i) {
    if (!(level[i] > level[i - 1] && level[i] >= level[i + 1])) continue;
    const double foot = std::max(foot_of(level, i, -1), foot_of(level, i, 1));
    const double rise = foot > 0.0 ? level[i] / foot : std::numeric_limits<double>::infinity();
    if (rise >= prominence) peaks.push_back({i, rise});
  }
  if (peaks.size() > most) {
    std::stable_sort(peaks.begin(), peaks.end(),
                     [](const Peak& a, const Peak& b) { return a.rise > b.rise; });
    peaks.resize(most);
  }
  std::vector<std::size_t> kept;
  for (const Peak& peak : peaks) kept.push_back(peak.at);
  std::sort(kept.begin(), kept.end());
  return kept;
}

}  // namespace stridor
