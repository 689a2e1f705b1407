#include "io/imports/gmsh_mesh.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <map>
#include <span>
#include <unordered_map>
#include <utility>

#include "io/imports/gmsh_contents.hpp"
#include "io/imports/side_finder.hpp"

namespace stridor {
namespace {

class GmshGroups {
 public:
  GmshGroups(const GmshContents& contents, const SourceText& source, int dimension,
             AssembledMesh& assembled)
      : contents_(contents), source_(source), dimension_(dimension), assembled_(assembled) {}

  void resolve() {
    check_lower_elements();
    find_sides_of_groups();
    for (const auto& [group, members] : contents_.groups) {
      if (group.dimension == dimension_) {
        add_element_set(group, members);
      } else {
        if (group.dimension == dimension_ - 1) add_surface(group, members);
        add_node_set(group, members);
      }
    }
    for (auto& [name, nodes] : assembled_.mesh.node_sets) sort_unique(nodes);
  }

 private:
  std::span<const std::int64_t> labels_of(std::size_t element) const {
    const GmshContents::Element& found = contents_.elements[element];
    return {contents_.connectivity.data() + found.first,
            static_cast<std::size_t>(found.type->num_nodes)};
  }

  [[noreturn]] void refuse_element(std::size_t element, const std::string& message) const {
    const GmshContents::Element& found = contents_.elements[element];
    refuse_at({&source_, found.offset}, fmt::format("element {} {}", found.label, message));
  }

  void check_lower_elements() const {
    for (std::size_t e = 0; e < contents_.elements.size(); ++e) {
      if (contents_.elements[e].type->dimension == dimension_) continue;
      for (const std::int64_t label : labels_of(e)) {
        if (assembled_.nodes.find(label) < 0)
          refuse_element(e, fmt::format("has node {}, which the file does not define", label));
      }
    }
  }

  bool has_name(const GmshGroup& group) const { return contents_.names.contains(group); }
  std::string name_of(const GmshGroup& group) const {
    const auto name = contents_.names.find(group);
    return name == contents_.names.end() ? fmt::format("group_{}", group.tag) : name->second;
  }

  /// @return where the first member stands
  std::size_t place_of(const std::vector<std::size_t>& members) const {
    return members.empty() ? 0 : contents_.elements[members.front()].offset;
  }

  void add_element_set(const GmshGroup& group, const std::vector<std::size_t>& members) {
    std::vector<int> elements;
    elements.reserve(members.size());
    for (const std::size_t member : members)
      elements.push_back(assembled_.elements.find(contents_.elements[member].label));
    sort_unique(elements);
    const std::string name = name_of(group);
    if (!assembled_.mesh.element_sets.emplace(name, std::move(elements)).second)
      refuse_second_name(name, members);
  }

  void add_node_set(const GmshGroup& group, const std::vector<std::size_t>& members) {
    const std::string name = name_of(group);
    const auto [other, is_new] = node_groups_.emplace(name, group);
    if (!is_new && (!has_name(group) || !has_name(other->second))) {
      refuse_at({&source_, place_of(members)},
                fmt::format("physical groups {} of dimension {} and {} of dimension {} are both "
                            "'{}'; give them names that differ",
                            other->second.tag, other->second.dimension, group.tag, group.dimension,
                            name));
    }
    if (!is_new && other->second.dimension == group.dimension) refuse_second_name(name, members);
    other->second.dimension = group.dimension;
    std::vector<int>& nodes = assembled_.mesh.node_sets[name];
    for (const std::size_t member : members) {
      for (const std::int64_t label : labels_of(member)) {
        const auto position = static_cast<std::size_t>(assembled_.nodes.find(label));
        if (assembled_.rows[position] >= 0) nodes.push_back(assembled_.rows[position]);
      }
    }
  }

  [[noreturn]] void refuse_second_name(const std::string& name,
                                       const std::vector<std::size_t>& members) const {
    refuse_at({&source_, place_of(members)},
              fmt::format("two physical groups of the same dimension have the name '{}'; give them "
                          "names that differ",
                          name));
  }

  WantedSide wanted_side(std::size_t element) const {
    const GmshType& type = *contents_.elements[element].type;
    WantedSide side{type.num_corners, type.num_nodes, {}};
    const std::span<const std::int64_t> labels = labels_of(element);
    for (std::size_t k = 0; k < labels.size(); ++k) {
      side.nodes[k] = assembled_.rows[static_cast<std::size_t>(assembled_.nodes.find(labels[k]))];
      if (side.nodes[k] < 0) refuse_loose_side(element);
    }
    return side;
  }

  [[noreturn]] void refuse_loose_side(std::size_t element) const {
    refuse_element(element,
                   fmt::format("({} nodes of dimension {}) is in a physical group, but no "
                               "side of any element; expected a mesh that ends there: "
                               "fragment or embed the geometry before it is meshed",
                               contents_.elements[element].type->num_nodes, dimension_ - 1));
  }

  /// Finds the sides of all groups at once.
  void find_sides_of_groups() {
    std::vector<std::size_t> askers;
    for (const auto& [group, members] : contents_.groups) {
      if (group.dimension == dimension_ - 1)
        askers.insert(askers.end(), members.begin(), members.end());
    }
    sort_unique(askers);
    std::vector<WantedSide> wanted;
    wanted.reserve(askers.size());
    for (const std::size_t asker : askers) wanted.push_back(wanted_side(asker));
    const std::vector<FoundSide> found = find_sides(assembled_.mesh, wanted);
    for (std::size_t k = 0; k < askers.size(); ++k)
      side_of_element_.emplace(askers[k], chosen_side(askers[k], found[k]));
  }

  ElementSide chosen_side(std::size_t element, const FoundSide& side) const {
    if (side.num_elements == 0) refuse_loose_side(element);
    if (!side.is_complete) {
      refuse_element(element,
                     fmt::format("has the corners of a side of element {}, but other nodes "
                                 "between them; expected both of the same order",
                                 label_of(side.first)));
    }
    if (side.num_elements == 1) return side.first;
    if (side.num_elements == 2 && side.agreeing >= 0)
      return side.agreeing == 0 ? side.first : side.second;
    refuse_element(element,
                   fmt::format("is a side of {} elements, among them {} and {}; expected one, or "
                               "two with opposite normals",
                               side.num_elements, label_of(side.first), label_of(side.second)));
  }

  void add_surface(const GmshGroup& group, const std::vector<std::size_t>& members) {
    std::vector<ElementSide>& sides = assembled_.mesh.surfaces[name_of(group)];
    for (const std::size_t member : members) sides.push_back(side_of_element_.at(member));
    sort_unique(sides);
  }

  std::int64_t label_of(const ElementSide& side) const {
    return assembled_.mesh.element_labels[static_cast<std::size_t>(side.element)];
  }

  const GmshContents& contents_;
  const SourceText& source_;
  int dimension_;
  AssembledMesh& assembled_;
  std::map<std::string, GmshGroup> node_groups_;
  std::unordered_map<std::size_t, ElementSide> side_of_element_;
};

int highest_dimension(const GmshContents& contents) {
  int highest = 0;
  for (const GmshContents::Element& element : contents.elements)
    highest = std::max(highest, element.type->dimension);
  return std::max(highest, 2);
}

void add_elements(const GmshContents& contents, int dimension, const SourceText& source,
                  MeshDraft::Elements& elements) {
  std::array<std::int64_t, 20> labels{};
  for (const GmshContents::Element& element : contents.elements) {
    const GmshType& type = *element.type;
    if (type.dimension != dimension) continue;
    const auto count = static_cast<std::size_t>(type.num_nodes);
    for (std::size_t k = 0; k < count; ++k)
      labels[k] = contents.connectivity[element.first + type.order[k]];
    elements.add(*type.shape, element.label, {labels.data(), count}, {&source, element.offset});
  }
}

}  // namespace

ImportedMesh read_gmsh_mesh(SourceText source) {
  GmshContents contents = read_gmsh_contents(source);
  const int dimension = highest_dimension(contents);
  merge_copies(contents, dimension, source);
  MeshDraft draft;
  draft.nodes = std::move(contents.nodes);
  add_elements(contents, dimension, source, draft.elements);
  AssembledMesh assembled = assemble_mesh(std::move(draft), source, "");
  GmshGroups(contents, source, dimension, assembled).resolve();
  ImportedMesh result{std::move(assembled.mesh), {}};
  result.summary =
      summary_of(result.mesh, assembled, std::move(contents.format), std::move(contents.skipped));
  return result;
}

}  // namespace stridor
