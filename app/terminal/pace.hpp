// Progress of a computation and its remaining time.
#pragma once

#include <chrono>
#include <optional>
#include <string>
#include <vector>

namespace stridor {

using SteadyTime = std::chrono::steady_clock::time_point;

/// The part done of a computation over time. The rest is taken to go on at the recent speed, that
/// over the last third of the time so far: where later parts take longer, the time left follows
/// them, and while nothing is reported it grows.
class Pace {
 public:
  explicit Pace(SteadyTime start) : marks_{{start, 0.0}} {}

  /// @param fraction done, 0 to 1
  void report(double fraction, SteadyTime now);

  double fraction() const { return fraction_; }
  std::size_t num_marks() const { return marks_.size(); }
  /// Since the start, s.
  double elapsed(SteadyTime now) const;
  /// s; nothing while too little is done.
  std::optional<double> left(SteadyTime now) const;

 private:
  struct Mark {
    SteadyTime time;
    double fraction;
  };
  std::vector<Mark> marks_;  ///< the start, and reports at distances that grow with time
  double fraction_ = 0.0;
};

/// "12 s", "3 min 05 s", "2 h 10 min".
std::string duration_text(double seconds);

/// "42 %, 12 s left"; 100 % only where all is done. Unknown parts are omitted: without a part
/// done there is the time so far, "12 s so far".
std::string pace_text(const Pace& pace, SteadyTime now);

}  // namespace stridor
