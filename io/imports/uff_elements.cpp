#include "io/imports/uff_elements.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <map>
#include <stdexcept>

#include "core/errors.hpp"
#include "io/imports/uff_units.hpp"

namespace stridor {
namespace {

constexpr std::array all_shapes{ElementShape::tri3,   ElementShape::tri6,  ElementShape::quad4,
                                ElementShape::quad8,  ElementShape::tet4,  ElementShape::tet10,
                                ElementShape::hex8,   ElementShape::hex20, ElementShape::wedge6,
                                ElementShape::wedge15};

/// Rods, beams, rigid bars and what else joins two nodes or three in a row.
bool is_line(std::int64_t kind) {
  return kind == 11 || (kind >= 21 && kind <= 24) || kind == 31 || kind == 32 || kind == 121 ||
         (kind >= 136 && kind <= 142);
}

/// Labels from the next lines until there are `count`, or the dataset ends.
std::vector<std::int64_t> labels_in(UffReader& reader, std::size_t count) {
  std::vector<std::int64_t> labels;
  while (labels.size() < count && !reader.is_at_end()) {
    const std::vector<std::int64_t> more = reader.integers(0, "labels of nodes");
    labels.insert(labels.end(), more.begin(), more.end());
  }
  return labels;
}

/// The integers of a line that holds nothing else.
std::vector<std::int64_t> integers_alone(std::string_view line) {
  std::vector<std::int64_t> integers;
  constexpr std::size_t width = 10;
  const auto numbers = uff_numbers_in(line, width);
  if (!numbers) return {};
  for (const double number : *numbers) {
    if (!(number >= 0.0 && number <= 9e15) ||
        number != static_cast<double>(static_cast<std::int64_t>(number)))
      return {};
    integers.push_back(static_cast<std::int64_t>(number));
  }
  return integers;
}

/// The pieces of a line between zeros, which lift the pen.
void add_pieces(const std::vector<std::int64_t>& labels, ModalTest& test) {
  std::vector<std::int64_t> piece;
  const auto finish = [&] {
    if (piece.size() > 1) test.lines.push_back(piece);
    piece.clear();
  };
  for (const std::int64_t label : labels) {
    if (label == 0)
      finish();
    else
      piece.push_back(label);
  }
  finish();
}

/// The nodes of an element; before those of a line may stand its orientation.
std::vector<std::int64_t> element_nodes(UffReader& reader, std::int64_t kind, std::size_t count,
                                        const TextPlace& place) {
  std::vector<std::int64_t> labels;
  if (is_line(kind)) {
    labels = reader.integers(1, "orientation or nodes of a beam");
    // Three numbers are the node of orientation and two cross-sections, unless they are the nodes
    // themselves: then the head of the next element follows, or nothing.
    constexpr std::size_t most_nodes_of_a_line = 3;
    if (labels.size() == 3 &&
        (count != 3 || integers_alone(reader.ahead()).size() == most_nodes_of_a_line))
      labels.clear();
  }
  while (labels.size() < count) {
    const std::vector<std::int64_t> more = reader.integers(1, "labels of the nodes of an element");
    labels.insert(labels.end(), more.begin(), more.end());
  }
  if (labels.size() != count)
    refuse_at(place, fmt::format("expected {} nodes of the element, got {}", count, labels.size()));
  return labels;
}

void add_element(std::int64_t kind, const std::vector<std::int64_t>& labels, ElementShape shape,
                 const TextPlace& place, ModalTest& test) {
  const ShapeFacts& facts = facts_of(shape);
  if (labels.size() != static_cast<std::size_t>(facts.num_nodes)) {
    refuse_at(place, fmt::format("expected {} nodes of an element of kind {} ({}), got {}",
                                 facts.num_nodes, kind, facts.name, labels.size()));
  }
  const UffElementRecord record = element_record(shape);
  TestElement element{shape, labels};
  for (std::size_t k = 0; k < record.order.size(); ++k)
    element.nodes[static_cast<std::size_t>(record.order[k])] = labels[k];
  test.elements.push_back(std::move(element));
}

}  // namespace

UffElementRecord element_record(ElementShape shape) {
  switch (shape) {
    case ElementShape::tri3:
      return {41, {}};
    case ElementShape::tri6:
      return {42, {0, 3, 1, 4, 2, 5}};
    case ElementShape::quad4:
      return {44, {}};
    case ElementShape::quad8:
      return {45, {0, 4, 1, 5, 2, 6, 3, 7}};
    case ElementShape::tet4:
      return {111, {}};
    case ElementShape::tet10:
      return {118, {0, 4, 1, 5, 2, 6, 7, 8, 9, 3}};
    case ElementShape::wedge6:
      return {112, {}};
    case ElementShape::wedge15:
      return {113, {0, 6, 1, 7, 2, 8, 12, 13, 14, 3, 9, 4, 10, 5, 11}};
    case ElementShape::hex8:
      return {115, {}};
    case ElementShape::hex20:
      return {116, {0, 8, 1, 9, 2, 10, 3, 11, 16, 17, 18, 19, 4, 12, 5, 13, 6, 14, 7, 15}};
  }
  throw std::invalid_argument("element_record: unknown shape of an element");
}

std::optional<ElementShape> shape_of_kind(std::int64_t kind) {
  // 41, 42, 44, 45 and the same in every ten up to the thin shells.
  if (kind > 50 && kind < 100) kind = 40 + kind % 10;
  for (const ElementShape shape : all_shapes)
    if (element_record(shape).kind == kind) return shape;
  return std::nullopt;
}

void read_trace_lines(const UffDataset& dataset, ModalTest& test) {
  UffReader reader(dataset);
  constexpr const char* expected = "number, number of nodes and colour of a trace line";
  while (!reader.is_at_end()) {
    const UffLine& head = reader.line(expected);
    if (trimmed(head.text).empty()) continue;
    const std::vector<std::int64_t> numbers = integers_alone(head.text);
    // A line of zeros pads the one before.
    if (!numbers.empty() && std::ranges::all_of(numbers, [](std::int64_t one) { return one == 0; }))
      continue;
    if (numbers.size() < 2 || numbers[1] > 1000000000)
      refuse_at(head.place, fmt::format("expected {}, got '{}'", expected, shown(head.text)));
    const auto count = static_cast<std::size_t>(numbers[1]);
    const UffLine& name = reader.line("the name of a trace line, or NONE");
    std::vector<std::int64_t> labels = labels_in(reader, count);
    if (labels.size() < count) {
      const std::vector<std::int64_t> first = integers_alone(name.text);
      if (!first.empty() && first.size() + labels.size() >= count) {
        labels.insert(labels.begin(), first.begin(), first.end());
        test.remarks.push_back(
            fmt::format("{}: trace line {} has no name; the line after its head is taken for nodes",
                        place_text(name.place), numbers[0]));
      }
    }
    if (labels.size() < count) {
      test.remarks.push_back(fmt::format("{}: {} of {} nodes of the trace line {} are missing",
                                         place_text(head.place), count - labels.size(), count,
                                         numbers[0]));
    }
    labels.resize(std::min(labels.size(), count));  // the last line may be padded
    add_pieces(labels, test);
  }
}

void read_elements(const UffDataset& dataset, ModalTest& test) {
  UffReader reader(dataset);
  constexpr const char* expected =
      "label, kind, property, material, colour and number of nodes of an element";
  std::map<std::int64_t, std::size_t> passed_over;
  while (!reader.is_at_end()) {
    const UffLine& head = reader.line(expected);
    if (trimmed(head.text).empty()) continue;
    const std::vector<std::int64_t> numbers = integers_alone(head.text);
    if (numbers.size() < 6)
      refuse_at(head.place, fmt::format("expected {}, got '{}'", expected, shown(head.text)));
    const std::int64_t kind = numbers[1];
    const std::vector<std::int64_t> labels =
        numbers[5] > 0
            ? element_nodes(reader, kind, static_cast<std::size_t>(numbers[5]), head.place)
            : std::vector<std::int64_t>{};
    if (const auto shape = shape_of_kind(kind)) {
      add_element(kind, labels, *shape, head.place, test);
    } else if (is_line(kind)) {
      add_pieces(labels, test);
    } else {
      ++passed_over[kind];
    }
  }
  for (const auto& [kind, count] : passed_over)
    test.remarks.push_back(
        place_text(dataset.place) +
        (count == 1 ? fmt::format(": an element of kind {} is passed over", kind)
                    : fmt::format(": {} elements of kind {} are passed over", count, kind)));
}

}  // namespace stridor
