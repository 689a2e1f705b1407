#include <fmt/format.h>

#include <algorithm>
#include <numeric>
#include <span>
#include <utility>

#include "io/imports/gmsh_contents.hpp"

namespace stridor {
namespace {

std::span<const std::int64_t> nodes_in_order(const GmshContents& contents, std::size_t element) {
  const GmshContents::Element& found = contents.elements[element];
  return {contents.connectivity.data() + found.first,
          static_cast<std::size_t>(found.type->num_nodes)};
}

std::uint64_t hash_of_nodes(const GmshContents& contents, std::size_t element) {
  std::uint64_t hash = static_cast<std::uint64_t>(contents.elements[element].type->number);
  for (const std::int64_t label : nodes_in_order(contents, element)) {
    hash = (hash ^ static_cast<std::uint64_t>(label)) * 0x9e3779b97f4a7c15ULL;
    hash ^= hash >> 32;
  }
  return hash;
}

bool are_copies(const GmshContents& contents, std::size_t one, std::size_t other) {
  if (contents.elements[one].type != contents.elements[other].type) return false;
  const auto first = nodes_in_order(contents, one);
  return std::equal(first.begin(), first.end(), nodes_in_order(contents, other).begin());
}

/// For every element the first one that it is a copy of, or itself.
std::vector<std::size_t> originals_of(const GmshContents& contents) {
  std::vector<std::pair<std::uint64_t, std::size_t>> hashes(contents.elements.size());
  for (std::size_t e = 0; e < hashes.size(); ++e) hashes[e] = {hash_of_nodes(contents, e), e};
  std::sort(hashes.begin(), hashes.end());
  std::vector<std::size_t> originals(hashes.size());
  std::iota(originals.begin(), originals.end(), std::size_t{0});
  std::size_t first = 0;  // of those with the same hash: one element, but for rare collisions
  for (std::size_t k = 1; k < hashes.size(); ++k) {
    if (hashes[k].first != hashes[first].first ||
        !are_copies(contents, hashes[first].second, hashes[k].second)) {
      first = k;
    } else {
      originals[hashes[k].second] = hashes[first].second;
    }
  }
  return originals;
}

}  // namespace

void merge_copies(GmshContents& contents, int dimension, const SourceText& source) {
  const std::vector<std::size_t> originals = originals_of(contents);
  std::vector<std::size_t> kept(originals.size());
  std::size_t num_kept = 0;
  for (std::size_t e = 0; e < originals.size(); ++e) {
    if (originals[e] == e) kept[e] = num_kept++;
  }
  if (num_kept == originals.size()) return;

  std::vector<bool> is_grouped(originals.size(), false);
  for (auto& [group, members] : contents.groups) {
    for (std::size_t& member : members) {
      is_grouped[member] = true;
      member = originals[member];
    }
    std::sort(members.begin(), members.end());
    const auto twice = std::adjacent_find(members.begin(), members.end());
    if (group.dimension == dimension && twice != members.end()) {
      refuse_at({&source, contents.elements[*twice].offset},
                fmt::format("element {} stands twice, in the same physical group",
                            contents.elements[*twice].label));
    }
    members.erase(std::unique(members.begin(), members.end()), members.end());
    for (std::size_t& member : members) member = kept[member];
  }
  for (std::size_t e = 0; e < originals.size(); ++e) {
    const GmshContents::Element& element = contents.elements[e];
    if (originals[e] == e || element.type->dimension != dimension) continue;
    if (is_grouped[e] && is_grouped[originals[e]]) continue;
    refuse_at({&source, element.offset},
              fmt::format("element {} has the nodes of element {}; expected it once", element.label,
                          contents.elements[originals[e]].label));
  }
  std::size_t next = 0;
  for (std::size_t e = 0; e < originals.size(); ++e) {
    if (originals[e] == e) contents.elements[next++] = contents.elements[e];
  }
  contents.elements.resize(next);
}

}  // namespace stridor
