// Progress with time left, on stderr.
#pragma once

#include <optional>
#include <string>

#include "app/terminal/pace.hpp"

namespace stridor {

/// A bar on a terminal, a plain line now and then elsewhere.
///
/// A thread of its own updates the display, so that it also moves while a library computes. Of
/// several the newest is shown; where it has not been told anything, the current phase of the main
/// thread (core/activity.hpp) is shown in its place, if there is one.
class Progress {
 public:
  explicit Progress(std::string what);
  ~Progress();
  Progress(const Progress&) = delete;
  Progress& operator=(const Progress&) = delete;

  /// The next phase begins: work done before does not count, and the time left is of this
  /// phase.
  void begin(std::string phase);
  /// @param fraction done of the phase, 0 to 1
  /// @param detail   short text behind the bar, e.g. "t = 1.25 of 2.25 s"
  void report(double fraction, const std::string& detail);
  /// The same where the remaining work is unknown.
  void report(const std::string& detail);
  /// Removes the bar.
  void finish();

  /// From now on progress is told as JSON, a line each on stderr, four times a second:
  ///
  ///     {"phase": "run", "text": "t = 1.25 of 2.25 s", "fraction": 0.55, "seconds_left": 0.8}
  ///
  /// The last two are null where they are not known; the last line of a phase has the fraction 1 where
  /// it was finished.
  static void tell_as_json();

  /// Text of a plain line from the reports so far.
  std::string text(SteadyTime now) const;

 private:
  friend class ProgressDisplay;

  std::string json_line(const Pace& pace, const std::string& detail, SteadyTime now) const;
  std::string line(const Pace& pace, const std::string& detail, const std::string& bar,
                   SteadyTime now) const;

  std::string what_;
  std::string phase_;
  std::string detail_;
  std::optional<Pace> pace_;  ///< once something has been reported
  SteadyTime start_ = std::chrono::steady_clock::now();
  bool is_open_ = true;
};

}  // namespace stridor
