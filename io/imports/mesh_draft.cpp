#include "io/imports/mesh_draft.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

namespace stridor {
namespace {

constexpr auto most_items = static_cast<std::size_t>(std::numeric_limits<int>::max());

void refuse_repeated(const LabelIndex& index, const std::vector<std::int64_t>& labels,
                     const std::vector<TextPlace>& places, const char* kind) {
  const auto twice = index.repeated();
  if (!twice) return;
  const auto second = static_cast<std::size_t>(twice->second);
  refuse_at(places[second],
            fmt::format("{} {} stands twice; expected numbers that differ", kind, labels[second]));
}

void check_sizes(const MeshDraft& draft, const SourceText& whole) {
  if (draft.elements.size() == 0)
    refuse_at({&whole, whole.text.size()},
              "the file has no elements of surfaces or volumes; expected a mesh with some");
  if (draft.nodes.size() > most_items || draft.elements.size() > most_items)
    refuse_at({&whole, 0}, fmt::format("more than {} nodes or elements", most_items));
}

void check_dimensions(const MeshDraft::Elements& elements, const std::string& mixed_remedy) {
  const auto dimension = [&](std::size_t e) { return facts_of(elements.shapes[e]).dimension; };
  for (std::size_t e = 1; e < elements.size(); ++e) {
    if (dimension(e) == dimension(0)) continue;
    const std::size_t planar = dimension(e) == 2 ? e : 0;
    refuse_at(elements.places[planar],
              fmt::format("element {} is planar ({}), beside volumes ({}); {}",
                          elements.labels[planar], facts_of(elements.shapes[planar]).name,
                          facts_of(elements.shapes[planar == 0 ? e : 0]).name, mixed_remedy));
  }
}

void refuse_equal_nodes(const MeshDraft::Elements& elements, std::size_t element,
                        std::span<const std::int64_t> labels) {
  std::array<std::int64_t, 20> sorted{};
  std::copy(labels.begin(), labels.end(), sorted.begin());
  const auto end = sorted.begin() + static_cast<std::ptrdiff_t>(labels.size());
  std::sort(sorted.begin(), end);
  const auto twice = std::adjacent_find(sorted.begin(), end);
  if (twice == end) return;
  refuse_at(elements.places[element],
            fmt::format("element {} ({}) has node {} twice; expected nodes that differ: mesh it "
                        "without degenerate elements",
                        elements.labels[element], facts_of(elements.shapes[element]).name, *twice));
}

/// Positions of the nodes of all elements, one after the other.
std::vector<int> resolved_nodes(const MeshDraft::Elements& elements, const LabelIndex& nodes) {
  std::vector<int> positions(elements.connectivity.size());
  std::size_t first = 0;
  for (std::size_t e = 0; e < elements.size(); ++e) {
    const auto count = static_cast<std::size_t>(facts_of(elements.shapes[e]).num_nodes);
    const std::span labels(elements.connectivity.data() + first, count);
    for (std::size_t k = 0; k < count; ++k) {
      positions[first + k] = nodes.find(labels[k]);
      if (positions[first + k] >= 0) continue;
      refuse_at(elements.places[e],
                fmt::format("element {} ({}) has node {}, which the file does not define",
                            elements.labels[e], facts_of(elements.shapes[e]).name, labels[k]));
    }
    refuse_equal_nodes(elements, e, labels);
    first += count;
  }
  return positions;
}

/// Numbers the used nodes in the order of the file.
void number_used_nodes(AssembledMesh& result, const MeshDraft::Nodes& nodes,
                       std::span<const int> used) {
  result.rows.assign(nodes.size(), -1);
  for (const int position : used) result.rows[static_cast<std::size_t>(position)] = 0;
  int next = 0;
  for (int& row : result.rows) {
    if (row == 0) row = next++;
  }
  result.dropped_nodes = nodes.size() - static_cast<std::size_t>(next);
  result.mesh.nodes.resize(next, 3);
  result.mesh.node_labels.reserve(static_cast<std::size_t>(next));
  for (std::size_t k = 0; k < nodes.size(); ++k) {
    if (result.rows[k] < 0) continue;
    const auto& position = nodes.positions[k];
    result.mesh.nodes.row(result.rows[k]) << position[0], position[1], position[2];
    result.mesh.node_labels.push_back(nodes.labels[k]);
  }
}

/// Puts a planar mesh into z = 0.
void flatten(AssembledMesh& result, const MeshDraft::Nodes& nodes) {
  constexpr double tolerance = 1e-9;  // of the extent: round-off of what wrote the file
  Mesh::Nodes& positions = result.mesh.nodes;
  result.plane = positions(0, 2);
  const Eigen::RowVector3d extent = positions.colwise().maxCoeff() - positions.colwise().minCoeff();
  const double allowed = tolerance * std::max(extent.x(), extent.y());
  for (std::size_t k = 0; k < nodes.size(); ++k) {
    const double z = nodes.positions[k][2];
    if (result.rows[k] < 0 || std::abs(z - result.plane) <= allowed) continue;
    refuse_at(nodes.places[k],
              fmt::format("node {} has z = {}, others of this planar mesh {}; expected all in one "
                          "plane z = const: curved shells are not supported, turn a plane one",
                          nodes.labels[k], z, result.plane));
  }
  positions.col(2).setZero();
}

}  // namespace

void MeshDraft::Nodes::add(std::int64_t label, const std::array<double, 3>& position,
                           const TextPlace& place) {
  labels.push_back(label);
  positions.push_back(position);
  places.push_back(place);
}

void MeshDraft::Elements::add(ElementShape shape, std::int64_t label,
                              std::span<const std::int64_t> node_labels, const TextPlace& place) {
  labels.push_back(label);
  shapes.push_back(shape);
  places.push_back(place);
  connectivity.insert(connectivity.end(), node_labels.begin(), node_labels.end());
}

AssembledMesh assemble_mesh(MeshDraft draft, const SourceText& whole,
                            const std::string& mixed_remedy) {
  check_sizes(draft, whole);
  check_dimensions(draft.elements, mixed_remedy);
  AssembledMesh result;
  result.nodes = LabelIndex(draft.nodes.labels);
  refuse_repeated(result.nodes, draft.nodes.labels, draft.nodes.places, "node");
  result.elements = LabelIndex(draft.elements.labels);
  refuse_repeated(result.elements, draft.elements.labels, draft.elements.places, "element");

  std::vector<int> positions = resolved_nodes(draft.elements, result.nodes);
  number_used_nodes(result, draft.nodes, positions);
  if (facts_of(draft.elements.shapes.front()).dimension == 2) flatten(result, draft.nodes);

  Mesh& mesh = result.mesh;
  for (int& position : positions) position = result.rows[static_cast<std::size_t>(position)];
  mesh.first_node.reserve(draft.elements.size() + 1);
  for (const ElementShape shape : draft.elements.shapes) {
    mesh.first_node.push_back(mesh.first_node.back() +
                              static_cast<std::size_t>(facts_of(shape).num_nodes));
  }
  mesh.connectivity = std::move(positions);
  mesh.shapes = std::move(draft.elements.shapes);
  mesh.element_labels = std::move(draft.elements.labels);
  return result;
}

std::vector<int> rows_of(const AssembledMesh& assembled, std::span<const int> positions) {
  std::vector<int> rows;
  rows.reserve(positions.size());
  for (const int position : positions) {
    const int row = assembled.rows[static_cast<std::size_t>(position)];
    if (row >= 0) rows.push_back(row);
  }
  sort_unique(rows);
  return rows;
}

MeshSummary summary_of(const Mesh& mesh, const AssembledMesh& assembled, std::string format,
                       std::vector<std::string> skipped) {
  MeshSummary summary;
  summary.format = std::move(format);
  summary.num_nodes = mesh.num_nodes();
  summary.dropped_nodes = assembled.dropped_nodes;
  for (const ElementShape shape : mesh.shapes) ++summary.elements[shape];
  for (const auto& [name, nodes] : mesh.node_sets) summary.node_sets[name] = nodes.size();
  for (const auto& [name, elements] : mesh.element_sets)
    summary.element_sets[name] = elements.size();
  for (const auto& [name, sides] : mesh.surfaces) summary.surfaces[name] = sides.size();
  summary.skipped = std::move(skipped);
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const auto column = mesh.nodes.col(static_cast<Eigen::Index>(axis));
    const double shift = axis == 2 ? assembled.plane : 0.0;
    summary.lowest[axis] = column.minCoeff() + shift;
    summary.highest[axis] = column.maxCoeff() + shift;
  }
  return summary;
}

}  // namespace stridor
