// Values of given ranks among more than memory holds.
#pragma once

#include <cstddef>
#include <functional>
#include <span>
#include <vector>

namespace stridor {

/// Takes some values.
using TakeValues = std::function<void(std::span<const double>)>;
/// Passes all values on, in pieces, the same at every call.
using EachValue = std::function<void(const TakeValues&)>;

/// The values that would stand at given ranks if all were sorted, exactly.
///
/// Passes over the values narrow each rank down to an interval of numbers, by a histogram of their
/// bits, until the interval holds few enough to be kept: one pass where there are at most `room`
/// values, mostly two for 10⁸ of them, four at most.
///
/// @param each  passes the values: not negative, not NaN
/// @param count of them
/// @param ranks each below count
/// @param room  values to be kept at a time for a rank, positive
/// @return as many values as ranks
/// @throws std::invalid_argument if a rank is not below count
std::vector<double> order_statistics(const EachValue& each, std::size_t count,
                                     const std::vector<std::size_t>& ranks,
                                     std::size_t room = std::size_t{1} << 20);

}  // namespace stridor
