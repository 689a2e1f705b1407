#include "io/figures/picture_flags.hpp"

#include <algorithm>
#include <cstddef>
#include <numeric>

namespace stridor {

std::vector<int> flag_rows(std::span<const FlagRequest> flags, double gap, int most_rows) {
  std::vector<std::size_t> order(flags.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::stable_sort(order.begin(), order.end(),
                   [&](std::size_t a, std::size_t b) { return flags[a].x > flags[b].x; });
  std::vector<int> rows(flags.size(), -1);
  for (std::size_t i = 0; i < order.size(); ++i) {
    const FlagRequest& flag = flags[order[i]];
    int row = 0;
    for (std::size_t k = 0; k < i; ++k) {
      const std::size_t right = order[k];
      if (flags[right].x < flag.x + flag.width + gap) row = std::max(row, rows[right] + 1);
    }
    if (row < most_rows) rows[order[i]] = row;
  }
  return rows;
}

}  // namespace stridor
