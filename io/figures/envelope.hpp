// Curves and bands over time, and what of them a picture can show.
#pragma once

#include <cstddef>
#include <string>
#include <vector>

namespace stridor {

/// A line in a panel. Values that are not finite leave a gap.
struct Curve {
  std::vector<double> times;   ///< s, ascending
  std::vector<double> values;  ///< as many as times
  std::string name;            ///< in the key; no key where all names of a panel are empty
};

/// Range of the values between two points of a curve; drawn behind the curves.
struct ValueBand {
  std::vector<double> times;  ///< s, ascending; the band reaches from the time before to each
  std::vector<double> lower;
  std::vector<double> upper;
};

/// @throws std::invalid_argument if times and values differ in length or times do not ascend
void check_curve(const Curve& curve);
/// @throws std::invalid_argument if times and edges differ in length
void check_band(const ValueBand& band);

/// Points to draw instead of a long series so that the picture looks the same.
///
/// Time is cut into `num_columns` equal parts; each gives its smallest and its largest value at
/// their own times. A series of at most 2·num_columns points is returned as it is. Parts in which
/// nothing is finite give one NaN, a gap.
///
/// @throws std::invalid_argument if times and values differ in length, times do not ascend or
///         num_columns is 0
Curve envelope(const Curve& curve, std::size_t num_columns);

/// The largest and smallest values of a band in each of `columns` equal parts of its time.
ValueBand thinned(const ValueBand& band, std::size_t columns);

}  // namespace stridor
