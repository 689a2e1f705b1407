#include "analysis/parameter_grid.hpp"

#include <algorithm>
#include <cmath>
#include <iterator>

namespace stridor {

Grid make_grid(const std::vector<double>& wanted, const std::vector<double>& kinks) {
  constexpr int least_per_piece = 4;
  constexpr int least_in_all = 64;
  const double range = wanted.back() - wanted.front();
  const double rounding = 1e-12 * range;
  Grid grid;
  for (const double kink : kinks) {
    if (kink <= wanted.front() + rounding || kink >= wanted.back() - rounding) continue;
    // A kink that a value was meant to hit is hit by it.
    const auto next = std::lower_bound(wanted.begin(), wanted.end(), kink - rounding);
    grid.kinks.push_back(next != wanted.end() && *next <= kink + rounding ? *next : kink);
  }
  std::vector<double> nodes;
  std::set_union(wanted.begin(), wanted.end(), grid.kinks.begin(), grid.kinks.end(),
                 std::back_inserter(nodes));
  grid.values.push_back(nodes.front());
  auto piece_end = grid.kinks.begin();
  double piece_begin = nodes.front();
  for (std::size_t i = 0; i + 1 < nodes.size(); ++i) {
    while (piece_end != grid.kinks.end() && *piece_end <= nodes[i]) piece_begin = *piece_end++;
    const double end = piece_end != grid.kinks.end() ? *piece_end : nodes.back();
    const double longest = std::min((end - piece_begin) / least_per_piece, range / least_in_all);
    const double length = nodes[i + 1] - nodes[i];
    const auto parts = std::max(1, static_cast<int>(std::ceil(length / longest * (1.0 - 1e-9))));
    for (int part = 1; part < parts; ++part) {
      grid.values.push_back(nodes[i] + length * part / parts);
    }
    grid.values.push_back(nodes[i + 1]);
  }
  return grid;
}

}  // namespace stridor
