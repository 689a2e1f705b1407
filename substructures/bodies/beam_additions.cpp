#include "substructures/bodies/beam_additions.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>

#include "core/errors.hpp"
#include "core/suggestion.hpp"

namespace stridor {
namespace {

template <class Map>
void append_names(const Map& map, std::vector<std::string>& names) {
  for (const auto& entry : map) names.push_back(entry.first);
}

std::string known_names(const std::string& written, const std::vector<std::string>& names) {
  return fmt::format("{} (there are: {})", did_you_mean(written, names), fmt::join(names, ", "));
}

/// Part of an even load that each node of a surface of quadratic edges carries: Simpson's weights.
NodeShares even_shares_of(const std::vector<int>& nodes) {
  NodeShares shares;
  for (const int node : nodes) shares.push_back({node, 0.0});
  const std::size_t num_edges = nodes.size() / 2;
  constexpr std::array simpson{1.0 / 6.0, 4.0 / 6.0, 1.0 / 6.0};
  for (std::size_t edge = 0; edge < num_edges; ++edge) {
    for (std::size_t i = 0; i < simpson.size(); ++i)
      shares[2 * edge + i].share += simpson[i] / static_cast<double>(num_edges);
  }
  return shares;
}

void add_dof(SparseMatrix& matrix, double diagonal) {
  const Eigen::Index n = matrix.rows();
  matrix.conservativeResize(n + 1, n + 1);
  if (diagonal != 0.0) matrix.insert(n, n) = diagonal;
  matrix.makeCompressed();
}

}  // namespace

const Schema& BeamPointParameters::schema() {
  using P = BeamPointParameters;
  static const Schema keys =
      SchemaOf<P>("beam_point")
          .text("on", &P::on, {.doc = "The surface: top, bottom, start_face or end_face."})
          .real("at", &P::at,
                {.doc = "Along the surface from its first node; top begins at the start of the "
                        "axis, bottom at its end. Between nodes the point moves as the edge of the "
                        "element does.",
                 .unit = "m",
                 .range = Range::non_negative()});
  return keys;
}

void add_motion_across(const BeamParameters& parameters, BodyMatrices& body) {
  const auto dof = static_cast<int>(body.num_dofs());
  add_dof(body.mass, parameters.material.density * parameters.length * parameters.thickness *
                         parameters.width);
  add_dof(body.stiffness, 0.0);
  body.across.assign(body.node_dofs.size(), dof);
  body.kept.push_back(dof);
  if (body.base_inertia.size() > 0) {
    body.base_inertia.conservativeResize(dof + 1);
    body.base_inertia(dof) = 0.0;
  }
}

void add_beam_point(const std::string& key, const std::string& name,
                    const BeamPointParameters& point, BodyMatrices& body) {
  if (body.points.contains(name) || body.surfaces.contains(name)) {
    throw ConfigError(
        Refusal::doubled_name, key,
        fmt::format("'{}' is a point or surface of every beam; take another name", name));
  }
  const auto surface = body.surfaces.find(point.on);
  if (surface == body.surfaces.end()) {
    std::vector<std::string> names;
    append_names(body.surfaces, names);
    throw ConfigError(
        Refusal::unknown_name, key + ".on",
        fmt::format("there is no surface '{}'{}", point.on, known_names(point.on, names)));
  }
  const std::vector<int>& nodes = surface->second;
  const Eigen::RowVector3d first = body.nodes.row(nodes.front());
  const double length = (body.nodes.row(nodes.back()) - first).norm();
  const auto num_edges = static_cast<int>(nodes.size() / 2);
  constexpr double on_a_node = 1e-9;  // of an edge
  const double place = num_edges * point.at / length;
  if (!(place <= num_edges * (1.0 + on_a_node))) {
    throw ConfigError(
        Refusal::off_the_surface, key + ".at",
        fmt::format("{:g} m lies beyond the surface '{}' of {:g} m", point.at, point.on, length));
  }
  const double nearest = std::round(2.0 * place);
  if (std::abs(2.0 * place - nearest) <= on_a_node) {
    body.points[name] = nodes[static_cast<std::size_t>(nearest)];
    return;
  }
  const int edge = std::clamp(static_cast<int>(std::floor(place)), 0, num_edges - 1);
  const double x = 2.0 * (place - edge) - 1.0;
  const auto node_of = [&](int i) { return nodes[static_cast<std::size_t>(2 * edge + i)]; };
  const NodeShares shares{{node_of(0), 0.5 * x * (x - 1.0)},
                          {node_of(1), 1.0 - x * x},
                          {node_of(2), 0.5 * x * (x + 1.0)}};
  const Eigen::RowVector3d at = first + place / num_edges * (body.nodes.row(nodes.back()) - first);
  add_dependent_point(name, at.transpose(), shares, body);
}

void add_beam_loads(BodyMatrices& body) {
  for (const auto& [name, nodes] : body.surfaces)
    add_surface_loads(name, even_shares_of(nodes), body);
}

void add_beam_springs(const BeamParameters& parameters, BodyMatrices& body) {
  std::vector<std::string> names;
  append_names(body.surfaces, names);
  append_names(body.points, names);
  const auto shares_of = [&](const std::string& on) -> NodeShares {
    const auto surface = body.surfaces.find(on);
    if (surface != body.surfaces.end()) return even_shares_of(surface->second);
    const auto point = body.points.find(on);
    if (point != body.points.end()) return {{point->second, 1.0}};
    return {};
  };
  add_surface_springs(parameters.springs, shares_of, names, body);
}

}  // namespace stridor
