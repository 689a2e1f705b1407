// A quantity prescribed over time: drive velocity, load, friction coefficient.
#pragma once

#include <vector>

namespace stridor {

/// Support points of a curve: strictly increasing times (s) and the values there.
struct TimeTable {
  std::vector<double> times;
  std::vector<double> values;
  bool operator==(const TimeTable&) const = default;
};

/// A twice continuously differentiable curve through a table, constant before and after it.
///
/// Between two support points the value follows the quintic smoothstep
///   r(x) = x³ (10 − 15 x + 6 x²),  x = (t − t_i)/(t_{i+1} − t_i),
/// so that slope and curvature vanish at every support point (docs/theory.md, 1.1).
/// Outside the table the value is that of the nearest support point.
class TimeCurve {
 public:
  /// Zero at all times.
  TimeCurve() : TimeCurve(0.0) {}

  /// A constant.
  explicit TimeCurve(double value) : table_{{0.0}, {value}}, integrals_{0.0} {}

  /// @throws std::invalid_argument if the table is empty, its sizes differ, a number is not finite
  ///         or the times do not increase strictly.
  explicit TimeCurve(TimeTable table);

  /// From 0 to `value` over the first `duration` seconds; a constant where duration is 0.
  static TimeCurve ramp(double value, double duration);

  double value(double time) const;
  double slope(double time) const;
  /// ∫ value dt from 0 to time.
  double integral(double time) const;

  bool is_constant() const { return table_.times.size() == 1; }
  /// Whether it is 0 at all times.
  bool is_zero() const;
  /// From this time on the value no longer changes.
  double constant_from() const { return table_.times.back(); }
  const TimeTable& table() const { return table_; }

 private:
  std::size_t interval(double time) const;
  /// ∫ value dt from the first support point to `time`.
  double integral_from_first(double time) const;

  TimeTable table_;
  std::vector<double> integrals_;  ///< from the first support point to every support point
};

}  // namespace stridor
