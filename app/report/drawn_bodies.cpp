#include "app/report/drawn_bodies.hpp"

#include <algorithm>
#include <optional>
#include <utility>

#include "io/figures/placed_bodies.hpp"

namespace stridor {
namespace {

std::vector<double> stacked(const std::vector<std::vector<int>>& loops, bool sizes) {
  std::vector<double> numbers;
  for (const std::vector<int>& loop : loops) {
    if (sizes)
      numbers.push_back(static_cast<double>(loop.size()));
    else
      numbers.insert(numbers.end(), loop.begin(), loop.end());
  }
  return numbers;
}

}  // namespace

DrawnNodes drawn_nodes(std::span<const DrawnBody> bodies) {
  DrawnNodes drawn;
  for (std::size_t b = 0; b < bodies.size(); ++b) {
    DrawnNodes::Part part{b, {}, drawn.count, bodies[b].faces, bodies[b].lines};
    if (!part.faces.empty()) part.lines.clear();
    std::vector<int> number(static_cast<std::size_t>(bodies[b].num_nodes), -1);
    const auto use = [&](int& node) {
      int& known = number[static_cast<std::size_t>(node)];
      if (known < 0) {
        known = static_cast<int>(drawn.count + part.nodes.size());
        part.nodes.push_back(node);
      }
      node = known;
    };
    for (auto* list : {&part.faces, &part.lines})
      for (std::vector<int>& loop : *list) std::for_each(loop.begin(), loop.end(), use);
    if (part.nodes.empty()) {  // points alone, as of lumped masses
      for (int node = 0; node < bodies[b].num_nodes; ++node) {
        int copy = node;
        use(copy);
      }
    }
    drawn.count += part.nodes.size();
    drawn.parts.push_back(std::move(part));
  }
  return drawn;
}

Json parts_json(const DrawnNodes& drawn, std::span<const DrawnBody> bodies, ReportPage& page) {
  Json parts = Json::array();
  for (const DrawnNodes::Part& part : drawn.parts) {
    Json one = {
        {"name", bodies[part.body].name}, {"first", part.first}, {"count", part.nodes.size()}};
    for (const auto& [name, loops] :
         {std::pair{"faces", &part.faces}, std::pair{"lines", &part.lines}}) {
      if (loops->empty()) continue;
      one[name] = {{"sizes", page.add_numbers(stacked(*loops, true))},
                   {"nodes", page.add_numbers(stacked(*loops, false))}};
    }
    parts.push_back(std::move(one));
  }
  return parts;
}

int upward_axis(const System& system) {
  if (system.contacts.empty() || system.contacts.front().face) return 2;
  const ContactPoint& contact = system.contacts.front();
  if (!contact.space) return 1;
  const std::optional<Eigen::Vector3d> normal = normal_in_space(system, contact);
  Eigen::Index axis = 0;
  normal->cwiseAbs().maxCoeff(&axis);
  return static_cast<int>(axis);
}

}  // namespace stridor
