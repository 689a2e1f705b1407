#include "substructures/bodies/drawn_test.hpp"

#include <algorithm>
#include <set>
#include <utility>

namespace stridor {

std::vector<std::vector<std::int64_t>> drawn_lines(const ModalTest& test) {
  std::vector<std::vector<std::int64_t>> lines = test.lines;
  std::set<std::pair<std::int64_t, std::int64_t>> known;
  for (const TestElement& element : test.elements) {
    const auto label = [&](int node) { return element.nodes[static_cast<std::size_t>(node)]; };
    for (const SideNodes& side : facts_of(element.shape).sides) {
      // Sides of planar elements are edges; those of volumes have as many edges as corners.
      const int num_edges = side.num_corners == 2 ? 1 : side.num_corners;
      for (int k = 0; k < num_edges; ++k) {
        const auto corner = [&](int i) {
          return side.nodes[static_cast<std::size_t>(i % side.num_corners)];
        };
        const std::int64_t from = label(corner(k));
        const std::int64_t to = label(corner(k + 1));
        if (from == to || !known.insert(std::minmax(from, to)).second) continue;
        std::vector<std::int64_t>& line = lines.emplace_back();
        line.push_back(from);
        if (side.count > side.num_corners)
          line.push_back(label(side.nodes[static_cast<std::size_t>(side.num_corners + k)]));
        line.push_back(to);
      }
    }
  }
  return lines;
}

DrawnTest drawn_test(const ModalTest& test, std::span<const TestMode* const> modes,
                     std::map<std::int64_t, std::size_t> ports, std::size_t first) {
  DrawnTest drawn{std::move(ports), {}, {}};
  if (modes.empty()) return drawn;
  const auto is_known = [&](std::int64_t label) {
    return drawn.numbers.contains(label) ||
           (test.nodes.contains(label) && std::ranges::all_of(modes, [&](const TestMode* mode) {
              return mode->shape.contains(label);
            }));
  };
  for (const std::vector<std::int64_t>& line : drawn_lines(test)) {
    std::vector<int> nodes;
    const auto finish = [&] {
      if (nodes.size() > 1) drawn.lines.push_back(nodes);
      nodes.clear();
    };
    for (const std::int64_t label : line) {
      if (!is_known(label)) {
        finish();
        continue;
      }
      const auto [number, is_new] = drawn.numbers.emplace(label, first + drawn.labels.size());
      if (is_new) drawn.labels.push_back(label);
      nodes.push_back(static_cast<int>(number->second));
    }
    finish();
  }
  return drawn;
}

}  // namespace stridor
