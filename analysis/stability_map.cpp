#include "analysis/stability_map.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>

namespace stridor {
namespace {

/// A crossing on a line of the grid and those it is connected with, in the cells on both sides.
struct Node {
  std::array<double, 2> place;
  std::vector<std::size_t> neighbours;
};

/// Crossings of every line, numbered.
class Nodes {
 public:
  /// @param direction of the line: 0 along x, 1 along y
  void add(std::size_t direction, std::size_t line, double at, double along) {
    auto& lists = numbers_[direction];
    if (lists.size() <= line) lists.resize(line + 1);
    lists[line].push_back(nodes.size());
    nodes.push_back({direction == 0 ? std::array{along, at} : std::array{at, along}, {}});
  }

  /// Numbers of the crossings of a line between two values, ascending.
  std::vector<std::size_t> between(std::size_t direction, std::size_t line, double from,
                                   double to) const {
    std::vector<std::size_t> found;
    if (line >= numbers_[direction].size()) return found;
    for (const std::size_t number : numbers_[direction][line]) {
      const double value = nodes[number].place[direction];
      if (value > from && value <= to) found.push_back(number);
    }
    return found;
  }

  std::vector<Node> nodes;

 private:
  std::array<std::vector<std::vector<std::size_t>>, 2> numbers_;
};

void check_lists(const std::vector<double>& grid, const std::vector<std::vector<double>>& lists,
                 std::size_t num_lines) {
  const auto ascends = [](const std::vector<double>& values) {
    return std::adjacent_find(values.begin(), values.end(),
                              [](double a, double b) { return !(a < b); }) == values.end();
  };
  if (grid.size() < 2 || !ascends(grid))
    throw std::invalid_argument("stability map: a grid needs two ascending values or more");
  if (lists.size() != num_lines || !std::all_of(lists.begin(), lists.end(), ascends))
    throw std::invalid_argument("stability map: the crossings do not fit the grid");
}

/// A crossing on the way around a cell.
struct OnSide {
  std::size_t node = 0;
  int side = 0;
};

/// Connects the crossings around one cell, given in the order in which they follow there.
void connect(std::vector<Node>& nodes, const std::vector<OnSide>& around, double width,
             double height) {
  const std::size_t count = around.size();
  if (count < 2 || count % 2 != 0) return;
  // A line that comes in on one side leaves on another where it can: its ends on the same side are
  // closest when it is narrow and passes right through.
  const auto cost = [&](std::size_t first) {
    std::pair<int, double> sum{0, 0.0};
    for (std::size_t i = first; i < first + count; i += 2) {
      const OnSide& one = around[i % count];
      const OnSide& other = around[(i + 1) % count];
      const auto& a = nodes[one.node].place;
      const auto& b = nodes[other.node].place;
      sum.first += one.side == other.side ? 1 : 0;
      sum.second += std::hypot((a[0] - b[0]) / width, (a[1] - b[1]) / height);
    }
    return sum;
  };
  const std::size_t first = cost(0) <= cost(1) ? 0 : 1;
  for (std::size_t i = first; i < first + count; i += 2) {
    const std::size_t a = around[i % count].node;
    const std::size_t b = around[(i + 1) % count].node;
    nodes[a].neighbours.push_back(b);
    nodes[b].neighbours.push_back(a);
  }
}

/// The line that begins at a node; nodes on it are marked as taken.
BoundaryLine follow(const std::vector<Node>& nodes, std::size_t start,
                    std::vector<bool>& is_taken) {
  BoundaryLine line;
  std::size_t at = start;
  while (true) {
    is_taken[at] = true;
    line.push_back(nodes[at].place);
    const auto& neighbours = nodes[at].neighbours;
    const auto next = std::find_if(neighbours.begin(), neighbours.end(),
                                   [&](std::size_t other) { return !is_taken[other]; });
    if (next == neighbours.end()) break;
    at = *next;
  }
  const auto& last = nodes[at].neighbours;
  const bool is_closed =
      line.size() > 2 && std::find(last.begin(), last.end(), start) != last.end();
  if (is_closed) line.push_back(nodes[start].place);
  return line;
}

}  // namespace

std::vector<BoundaryLine> boundary_lines(const GridCrossings& crossings) {
  const std::vector<double>& x = crossings.x;
  const std::vector<double>& y = crossings.y;
  check_lists(x, crossings.along_x, y.size());
  check_lists(y, crossings.along_y, x.size());
  Nodes all;
  for (std::size_t j = 0; j < y.size(); ++j)
    for (const double value : crossings.along_x[j]) all.add(0, j, y[j], value);
  for (std::size_t i = 0; i < x.size(); ++i)
    for (const double value : crossings.along_y[i]) all.add(1, i, x[i], value);

  for (std::size_t j = 0; j + 1 < y.size(); ++j) {
    for (std::size_t i = 0; i + 1 < x.size(); ++i) {
      std::vector<OnSide> around;
      const auto append = [&](int side, std::vector<std::size_t> crossed) {
        if (side >= 2) std::reverse(crossed.begin(), crossed.end());
        for (const std::size_t node : crossed) around.push_back({node, side});
      };
      append(0, all.between(0, j, x[i], x[i + 1]));
      append(1, all.between(1, i + 1, y[j], y[j + 1]));
      append(2, all.between(0, j + 1, x[i], x[i + 1]));
      append(3, all.between(1, i, y[j], y[j + 1]));
      connect(all.nodes, around, x[i + 1] - x[i], y[j + 1] - y[j]);
    }
  }

  std::vector<BoundaryLine> lines;
  std::vector<bool> is_taken(all.nodes.size(), false);
  // Open lines from their ends first; the remaining ones are closed.
  for (const bool is_from_end : {true, false}) {
    for (std::size_t start = 0; start < all.nodes.size(); ++start) {
      const std::size_t degree = all.nodes[start].neighbours.size();
      if (is_taken[start] || degree == 0 || (is_from_end && degree != 1)) continue;
      lines.push_back(follow(all.nodes, start, is_taken));
    }
  }
  std::stable_sort(lines.begin(), lines.end(), [](const BoundaryLine& a, const BoundaryLine& b) {
    return a.size() > b.size();
  });
  return lines;
}

}  // namespace stridor
