#include "io/imports/side_finder.hpp"

#include <algorithm>
#include <array>
#include <unordered_map>

namespace stridor {
namespace {

using SideCorners = std::array<int, 4>;  // ascending, unused ones -1

struct SideCornersHash {
  std::size_t operator()(const SideCorners& corners) const {
    std::uint64_t hash = 0;
    for (const int corner : corners) {
      hash = (hash ^ static_cast<std::uint32_t>(corner)) * 0x9e3779b97f4a7c15ULL;
      hash ^= hash >> 29;
    }
    return hash;
  }
};

SideCorners sorted_corners(const WantedSide& side) {
  SideCorners corners{-1, -1, -1, -1};
  std::copy_n(side.nodes.begin(), side.num_corners, corners.begin());
  std::sort(corners.begin(), corners.end());
  return corners;
}

bool run_the_same_way(const WantedSide& one, const WantedSide& other) {
  const auto end = one.nodes.begin() + one.num_corners;
  const auto start = std::find(one.nodes.begin(), end, other.nodes.front());
  for (int k = 0; k < one.num_corners; ++k) {
    const auto shift = static_cast<int>(start - one.nodes.begin());
    const auto mine = static_cast<std::size_t>((shift + k) % one.num_corners);
    if (one.nodes[mine] != other.nodes[static_cast<std::size_t>(k)]) return false;
  }
  return true;
}

bool have_the_same_nodes(const WantedSide& one, const WantedSide& other) {
  return one.count == other.count &&
         std::is_permutation(one.nodes.begin(), one.nodes.begin() + one.count, other.nodes.begin());
}

WantedSide side_of(std::span<const int> nodes, const SideNodes& facts) {
  WantedSide side{facts.num_corners, facts.count, {}};
  for (std::size_t k = 0; k < static_cast<std::size_t>(facts.count); ++k)
    side.nodes[k] = nodes[static_cast<std::size_t>(facts.nodes[k])];
  return side;
}

void note_match(FoundSide& found, const ElementSide& where, const WantedSide& side,
                const WantedSide& wanted) {
  const int index = found.num_elements++;
  if (index > 1) return;
  (index == 0 ? found.first : found.second) = where;
  if (!have_the_same_nodes(side, wanted)) found.is_complete = false;
  if (found.agreeing < 0 && run_the_same_way(side, wanted)) found.agreeing = index;
}

}  // namespace

std::vector<FoundSide> find_sides(const Mesh& mesh, std::span<const WantedSide> wanted) {
  std::vector<FoundSide> found(wanted.size());
  std::vector<bool> is_wanted(mesh.num_nodes(), false);
  std::unordered_multimap<SideCorners, std::size_t, SideCornersHash> by_corners;
  by_corners.reserve(wanted.size());
  for (std::size_t k = 0; k < wanted.size(); ++k) {
    by_corners.emplace(sorted_corners(wanted[k]), k);
    for (int corner = 0; corner < wanted[k].num_corners; ++corner)
      is_wanted[static_cast<std::size_t>(wanted[k].nodes[static_cast<std::size_t>(corner)])] = true;
  }
  for (std::size_t e = 0; e < mesh.num_elements(); ++e) {
    const std::span<const int> nodes = mesh.nodes_of(e);
    const std::vector<SideNodes>& sides = facts_of(mesh.shapes[e]).sides;
    for (std::size_t s = 0; s < sides.size(); ++s) {
      const WantedSide side = side_of(nodes, sides[s]);
      const bool may_be_wanted =
          std::all_of(side.nodes.begin(), side.nodes.begin() + side.num_corners,
                      [&](int node) { return is_wanted[static_cast<std::size_t>(node)]; });
      if (!may_be_wanted) continue;
      const auto [begin, end] = by_corners.equal_range(sorted_corners(side));
      for (auto match = begin; match != end; ++match) {
        note_match(found[match->second], {static_cast<int>(e), static_cast<int>(s)}, side,
                   wanted[match->second]);
      }
    }
  }
  return found;
}

}  // namespace stridor
