#include "analysis/harmonics.hpp"

#include <cmath>
#include <cstddef>
#include <optional>

namespace stridor {
namespace {

/// The multiple n ≥ 2 of the frequency of a louder burst at which one sounds.
/// @param tolerance Hz, of the mean frequency
std::optional<int> order_of(const Burst& one, const Burst& louder, double tolerance) {
  std::size_t shared = 0;
  double weights = 0.0, own = 0.0, other = 0.0;
  std::size_t j = 0;
  for (const BurstPoint& point : one.course) {
    // Courses have their points at the same moments.
    while (j < louder.course.size() && louder.course[j].time < point.time) ++j;
    if (j == louder.course.size()) break;
    if (louder.course[j].time != point.time) continue;
    ++shared;
    weights += point.level;
    own += point.level * point.frequency;
    other += point.level * louder.course[j].frequency;
  }
  if (shared < 3 || 2 * shared < one.course.size()) return std::nullopt;
  const double order = std::round(own / other);
  if (order < 2.0 || std::abs(own - order * other) > tolerance * weights) return std::nullopt;
  return static_cast<int>(order);
}

}  // namespace

void name_harmonics(std::span<Burst> bursts, double smoothing) {
  const double tolerance = 0.125 / smoothing;
  for (Burst& one : bursts) {
    one.harmonic.reset();
    for (std::size_t i = 0; i < bursts.size(); ++i) {
      if (bursts[i].peak <= one.peak) continue;
      const auto order = order_of(one, bursts[i], tolerance);
      if (order && (!one.harmonic || *order < one.harmonic->order)) one.harmonic = {i, *order};
    }
  }
}

}  // namespace stridor
