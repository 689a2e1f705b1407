#include "io/imports/gmsh_sections.hpp"

#include <fmt/format.h>

#include <cstdlib>
#include <limits>

namespace stridor {
namespace {

/// A tag of a group; its sign says how its elements are oriented.
std::int64_t group_tag(GmshCursor& cursor) {
  const std::size_t begin = cursor.offset();
  const std::int64_t tag = cursor.integer("a tag of a physical group");
  if (tag == std::numeric_limits<std::int64_t>::min())
    cursor.refuse(begin, "a tag of a physical group is out of range");
  return std::abs(tag);
}

std::string_view unquoted_name(std::string_view text) {
  if (text.size() >= 2 && text.front() == '"' && text.back() == '"')
    return text.substr(1, text.size() - 2);
  return text;
}

void read_entity(GmshCursor& cursor, int dimension, GmshEntities& entities) {
  const std::size_t begin = cursor.offset();
  const std::int64_t tag = cursor.integer("the tag of an entity");
  for (int k = 0; k < (dimension == 0 ? 3 : 6); ++k) cursor.skip_real("the box of an entity");
  const std::size_t before = cursor.offset();
  const std::size_t word_bytes = cursor.is_binary() ? 4 : 2;
  const std::size_t num_groups = cursor.checked_count(cursor.size("a number of physical groups"),
                                                      word_bytes, before, "physical groups");
  std::vector<std::int64_t> groups;
  for (std::size_t k = 0; k < num_groups; ++k) groups.push_back(group_tag(cursor));
  if (dimension > 0) {
    const std::int64_t num_bounds = cursor.size("a number of bounding entities");
    for (std::int64_t k = 0; k < num_bounds; ++k) cursor.integer("a bounding entity");
  }
  cursor.end_record("an entity");
  if (!entities.emplace(std::pair(std::int64_t{dimension}, tag), std::move(groups)).second)
    cursor.refuse(begin, fmt::format("entity {} of dimension {} stands twice", tag, dimension));
}

void read_node_block(GmshCursor& cursor, const SourceText& source, GmshContents& contents) {
  const std::size_t begin = cursor.offset();
  const std::int64_t dimension = cursor.integer("the dimension of an entity");
  if (dimension < 0 || dimension > 3)
    cursor.refuse(begin, fmt::format("expected a dimension from 0 to 3, got {}", dimension));
  cursor.integer("the tag of an entity");
  const std::size_t before = cursor.offset();
  const std::int64_t parametric = cursor.integer("0 or 1 for parametric nodes");
  if (parametric != 0 && parametric != 1)
    cursor.refuse(before, fmt::format("expected 0 or 1 for parametric nodes, got {}", parametric));
  const std::size_t count = cursor.checked_count(
      cursor.size("a number of nodes"), cursor.is_binary() ? 32 : 7, begin, "nodes of a block");
  cursor.end_record("the head of a block");

  MeshDraft::Nodes& nodes = contents.nodes;
  const std::size_t first = nodes.size();
  nodes.positions.resize(first + count);
  nodes.labels.reserve(first + count);
  for (std::size_t k = 0; k < count; ++k) {
    nodes.places.push_back({&source, cursor.offset()});
    nodes.labels.push_back(cursor.size("a node tag"));
    cursor.end_record("a node tag");
  }
  for (std::size_t k = first; k < first + count; ++k) {
    for (double& coordinate : nodes.positions[k]) coordinate = cursor.real("a coordinate");
    for (int extra = 0; extra < parametric * static_cast<int>(dimension); ++extra)
      cursor.skip_real("a parametric coordinate");
    cursor.end_record("the coordinates of a node");
  }
}

const GmshType& known_type(const GmshCursor& cursor, std::int64_t number, std::size_t offset) {
  const GmshType* type = gmsh_type(number);
  if (type == nullptr) cursor.refuse(offset, refused_gmsh_type(number));
  return *type;
}

void read_element_block(GmshCursor& cursor, const GmshEntities& entities, GmshContents& contents) {
  const std::size_t begin = cursor.offset();
  const std::int64_t dimension = cursor.integer("the dimension of an entity");
  const std::int64_t entity = cursor.integer("the tag of an entity");
  const GmshType& type = known_type(cursor, cursor.integer("an element type"), begin);
  if (dimension != type.dimension) {
    cursor.refuse(begin, fmt::format("elements of type {} have dimension {}, their entity {}",
                                     type.number, type.dimension, dimension));
  }
  const auto words = static_cast<std::size_t>(type.num_nodes) + 1;
  const std::size_t count =
      cursor.checked_count(cursor.size("a number of elements"),
                           words * (cursor.is_binary() ? 8 : 2), begin, "elements of a block");
  cursor.end_record("the head of a block");

  const std::size_t first = contents.elements.size();
  for (std::size_t k = 0; k < count; ++k) {
    GmshContents::Element element{0, cursor.offset(), contents.connectivity.size(), &type};
    element.label = cursor.size("an element tag");
    for (int node = 0; node < type.num_nodes; ++node)
      contents.connectivity.push_back(cursor.size("a node tag of an element"));
    cursor.end_record("an element");
    contents.elements.push_back(element);
  }
  const auto groups = entities.find({dimension, entity});
  if (groups == entities.end()) return;
  for (const std::int64_t tag : groups->second) {
    std::vector<std::size_t>& members = contents.groups[{type.dimension, tag}];
    for (std::size_t k = 0; k < count; ++k) members.push_back(first + k);
  }
}

/// Number of blocks and of nodes or elements, then the smallest and the largest tag.
struct SectionHead {
  std::int64_t num_blocks = 0;
  std::int64_t num_items = 0;
  std::size_t offset = 0;
};

SectionHead read_section_head(GmshCursor& cursor) {
  SectionHead head;
  head.offset = cursor.offset();
  head.num_blocks = cursor.size("a number of blocks");
  head.num_items = cursor.size("a number of nodes or elements");
  cursor.size("the smallest tag");
  cursor.size("the largest tag");
  cursor.end_record("the head of a section");
  return head;
}

void check_total(const GmshCursor& cursor, const SectionHead& head, std::size_t found,
                 const char* what) {
  if (static_cast<std::uint64_t>(head.num_items) == found) return;
  cursor.refuse(head.offset,
                fmt::format("{} {} are declared, the blocks hold {}", head.num_items, what, found));
}

}  // namespace

void read_gmsh_names(GmshCursor& cursor, GmshContents& contents) {
  const std::size_t begin = cursor.offset();
  const std::size_t count =
      cursor.checked_count(cursor.text_integer("a number of names"), 6, begin, "names");
  cursor.line();
  for (std::size_t k = 0; k < count; ++k) {
    cursor.skip_blank();
    const std::size_t start = cursor.offset();
    const std::int64_t dimension = cursor.text_integer("the dimension of a physical group");
    if (dimension < 0 || dimension > 3)
      cursor.refuse(start, fmt::format("expected a dimension from 0 to 3, got {}", dimension));
    const std::int64_t tag = cursor.text_integer("the tag of a physical group");
    const std::string_view name = unquoted_name(cursor.line());
    if (name.empty()) continue;
    const GmshGroup group{static_cast<int>(dimension), tag};
    if (!contents.names.emplace(group, name).second) {
      cursor.refuse(start,
                    fmt::format("physical group {} of dimension {} has two names", tag, dimension));
    }
  }
}

void read_gmsh_entities(GmshCursor& cursor, GmshEntities& entities) {
  std::array<std::int64_t, 4> counts{};
  for (std::int64_t& count : counts) count = cursor.size("a number of entities");
  cursor.end_record("the numbers of entities");
  for (int dimension = 0; dimension < 4; ++dimension) {
    for (std::int64_t k = 0; k < counts[static_cast<std::size_t>(dimension)]; ++k)
      read_entity(cursor, dimension, entities);
  }
}

void read_gmsh_nodes_41(GmshCursor& cursor, const SourceText& source, GmshContents& contents) {
  const SectionHead head = read_section_head(cursor);
  for (std::int64_t k = 0; k < head.num_blocks; ++k) read_node_block(cursor, source, contents);
  check_total(cursor, head, contents.nodes.size(), "nodes");
}

void read_gmsh_elements_41(GmshCursor& cursor, const GmshEntities& entities,
                           GmshContents& contents) {
  const SectionHead head = read_section_head(cursor);
  for (std::int64_t k = 0; k < head.num_blocks; ++k) read_element_block(cursor, entities, contents);
  check_total(cursor, head, contents.elements.size(), "elements");
}

}  // namespace stridor
