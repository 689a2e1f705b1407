// Interpolation that makes no new extrema.
#pragma once

#include <cstddef>
#include <vector>

namespace stridor {

/// A value with its first two derivatives.
struct CurvePoint {
  double value = 0.0;
  double slope = 0.0;
  double curvature = 0.0;
};

/// Slopes of a monotone piecewise cubic at its knots (Fritsch and Carlson): zero where the data
/// turn, elsewhere the weighted harmonic mean of the neighbouring secants.
/// @param x strictly ascending, at least 2
/// @param y as many
std::vector<double> monotone_slopes(const std::vector<double>& x, const std::vector<double>& y);

/// Piecewise cubic through points, once differentiable, monotone wherever the points are.
class MonotoneCubic {
 public:
  /// @param x finite, strictly ascending, at least 2
  /// @param y finite, as many
  /// @throws std::invalid_argument if they are not
  MonotoneCubic(std::vector<double> x, std::vector<double> y);

  double first() const { return x_.front(); }
  double last() const { return x_.back(); }

  /// @param x within [first(), last()]; beyond them the outermost cubic continues
  CurvePoint at(double x) const;

 private:
  std::vector<double> x_;
  std::vector<double> y_;
  std::vector<double> slopes_;
};

}  // namespace stridor
