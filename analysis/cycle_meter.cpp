#include "analysis/cycle_meter.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

namespace stridor {
namespace {

/// After so many turns a motion may repeat itself.
constexpr std::size_t most_loops = 12;

}  // namespace

void CycleMeter::note_turn(const Turn& turn) {
  if (turn.time < from_ || turn.time > to_) return;
  ++num_turns_;
  turns_.push_back(turn);
  if (turns_.size() > 2 * most_loops + 1) turns_.erase(turns_.begin() + 1);
}

void CycleMeter::note_position(double time, double x, double y) {
  if (time < from_ || time > to_) return;
  smallest_ = std::min(smallest_, x);
  largest_ = std::max(largest_, x);
  deepest_ = std::max(deepest_, y);
}

CycleMeter::Reading CycleMeter::reading() const {
  Reading found;
  found.smallest = smallest_;
  found.largest = largest_;
  found.deepest = deepest_;
  if (num_turns_ < 3) return found;
  const Turn& first = turns_.front();
  const Turn& last = turns_.back();
  const double duration = last.time - first.time;
  const double mean = (last.sum - first.sum) / duration;
  const double square = (last.squares - first.squares) / duration - mean * mean;
  found.mean = mean;
  found.rms = std::sqrt(std::max(0.0, square));
  const double turn_time = duration / static_cast<double>(num_turns_ - 1);
  if (const std::size_t loops = repeats_after(); loops > 0)
    found.period = static_cast<double>(loops) * turn_time;
  found.stick_fraction = (last.stick - first.stick) / duration;
  found.free_fraction = (last.free - first.free) / duration;
  return found;
}

/// Turns after which the motion repeats itself to 1 % of its width; 0 where it does not.
std::size_t CycleMeter::repeats_after() const {
  for (std::size_t loops = 1; loops <= std::min(most_loops, num_turns_ / 2); ++loops) {
    double apart = 0.0;
    for (std::size_t i = turns_.size() - loops; i < turns_.size(); ++i)
      apart = std::max(apart, std::abs(turns_[i].x - turns_[i - loops].x));
    if (apart <= 1e-2 * (largest_ - smallest_)) return loops;
  }
  return 0;
}

void CycleMeter::save(State& state, const std::string& prefix) const {
  state.put(prefix + "extremes", std::array{smallest_, largest_, deepest_});
  state.put(prefix + "num_turns", static_cast<double>(num_turns_));
  std::vector<double> values;
  for (const Turn& turn : turns_)
    values.insert(values.end(), {turn.time, turn.x, turn.sum, turn.squares, turn.stick, turn.free});
  state.put(prefix + "turns", values);
}

void CycleMeter::load(const State& state, const std::string& prefix) {
  std::array<double, 3> extremes{};
  state.get(prefix + "extremes", extremes);
  smallest_ = extremes[0];
  largest_ = extremes[1];
  deepest_ = extremes[2];
  num_turns_ = static_cast<std::size_t>(state.get(prefix + "num_turns"));
  turns_.clear();
  const std::vector<double>& v = state.array(prefix + "turns");
  for (std::size_t i = 0; i + 6 <= v.size(); i += 6)
    turns_.push_back({v[i], v[i + 1], v[i + 2], v[i + 3], v[i + 4], v[i + 5]});
}

}  // namespace stridor
