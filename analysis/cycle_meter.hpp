// Amplitude and period of a motion, from its turns.
#pragma once

#include <deque>
#include <limits>
#include <optional>
#include <string>

#include "core/state.hpp"

namespace stridor {

/// Reads amplitude and period from the whole cycles in a window of time, in any units.
class CycleMeter {
 public:
  /// Quantities gathered up to a turn, where x is largest.
  struct Turn {
    double time = 0.0;
    double x = 0.0;
    double sum = 0.0;      ///< ∫ x dt
    double squares = 0.0;  ///< ∫ x² dt
    double stick = 0.0;    ///< time
    double free = 0.0;     ///< time
  };

  /// Statistics of the window; none where no cycle is whole.
  struct Reading {
    double smallest = 0.0;  ///< x; infinite where no position has been noted
    double largest = 0.0;
    double deepest = 0.0;          ///< largest y
    std::optional<double> period;  ///< nothing also where the motion does not repeat itself
    std::optional<double> mean;
    std::optional<double> rms;  ///< about the mean
    std::optional<double> stick_fraction;
    std::optional<double> free_fraction;
  };

  /// @param from, to of the window
  CycleMeter(double from, double to) : from_(from), to_(to) {}

  void note_turn(const Turn& turn);
  void note_position(double time, double x, double y);
  Reading reading() const;

  void save(State& state, const std::string& prefix) const;
  /// @throws std::invalid_argument if the state is of something else
  void load(const State& state, const std::string& prefix);

 private:
  std::size_t repeats_after() const;

  double from_;
  double to_;
  std::size_t num_turns_ = 0;
  std::deque<Turn> turns_;  ///< the first, and as many of the last as are compared
  double smallest_ = std::numeric_limits<double>::infinity();
  double largest_ = -std::numeric_limits<double>::infinity();
  double deepest_ = -std::numeric_limits<double>::infinity();
};

}  // namespace stridor
