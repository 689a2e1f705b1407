// Numbers that many tests name.
#pragma once

#include <limits>
#include <numbers>

namespace stridor::test {

inline constexpr double eps = std::numeric_limits<double>::epsilon();
inline constexpr double infinity = std::numeric_limits<double>::infinity();
inline constexpr double not_a_number = std::numeric_limits<double>::quiet_NaN();
inline constexpr double two_pi = 2.0 * std::numbers::pi;

}  // namespace stridor::test
