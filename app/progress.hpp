// Progress with time left, on stderr.
#pragma once

#include <chrono>
#include <string>

namespace stridor {

/// A bar on a terminal, a plain line now and then elsewhere.
class Progress {
 public:
  explicit Progress(std::string what);
  ~Progress();
  Progress(const Progress&) = delete;
  Progress& operator=(const Progress&) = delete;

  /// @param fraction done so far, 0 to 1
  /// @param detail   short text behind the bar, e.g. "t = 1.25 of 2.25 s"
  void report(double fraction, const std::string& detail);
  /// Removes the bar.
  void finish();

 private:
  using Clock = std::chrono::steady_clock;
  std::string what_;
  bool is_terminal_;
  bool is_drawn_ = false;
  Clock::time_point start_;
  Clock::time_point next_line_;
};

}  // namespace stridor
