// Nodes, elements and physical groups of a Gmsh mesh as they stand in the file.
#pragma once

#include <compare>
#include <cstddef>
#include <cstdint>
#include <map>
#include <string>
#include <vector>

#include "io/imports/gmsh_types.hpp"
#include "io/imports/mesh_draft.hpp"

namespace stridor {

/// A physical group: dimension of its elements and tag.
struct GmshGroup {
  int dimension = 0;
  std::int64_t tag = 0;
  auto operator<=>(const GmshGroup&) const = default;
};

struct GmshContents {
  struct Element {
    std::int64_t label = 0;
    std::size_t offset = 0;  ///< in the file
    std::size_t first = 0;   ///< of its nodes in `connectivity`
    const GmshType* type = nullptr;
  };

  std::string format;  ///< "Gmsh 4.1, binary"
  MeshDraft::Nodes nodes;
  std::vector<Element> elements;                         ///< of all dimensions
  std::vector<std::int64_t> connectivity;                ///< labels of nodes in the order of Gmsh
  std::map<GmshGroup, std::vector<std::size_t>> groups;  ///< elements
  std::map<GmshGroup, std::string> names;                ///< of groups that have one
  std::vector<std::string> skipped;                      ///< sections
};

/// Reads sections without resolving labels.
/// @throws ConfigError with the place
GmshContents read_gmsh_contents(SourceText& source);

/// Makes one element of those that version 2.2 writes once for every group that they are in: same
/// type and nodes in the same order, different groups. Those below the given dimension, which only
/// make groups, may stand any number of times.
/// @throws ConfigError if one of that dimension stands twice in a group, or once in none
void merge_copies(GmshContents& contents, int dimension, const SourceText& source);

}  // namespace stridor
