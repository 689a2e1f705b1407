#include "substructures/bodies/beam_additions.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>

#include "core/errors.hpp"
#include "core/suggestion.hpp"

namespace stridor {
namespace {

constexpr std::array axis_names{"x", "y", "z"};

/// A node with its part in a load, or in the displacement of a point.
struct NodeShare {
  int node = 0;
  double share = 0.0;
};
using NodeShares = std::vector<NodeShare>;

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

/// Σ share u of nodes, along one axis; every DoF once.
DofSum sum_of(const BodyMatrices& body, const NodeShares& shares, std::size_t axis) {
  DofSum all;
  for (const NodeShare& share : shares) {
    for (const DofWeight& dof : body.displacement(share.node, axis))
      all.push_back({dof.dof, share.share * dof.weight});
  }
  std::stable_sort(all.begin(), all.end(),
                   [](const DofWeight& a, const DofWeight& b) { return a.dof < b.dof; });
  DofSum sum;
  for (const DofWeight& dof : all) {
    // Nodes of a guided end share one, and all that moves across.
    if (!sum.empty() && sum.back().dof == dof.dof) {
      sum.back().weight += dof.weight;
    } else {
      sum.push_back(dof);
    }
  }
  return sum;
}

/// The nodes that a spring holds.
NodeShares shares_of_spring(const std::string& key, const std::string& on,
                            const BodyMatrices& body) {
  const auto surface = body.surfaces.find(on);
  if (surface != body.surfaces.end()) return even_shares_of(surface->second);
  const auto point = body.points.find(on);
  if (point != body.points.end()) return {{point->second, 1.0}};
  std::vector<std::string> names;
  append_names(body.surfaces, names);
  append_names(body.points, names);
  throw ConfigError(
      key, fmt::format("there is no surface or point '{}'{}", on, known_names(on, names)));
}

void add_spring(const Eigen::Matrix3d& stiffness, const NodeShares& shares, const BodyMatrices& body,
                std::vector<Eigen::Triplet<double>>& entries) {
  for (const NodeShare& share : shares) {
    for (std::size_t i = 0; i < 3; ++i) {
      for (std::size_t j = 0; j < 3; ++j) {
        const double entry =
            share.share * stiffness(static_cast<Eigen::Index>(i), static_cast<Eigen::Index>(j));
        if (entry == 0.0) continue;
        for (const DofWeight& row : body.displacement(share.node, i)) {
          for (const DofWeight& column : body.displacement(share.node, j))
            entries.emplace_back(row.dof, column.dof, entry * row.weight * column.weight);
        }
      }
    }
  }
}

/// What a spring exerts when its ground end moves by 1 m along an axis.
DofSum ground_end(const Eigen::Matrix3d& stiffness, const NodeShares& shares,
                  const BodyMatrices& body, std::size_t moved) {
  DofSum load;
  for (std::size_t i = 0; i < 3; ++i) {
    const double force = stiffness(static_cast<Eigen::Index>(i), static_cast<Eigen::Index>(moved));
    if (force == 0.0) continue;
    for (const DofWeight& dof : sum_of(body, shares, i))
      load.push_back({dof.dof, force * dof.weight});
  }
  return load;
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

const Schema& BeamSpringParameters::schema() {
  using P = BeamSpringParameters;
  static const Schema keys =
      SchemaOf<P>("beam_spring")
          .text("on", &P::on,
                {.doc = "A surface, over which the spring is spread evenly, or a point."})
          .section("stiffness", &P::stiffness,
                   {.doc = "A number, along `direction`, or a matrix; of the whole spring.",
                    .number_key = "along"})
          .section("direction", &P::direction,
                   {.doc = "Of a stiffness that is a number: an angle in the plane against +x, or a "
                           "vector.",
                    .optional = true,
                    .number_key = "angle",
                    .list_key = "vector"})
          .check([](const P& spring, std::vector<Problem>& problems) {
            if (spring.direction.has_value() == spring.stiffness.along.has_value()) return;
            problems.push_back({"direction",
                                spring.direction
                                    ? "is not used: this stiffness is a matrix, which has its "
                                      "directions in itself"
                                    : "is missing: needed by a stiffness that is a number",
                                {},
                                0,
                                0});
          });
  return keys;
}

void add_motion_across(const BeamParameters& parameters, BodyMatrices& body) {
  const auto dof = static_cast<int>(body.num_dofs());
  add_dof(body.mass, parameters.material.density * parameters.length * parameters.thickness *
                         parameters.width);
  add_dof(body.stiffness, 0.0);
  body.across.assign(body.node_dofs.size(), dof);
  if (body.base_inertia.size() > 0) {
    body.base_inertia.conservativeResize(dof + 1);
    body.base_inertia(dof) = 0.0;
  }
}

void add_beam_point(const std::string& key, const std::string& name,
                    const BeamPointParameters& point, BodyMatrices& body) {
  if (body.points.contains(name) || body.surfaces.contains(name)) {
    throw ConfigError(key, fmt::format("'{}' is a point or surface of every beam; take another name",
                                       name));
  }
  const auto surface = body.surfaces.find(point.on);
  if (surface == body.surfaces.end()) {
    std::vector<std::string> names;
    append_names(body.surfaces, names);
    throw ConfigError(key + ".on", fmt::format("there is no surface '{}'{}", point.on,
                                               known_names(point.on, names)));
  }
  const std::vector<int>& nodes = surface->second;
  const Eigen::RowVector2d first = body.nodes.row(nodes.front());
  const double length = (body.nodes.row(nodes.back()) - first).norm();
  const auto num_edges = static_cast<int>(nodes.size() / 2);
  constexpr double on_a_node = 1e-9;  // of an edge
  const double place = num_edges * point.at / length;
  if (!(place <= num_edges * (1.0 + on_a_node))) {
    throw ConfigError(key + ".at", fmt::format("{:g} m lies beyond the surface '{}' of {:g} m",
                                               point.at, point.on, length));
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
  const auto node = static_cast<int>(body.node_dofs.size());
  body.nodes.conservativeResize(node + 1, Eigen::NoChange);
  body.nodes.row(node) =
      first + place / num_edges * (body.nodes.row(nodes.back()) - first);
  std::array<DofSum, 3> sums;
  for (std::size_t axis = 0; axis < 3; ++axis) sums[axis] = sum_of(body, shares, axis);
  body.node_dofs.push_back({BodyMatrices::held, BodyMatrices::held});
  if (!body.across.empty()) body.across.push_back(BodyMatrices::held);
  body.dependent[node] = std::move(sums);
  body.points[name] = node;
}

void add_beam_loads(BodyMatrices& body) {
  for (const auto& [name, nodes] : body.surfaces) {
    const NodeShares shares = even_shares_of(nodes);
    for (std::size_t axis = 0; axis < 3; ++axis) {
      DofSum load = sum_of(body, shares, axis);
      if (!load.empty()) body.loads[name + "." + axis_names[axis]] = std::move(load);
    }
  }
}

void add_beam_springs(const BeamParameters& parameters, BodyMatrices& body) {
  std::vector<Eigen::Triplet<double>> entries;
  for (const auto& [name, spring] : parameters.springs) {
    const std::string key = "springs." + name;
    if (body.surfaces.contains(name))
      throw ConfigError(key, fmt::format("'{}' is a surface; take another name", name));
    const NodeShares shares = shares_of_spring(key + ".on", spring.on, body);
    const Eigen::Vector3d along =
        spring.direction ? spring.direction->unit() : Eigen::Vector3d(Eigen::Vector3d::Zero());
    const Eigen::Matrix3d stiffness = spring_matrix(spring.stiffness, along);
    add_spring(stiffness, shares, body, entries);
    for (std::size_t axis = 0; axis < 3; ++axis)
      body.loads[name + "." + axis_names[axis]] = ground_end(stiffness, shares, body, axis);
  }
  if (entries.empty()) return;
  SparseMatrix springs(body.num_dofs(), body.num_dofs());
  springs.setFromTriplets(entries.begin(), entries.end());
  body.stiffness += springs;
}

}  // namespace stridor
