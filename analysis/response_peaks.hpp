// Peaks of responses over frequency that stand out.
#pragma once

#include <cstddef>
#include <span>
#include <vector>

namespace stridor {

/// Indices at which a level over frequencies has a peak that stands out: inside, higher than its
/// neighbours (the first of equal ones), and `prominence` times as high as what the level falls to
/// on either side before a higher value, or the end, comes.
/// @param level      not negative
/// @param prominence above 1
/// @param most       so many are kept, those that stand out most
/// @return ascending; of n values and p peaks in O(n p) at worst
std::vector<std::size_t> response_peaks(std::span<const double> level, double prominence,
                                        std::size_t most);

}  // namespace stridor
