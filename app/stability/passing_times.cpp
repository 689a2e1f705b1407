#include "app/stability/passing_times.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "core/activity.hpp"

namespace stridor {
namespace {

constexpr double not_passed = std::numeric_limits<double>::quiet_NaN();

template <class Function>
double bisected(const Function& function, double low, double high) {
  const bool rises = function(low) < 0.0;
  while (true) {
    const double middle = 0.5 * (low + high);
    if (middle <= low || middle >= high) return middle;
    ((function(middle) < 0.0) == rises ? low : high) = middle;
  }
}

/// ∫ Re s dt over the part of a window that the run passes, by the samples of its branch.
double gain_between(const Branch& branch, double from, double to, const PassingTimes& times) {
  const auto growth_at = [&](double value) {
    const auto upper = std::upper_bound(branch.values.begin(), branch.values.end(), value);
    const auto i = static_cast<std::size_t>(std::clamp<std::ptrdiff_t>(
        upper - branch.values.begin(), 1, std::ssize(branch.values) - 1));
    const double share = (value - branch.values[i - 1]) / (branch.values[i] - branch.values[i - 1]);
    return std::lerp(branch.s[i - 1].real(), branch.s[i].real(), share);
  };
  constexpr int num_parts = 64;
  double gain = 0.0;
  double before = times.at(from);
  for (int i = 0; i < num_parts; ++i) {
    const double after = times.at(std::lerp(from, to, (i + 1.0) / num_parts));
    gain += growth_at(std::lerp(from, to, (i + 0.5) / num_parts)) * std::abs(after - before);
    before = after;
  }
  return gain;
}

/// Times of a window in the run of the scene, and the growth in it: it may start or end inside.
TimedWindow timed(const Locus& locus, const UnstableWindow& window, const PassingTimes& times) {
  TimedWindow one{window, not_passed, not_passed, not_passed};
  const auto is_passed = [&](double value) { return std::isfinite(times.at(value)); };
  double from = window.from;
  double to = window.to;
  if (!is_passed(from) || !is_passed(to)) {
    constexpr int num_places = 32;
    std::optional<double> inside;
    for (int i = 0; i <= num_places && !inside; ++i) {
      const double value = std::lerp(from, to, static_cast<double>(i) / num_places);
      if (is_passed(value)) inside = value;
    }
    if (!inside) return one;
    // The last value on the way from `inside` to an end that is passed.
    const auto last_passed = [&](double end) {
      if (is_passed(end)) return end;
      double passed = *inside;
      constexpr int num_halvings = 40;
      for (int i = 0; i < num_halvings; ++i) {
        const double middle = 0.5 * (passed + end);
        (is_passed(middle) ? passed : end) = middle;
      }
      return passed;
    };
    from = last_passed(from);
    to = last_passed(to);
  }
  if (!(from < to)) return one;
  const double at_from = times.at(from);
  const double at_to = times.at(to);
  one.from_time = std::min(at_from, at_to);
  one.to_time = std::max(at_from, at_to);
  const bool is_whole = from == window.from && to == window.to;
  if (is_whole) {  // at nearly constant speed
    one.gain = window.growth_integral * (one.to_time - one.from_time) / (to - from);
  } else if (window.branch >= 0 && window.branch < std::ssize(locus.branches)) {
    const Branch& branch = locus.branches[static_cast<std::size_t>(window.branch)];
    if (branch.values.size() > 1) one.gain = gain_between(branch, from, to, times);
  }
  return one;
}

}  // namespace

double PassingTimes::at(double place) const {
  const SlidingState state = family_->at(std::array{place});
  if (!state.is_on_the_way) return not_passed;
  const double wanted = state.equilibrium.state.drive_displacement;
  const auto missing = [&](double time) { return state.leading_drive.displacement(time) - wanted; };
  if (missing(0.0) == 0.0) return 0.0;
  constexpr int num_steps = 1000;
  double before = 0.0;
  for (int i = 1; i <= num_steps; ++i) {
    const double after = end_ * i / num_steps;
    if (missing(before) * missing(after) <= 0.0) return bisected(missing, before, after);
    before = after;
  }
  return not_passed;
}

std::vector<TimedWindow> timed_windows(const Locus& locus,
                                       const std::optional<PassingTimes>& times) {
  const Activity timing("times at which the run passes the windows");
  std::vector<TimedWindow> all;
  for (const UnstableWindow& window : locus.unstable)
    all.push_back(times ? timed(locus, window, *times)
                        : TimedWindow{window, not_passed, not_passed, not_passed});
  return all;
}

}  // namespace stridor
