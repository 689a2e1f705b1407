#include <fmt/format.h>

#include <cstdlib>
#include <limits>

#include "io/imports/gmsh_sections.hpp"

namespace stridor {
namespace {

/// The count in the first line of a section, which is text in binary files, too.
std::int64_t count_of_section(GmshCursor& cursor, const char* what) {
  const std::int64_t count = cursor.text_integer(what);
  const std::size_t offset = cursor.offset();
  if (!cursor.line().empty())
    cursor.refuse(offset, fmt::format("expected the end of the line after {}", what));
  return count;
}

std::int64_t tag_22(GmshCursor& cursor, const char* what) {
  const std::size_t offset = cursor.offset();
  const std::int64_t tag = cursor.integer(what);
  if (tag < 0)
    cursor.refuse(offset, fmt::format("expected {}, which is not negative, got {}", what, tag));
  return tag;
}

const GmshType& type_22(GmshCursor& cursor) {
  const std::size_t offset = cursor.offset();
  const std::int64_t number = cursor.integer("an element type");
  const GmshType* type = gmsh_type(number);
  if (type == nullptr) cursor.refuse(offset, refused_gmsh_type(number));
  return *type;
}

std::int64_t number_of_tags(GmshCursor& cursor) {
  const std::size_t offset = cursor.offset();
  const std::int64_t count = cursor.integer("a number of tags");
  if (count < 0) cursor.refuse(offset, fmt::format("expected a number of tags, got {}", count));
  return count;
}

/// Tags, of which the first is that of the group, and nodes.
void read_tags_and_nodes(GmshCursor& cursor, std::int64_t num_tags, GmshContents& contents,
                         GmshContents::Element element) {
  std::int64_t group = 0;
  for (std::int64_t k = 0; k < num_tags; ++k) {
    const std::int64_t tag = cursor.integer("a tag of an element");
    if (k == 0) group = tag;
  }
  if (group == std::numeric_limits<std::int64_t>::min())
    cursor.refuse(element.offset, "a tag of a physical group is out of range");
  element.first = contents.connectivity.size();
  for (int k = 0; k < element.type->num_nodes; ++k)
    contents.connectivity.push_back(tag_22(cursor, "a node number of an element"));
  cursor.end_record("an element");
  if (group != 0)
    contents.groups[{element.type->dimension, std::abs(group)}].push_back(contents.elements.size());
  contents.elements.push_back(element);
}

void read_text_element(GmshCursor& cursor, GmshContents& contents) {
  cursor.skip_blank();
  GmshContents::Element element;
  element.offset = cursor.offset();
  element.label = tag_22(cursor, "an element number");
  element.type = &type_22(cursor);
  read_tags_and_nodes(cursor, number_of_tags(cursor), contents, element);
}

/// Elements of one type with a head of type, number of elements and number of tags.
/// @param most of the elements that may come
/// @return their number
std::size_t read_binary_block(GmshCursor& cursor, std::size_t most, GmshContents& contents) {
  const std::size_t begin = cursor.offset();
  const GmshType& type = type_22(cursor);
  const std::size_t before = cursor.offset();
  const std::int64_t declared = cursor.integer("a number of elements of a block");
  if (declared < 1 || static_cast<std::size_t>(declared) > most) {
    cursor.refuse(before,
                  fmt::format("expected a block of 1 to {} elements, got {}", most, declared));
  }
  const std::int64_t num_tags = number_of_tags(cursor);
  const auto words =
      static_cast<std::size_t>(num_tags) + static_cast<std::size_t>(type.num_nodes) + 1;
  const std::size_t count = cursor.checked_count(declared, 4 * words, begin, "elements of a block");
  for (std::size_t k = 0; k < count; ++k) {
    GmshContents::Element element{0, cursor.offset(), 0, &type};
    element.label = tag_22(cursor, "an element number");
    read_tags_and_nodes(cursor, num_tags, contents, element);
  }
  return count;
}

}  // namespace

void read_gmsh_nodes_22(GmshCursor& cursor, const SourceText& source, GmshContents& contents) {
  const std::size_t begin = cursor.offset();
  const std::size_t count = cursor.checked_count(count_of_section(cursor, "a number of nodes"),
                                                 cursor.is_binary() ? 28 : 7, begin, "nodes");
  contents.nodes.labels.reserve(count);
  contents.nodes.positions.reserve(count);
  contents.nodes.places.reserve(count);
  for (std::size_t k = 0; k < count; ++k) {
    if (!cursor.is_binary()) cursor.skip_blank();
    const TextPlace place{&source, cursor.offset()};
    const std::int64_t label = tag_22(cursor, "a node number");
    std::array<double, 3> position{};
    for (double& coordinate : position) coordinate = cursor.real("a coordinate");
    cursor.end_record("the coordinates of a node");
    contents.nodes.add(label, position, place);
  }
}

void read_gmsh_elements_22(GmshCursor& cursor, GmshContents& contents) {
  const std::size_t begin = cursor.offset();
  const std::size_t count = cursor.checked_count(count_of_section(cursor, "a number of elements"),
                                                 cursor.is_binary() ? 8 : 6, begin, "elements");
  std::size_t done = 0;
  while (done < count) {
    if (cursor.is_binary()) {
      done += read_binary_block(cursor, count - done, contents);
    } else {
      read_text_element(cursor, contents);
      ++done;
    }
  }
}

}  // namespace stridor
