#include "app/terminal/pace.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace stridor {
namespace {

double seconds_between(SteadyTime from, SteadyTime to) {
  return std::chrono::duration<double>(to - from).count();
}

}  // namespace

void Pace::report(double fraction, SteadyTime now) {
  fraction_ = std::max(fraction_, std::clamp(fraction, 0.0, 1.0));
  constexpr double least_distance = 0.02;  // of the time so far
  if (seconds_between(marks_.back().time, now) >= least_distance * elapsed(now))
    marks_.push_back({now, fraction_});
}

double Pace::elapsed(SteadyTime now) const {
  return seconds_between(marks_.front().time, now);
}

std::optional<double> Pace::left(SteadyTime now) const {
  if (fraction_ >= 1.0) return 0.0;
  constexpr double least_time = 1.0;  // s
  const double so_far = elapsed(now);
  if (so_far < least_time) return std::nullopt;
  if (!(fraction_ > 0.0)) return std::nullopt;
  // The latest mark before the last third after which something was done.
  const Mark* since = &marks_.front();
  for (const Mark& mark : marks_) {
    if (seconds_between(mark.time, now) < so_far / 3.0 || mark.fraction >= fraction_) break;
    since = &mark;
  }
  return (1.0 - fraction_) / (fraction_ - since->fraction) * seconds_between(since->time, now);
}

std::string duration_text(double seconds) {
  const double whole = std::round(seconds);
  if (whole < 60.0) return fmt::format("{:.0f} s", whole);
  if (whole < 3600.0)
    return fmt::format("{:.0f} min {:02.0f} s", std::floor(whole / 60.0), std::fmod(whole, 60.0));
  const double minutes = std::round(seconds / 60.0);
  return fmt::format("{:.0f} h {:02.0f} min", std::floor(minutes / 60.0), std::fmod(minutes, 60.0));
}

std::string pace_text(const Pace& pace, SteadyTime now) {
  if (!(pace.fraction() > 0.0)) return duration_text(pace.elapsed(now)) + " so far";
  std::string text = fmt::format("{:.0f} %", std::floor(100.0 * pace.fraction()));
  if (const auto left = pace.left(now)) text += ", " + duration_text(*left) + " left";
  return text;
}

}  // namespace stridor
