#include "analysis/interval_search.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <limits>
#include <optional>
#include <set>
#include <utility>

#include "analysis/pair_model.hpp"
#include "analysis/sample_chains.hpp"
#include "core/activity.hpp"

namespace stridor {
namespace {

using Complex = std::complex<double>;

constexpr double unbounded = std::numeric_limits<double>::infinity();
constexpr double tie = 1e-7;  ///< of the largest |s|: eigenvalues closer than this are one

/// One pass over the intervals between samples that are connected.
class Pass {
 public:
  Pass(const SpectrumSampler& sampler, const std::vector<Sample>& whole,
       std::vector<Sample>& between, SearchFor wanted)
      : sampler_(sampler), whole_(whole), between_(between), wanted_(wanted), chains_(whole) {}

  Outcome search(std::size_t i);

 private:
  bool is_in(std::size_t i, std::size_t b) const {
    return chains_.index(i, b) >= 0 && chains_.index(i + 1, b) >= 0;
  }
  bool is_trusted(std::size_t i, std::size_t b) const {
    return std::isfinite(chains_.excess(i, b)) || std::isfinite(chains_.excess(i + 1, b));
  }
  /// s₁ − s₂ of two chains, or of one and its conjugate where they are the same.
  Complex difference(std::size_t i, std::size_t b, std::size_t c) const {
    if (b == c) return {0.0, 2.0 * chains_.s(i, b).imag()};
    return chains_.s(i, b) - chains_.s(i, c);
  }
  bool has_both(std::ptrdiff_t i, std::size_t b, std::size_t c) const {
    return chains_.has(i, b) && chains_.has(i, c);
  }

  double scale_of(std::size_t i) const;
  bool may_meet(std::size_t i, std::size_t b, std::size_t c) const;
  bool passes_by(std::size_t i, std::size_t b, std::size_t c) const;
  std::optional<PairLook> look_of(std::ptrdiff_t i, std::size_t b, std::size_t c) const;
  std::vector<PairLook> looks_around(std::size_t i, std::size_t b, std::size_t c,
                                     std::ptrdiff_t reach) const;
  Outcome approach(std::size_t i, std::size_t b, std::size_t c);
  std::optional<double> slope(std::ptrdiff_t interval, std::size_t b) const;
  std::optional<double> tip_of(std::size_t i, std::size_t b, double sign) const;
  Outcome climb(std::size_t i, std::size_t b, double sign);
  bool grows_throughout(std::size_t i, std::size_t b) const;
  bool needs_search(std::size_t i) const;
  void keep(Sample sample, bool is_growing);

  const SpectrumSampler& sampler_;
  const std::vector<Sample>& whole_;
  std::vector<Sample>& between_;
  SearchFor wanted_;
  SampleChains chains_;
};

double Pass::scale_of(std::size_t i) const {
  double largest = 0.0;
  for (const Complex& s : whole_[i].eigenvalues) largest = std::max(largest, std::abs(s));
  return largest;
}

/// Whether the distance of a pair may vanish between two samples.
bool Pass::may_meet(std::size_t i, std::size_t b, std::size_t c) const {
  constexpr double safety = 1.5;
  const double at_left = std::abs(difference(i, b, c));
  const double at_right = std::abs(difference(i + 1, b, c));
  if (b == c && !(at_left > 0.0 && at_right > 0.0)) return false;
  double fastest = 0.0;
  const auto first = static_cast<std::ptrdiff_t>(i) - 1;
  for (std::ptrdiff_t k = first; k <= first + 2; ++k) {
    if (!has_both(k, b, c) || !has_both(k + 1, b, c)) continue;
    const auto at = static_cast<std::size_t>(k);
    const double change = std::abs(difference(at + 1, b, c) - difference(at, b, c));
    fastest = std::max(fastest, change / chains_.width(at));
  }
  return at_left + at_right <= safety * fastest * chains_.width(i);
}

/// Whether the distance of a pair grows or falls throughout the neighbourhood of an interval.
bool Pass::passes_by(std::size_t i, std::size_t b, std::size_t c) const {
  const auto first = static_cast<std::ptrdiff_t>(i) - 1;
  if (!has_both(first, b, c) || !has_both(first + 3, b, c)) return false;
  std::array<double, 4> distance{};
  for (std::size_t k = 0; k < 4; ++k) distance[k] = std::abs(difference(i - 1 + k, b, c));
  return std::is_sorted(distance.begin(), distance.end()) ||
         std::is_sorted(distance.begin(), distance.end(), std::greater<>());
}

std::optional<PairLook> Pass::look_of(std::ptrdiff_t i, std::size_t b, std::size_t c) const {
  if (i < 0 || !has_both(i, b, c)) return std::nullopt;
  const auto at = static_cast<std::size_t>(i);
  const double value = whole_[at].value;
  if (b != c) return PairLook::of(value, chains_.s(at, b), chains_.s(at, c));
  const Complex s = chains_.s(at, b);
  if (s.imag() == 0.0) return std::nullopt;
  return PairLook::of(value, s, std::conj(s));
}

/// Both ends, and the samples beside them.
/// @param reach how many on either side
std::vector<PairLook> Pass::looks_around(std::size_t i, std::size_t b, std::size_t c,
                                         std::ptrdiff_t reach) const {
  std::vector<PairLook> looks;
  const auto here = static_cast<std::ptrdiff_t>(i);
  for (std::ptrdiff_t k = here - reach; k <= here + 1 + reach; ++k)
    if (const auto look = look_of(k, b, c)) looks.push_back(*look);
  return looks;
}

/// A sample between; where only a few eigenvalues were computed, all that grow, or all.
void Pass::keep(Sample sample, bool is_growing) {
  if (sampler_.has_parts())
    sample = is_growing ? sampler_.near(sample.value) : sampler_.at(sample.value);
  between_.push_back(std::move(sample));
}

/// Solves for the closest approach of a pair.
Outcome Pass::approach(std::size_t i, std::size_t b, std::size_t c) {
  constexpr int most_looks = 12;
  const auto grows_at = [&](std::size_t at) {
    return chains_.excess(at, b) > 0.0 || chains_.excess(at, c) > 0.0;
  };
  // A change of stability that the ends show is solved for elsewhere.
  if (grows_at(i) != grows_at(i + 1)) return Outcome::resolved;
  const bool is_growing = grows_at(i);
  const double from = whole_[i].value;
  const double to = whole_[i + 1].value;
  if (!is_growing && growth_bound(looks_around(i, b, c, 2), from, to) < 0.0)
    return Outcome::resolved;
  PairSearch search(looks_around(i, b, c, 1), from, to, scale_of(i),
                    is_growing ? PairSearch::Aim::gap : PairSearch::Aim::growth);
  for (int k = 0; k < most_looks; ++k) {
    const std::optional<double> next = search.next();
    if (!next) return search.fits_ends() ? Outcome::resolved : Outcome::halve;
    const PairLook expected = search.expected(*next);
    Sample sample = sampler_.around(*next, expected.mean);
    const auto pair = closest_pair(sample.eigenvalues, expected);
    if (!pair) return Outcome::halve;
    const bool grows = sample.is_growing(pair->first) || sample.is_growing(pair->second);
    search.add(pair->look);
    if (grows != is_growing) {
      keep(std::move(sample), grows);
      return Outcome::resolved;
    }
    if (!sampler_.has_parts()) between_.push_back(std::move(sample));
  }
  return Outcome::halve;
}

/// Of the excess of a chain over an interval.
std::optional<double> Pass::slope(std::ptrdiff_t interval, std::size_t b) const {
  if (!chains_.has(interval, b) || !chains_.has(interval + 1, b)) return std::nullopt;
  const auto at = static_cast<std::size_t>(interval);
  return (chains_.excess(at + 1, b) - chains_.excess(at, b)) / chains_.width(at);
}

/// Intersection of the tangents of the excess at both ends, if it is on the other side of zero.
/// @param sign +1 for a maximum, −1 for a minimum
std::optional<double> Pass::tip_of(std::size_t i, std::size_t b, double sign) const {
  const auto here = static_cast<std::ptrdiff_t>(i);
  const double chord = *slope(here, b);
  const std::optional<double> before = slope(here - 1, b);
  const std::optional<double> after = slope(here + 1, b);
  if (!before && !after) return std::nullopt;
  // At an end of the range the slope goes on changing as it does beside it.
  const double left = before ? *before : 2.0 * chord - *after;
  const double right = after ? *after : 2.0 * chord - *before;
  if (!(sign * left > 0.0 && sign * right < 0.0)) return std::nullopt;
  const double at_left = chains_.excess(i, b);
  const double along =
      (chains_.excess(i + 1, b) - at_left - right * chains_.width(i)) / (left - right);
  if (!(along > 0.0 && along < chains_.width(i))) return std::nullopt;
  if (!(sign * (at_left + left * along) > 0.0)) return std::nullopt;
  return whole_[i].value + along;
}

/// Climbs to a maximum of the growth of one eigenvalue, or down to a minimum.
Outcome Pass::climb(std::size_t i, std::size_t b, double sign) {
  constexpr int most_looks = 12;
  const std::optional<double> tip = tip_of(i, b, sign);
  if (!tip) return Outcome::resolved;
  struct Point {
    double value;
    Complex s;
    double excess;
  };
  std::array<Point, 3> points;  // the best in the middle
  const auto point_of = [&](std::size_t at) {
    return Point{whole_[at].value, chains_.s(at, b), chains_.excess(at, b)};
  };
  points[0] = point_of(i);
  points[2] = point_of(i + 1);
  double next = *tip;
  bool has_middle = false;
  for (int k = 0; k < most_looks; ++k) {
    const double share = (next - points[0].value) / (points[2].value - points[0].value);
    const Complex guess = (1.0 - share) * points[0].s + share * points[2].s;
    Sample sample = sampler_.around(next, guess);
    const int found = continuations({guess}, sample.eigenvalues)[0];
    if (found < 0) return Outcome::halve;
    const auto at = static_cast<std::size_t>(found);
    const Point point{next, sample.eigenvalues[at], sample.excess[at]};
    if (sample.is_growing(at) == (sign > 0.0)) {
      keep(std::move(sample), sign > 0.0);
      return Outcome::resolved;
    }
    if (!has_middle || sign * point.excess > sign * points[1].excess) {
      if (has_middle) points[next < points[1].value ? 2 : 0] = points[1];
      points[1] = point;
    } else {
      points[next < points[1].value ? 0 : 2] = point;
    }
    has_middle = true;
    const double left = (points[1].excess - points[0].excess) / (points[1].value - points[0].value);
    const double right =
        (points[2].excess - points[1].excess) / (points[2].value - points[1].value);
    const double curvature = (right - left) / (points[2].value - points[0].value);
    if (!(sign * curvature < 0.0)) return Outcome::halve;
    next = 0.5 * (points[0].value + points[1].value) - 0.5 * left / curvature;
    const double offset = next - points[1].value;
    // Four times the contribution of a parabola does not reach zero.
    const double rise = std::abs(curvature) * offset * offset;
    if (4.0 * rise < std::abs(points[1].excess)) return Outcome::resolved;
    const double smallest = 1e-12 * (points[2].value - points[0].value);
    if (std::abs(offset) <= smallest) return Outcome::resolved;
  }
  return Outcome::halve;
}

/// Whether an eigenvalue grows all over an interval: at both ends, with no minimum below zero and
/// no other near enough to change that.
bool Pass::grows_throughout(std::size_t i, std::size_t b) const {
  if (!(chains_.excess(i, b) > 0.0 && chains_.excess(i + 1, b) > 0.0)) return false;
  const auto here = static_cast<std::ptrdiff_t>(i);
  const bool has_slope = slope(here - 1, b) || slope(here + 1, b);
  if (!has_slope || tip_of(i, b, -1.0)) return false;
  for (std::size_t c = 0; c < chains_.size(); ++c)
    if (is_in(i, c) && may_meet(i, b, c) && !passes_by(i, b, c)) return false;
  return true;
}

bool Pass::needs_search(std::size_t i) const {
  if (wanted_ == SearchFor::every_window) return true;
  for (std::size_t b = 0; b < chains_.size(); ++b)
    if (is_in(i, b) && grows_throughout(i, b)) return false;
  return true;
}

Outcome Pass::search(std::size_t i) {
  if (!needs_search(i)) return Outcome::resolved;
  std::vector<std::size_t> present;
  for (std::size_t b = 0; b < chains_.size(); ++b)
    if (is_in(i, b)) present.push_back(b);
  const double smallest = tie * std::max(scale_of(i), scale_of(i + 1));
  Outcome outcome = Outcome::resolved;
  for (std::size_t k = 0; k < present.size(); ++k) {
    const std::size_t b = present[k];
    double nearest = unbounded;  // of those that it cannot meet
    for (std::size_t l = 0; l < present.size(); ++l) {
      const std::size_t c = present[l];
      const double at_left = std::abs(difference(i, b, c));
      const double at_right = std::abs(difference(i + 1, b, c));
      if (std::max(at_left, at_right) <= smallest) continue;
      // Real at one end: its pair has met its conjugate, which the ends show.
      if (b == c && std::min(at_left, at_right) == 0.0) continue;
      if (!may_meet(i, b, c)) {
        nearest = std::min({nearest, at_left, at_right});
      } else if (l <= k && is_trusted(i, b) && is_trusted(i, c) && !passes_by(i, b, c)) {
        if (approach(i, b, c) == Outcome::halve) outcome = Outcome::halve;
      }
    }
    const double error = std::abs(chains_.s(i + 1, b) - chains_.expected(i, b));
    const bool has_slope = chains_.has(static_cast<std::ptrdiff_t>(i) - 1, b);
    if (has_slope && error > std::max(0.5 * nearest, smallest)) outcome = Outcome::halve;
    const double left = chains_.excess(i, b);
    const double right = chains_.excess(i + 1, b);
    const double real = tie * std::abs(chains_.s(i, b));
    if (!std::isfinite(left) || !std::isfinite(right)) continue;
    const bool is_damped = left < 0.0 && right < 0.0;
    const bool is_change = (left < 0.0) != (right < 0.0);
    // Without damping the real parts are rounding.
    if (is_change || std::max(std::abs(left), std::abs(right)) < real) continue;
    if (climb(i, b, is_damped ? 1.0 : -1.0) == Outcome::halve) outcome = Outcome::halve;
  }
  return outcome;
}

}  // namespace

IntervalSearch search_intervals(const SpectrumSampler& sampler, std::vector<Sample>& whole,
                                int most_values, SearchFor wanted) {
  constexpr int most_passes = 8;
  IntervalSearch result;
  std::set<std::pair<double, double>> resolved;
  for (int pass = 0; whole.size() > 1; ++pass) {
    std::vector<double> values;
    Pass one(sampler, whole, result.between, wanted);
    for (std::size_t i = 0; i + 1 < whole.size(); ++i) {
      const std::pair ends(whole[i].value, whole[i + 1].value);
      if (resolved.contains(ends)) continue;
      const Activity refining(fmt::format("interval {} of {}", i + 1, whole.size() - 1));
      if (one.search(i) == Outcome::resolved) {
        resolved.insert(ends);
        continue;
      }
      values.push_back(0.5 * (ends.first + ends.second));
      result.unresolved = std::max(result.unresolved, ends.second - ends.first);
    }
    if (values.empty() || pass == most_passes || static_cast<int>(values.size()) > most_values)
      break;
    most_values -= static_cast<int>(values.size());
    result.unresolved = 0.0;
    for (std::size_t k = 0; k < values.size(); ++k) {
      const Activity halving(fmt::format("halved interval {} of {}", k + 1, values.size()));
      whole.push_back(sampler.at(values[k]));
    }
    std::sort(whole.begin(), whole.end(),
              [](const Sample& a, const Sample& b) { return a.value < b.value; });
  }
  return result;
}

}  // namespace stridor
