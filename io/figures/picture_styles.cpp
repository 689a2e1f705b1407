#include "io/figures/picture_styles.hpp"

namespace stridor {

std::vector<std::pair<Eigen::Vector2d, Eigen::Vector2d>> spring_lines(const Eigen::Vector2d& from,
                                                                      const Eigen::Vector2d& to,
                                                                      bool is_grounded) {
  constexpr double spot = 0.05;
  constexpr double height = 0.14;    // of the zigzag on either side
  constexpr double straight = 0.22;  // share of the length at either end
  constexpr int num_turns = 6;
  const double length = (to - from).norm();
  if (!(length > spot)) return {};
  const Eigen::Vector2d along = (to - from) / length;
  const Eigen::Vector2d across(-along.y(), along.x());
  const auto place = [&](double share, double aside) {
    return Eigen::Vector2d(from + share * length * along + aside * across);
  };
  std::vector<Eigen::Vector2d> corners{from, place(straight, 0.0)};
  for (int turn = 0; turn < num_turns; ++turn) {
    const double share = straight + (1.0 - 2.0 * straight) * (turn + 0.5) / num_turns;
    corners.push_back(place(share, turn % 2 == 0 ? height : -height));
  }
  corners.push_back(place(1.0 - straight, 0.0));
  corners.push_back(to);
  std::vector<std::pair<Eigen::Vector2d, Eigen::Vector2d>> lines;
  for (std::size_t i = 0; i + 1 < corners.size(); ++i)
    lines.emplace_back(corners[i], corners[i + 1]);
  if (!is_grounded) return lines;
  constexpr double half_bar = 0.3;
  constexpr double hatch = 0.14;
  constexpr int num_hatches = 4;
  lines.emplace_back(place(1.0, -half_bar), place(1.0, half_bar));
  for (int k = 0; k < num_hatches; ++k) {
    const double aside = half_bar * (2.0 * k / (num_hatches - 1) - 1.0);
    lines.emplace_back(place(1.0, aside), place(1.0 + hatch / length, aside - hatch));
  }
  return lines;
}

}  // namespace stridor
