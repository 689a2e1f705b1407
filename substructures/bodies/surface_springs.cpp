#include "substructures/bodies/surface_springs.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <utility>

#include "core/errors.hpp"
#include "core/suggestion.hpp"

namespace stridor {
namespace {

constexpr std::array axis_names{"x", "y", "z"};

void add_spring(const Eigen::Matrix3d& stiffness, const NodeShares& shares,
                const BodyMatrices& body, std::vector<Eigen::Triplet<double>>& entries) {
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

/// Mean place of the nodes that share a spring, in the body's frame.
Eigen::Vector3d middle_of(const NodeShares& shares, const BodyMatrices& body) {
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  double total = 0.0;
  for (const auto& [node, share] : shares) {
    sum += share * body.nodes.row(node).transpose();
    total += share;
  }
  return total != 0.0 ? Eigen::Vector3d(sum / total) : sum;
}

}  // namespace

const Schema& SurfaceSpringParameters::schema() {
  using P = SurfaceSpringParameters;
  static const Schema keys =
      SchemaOf<P>("surface_spring")
          .text("on", &P::on,
                {.doc = "A surface, over which the spring is spread evenly, or a point."})
          .section("stiffness", &P::stiffness,
                   {.doc = "A number, along `direction`, or a matrix; of the whole spring.",
                    .number_key = "along"})
          .section("damping", &P::damping,
                   {.doc = "Of a damper beside it, likewise.",
                    .optional = true,
                    .number_key = "along"})
          .section(
              "direction", &P::direction,
              {.doc = "Of a stiffness that is a number: an angle in the plane against +x, or a "
                      "vector.",
               .optional = true,
               .number_key = "angle",
               .list_key = "vector"})
          .check([](const P& spring, std::vector<Problem>& problems) {
            const bool is_along =
                spring.stiffness.along || (spring.damping && spring.damping->along);
            if (spring.direction.has_value() == is_along) return;
            problems.push_back({Refusal::contradiction, "direction",
                                spring.direction
                                    ? "is not used: this stiffness is a matrix, which has its "
                                      "directions in itself"
                                    : "is missing: needed by a stiffness that is a number"});
          });
  return keys;
}

DofSum sum_of(const BodyMatrices& body, const NodeShares& shares, std::size_t axis) {
  DofSum all;
  for (const NodeShare& share : shares) {
    for (const DofWeight& dof : body.displacement(share.node, axis))
      all.push_back({dof.dof, share.share * dof.weight});
  }
  return merged(std::move(all));
}

DofSum merged(DofSum all) {
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

void add_dependent_point(const std::string& name, const Eigen::Vector3d& at,
                         const NodeShares& shares, BodyMatrices& body) {
  std::array<DofSum, 3> sums;
  for (std::size_t axis = 0; axis < 3; ++axis) sums[axis] = sum_of(body, shares, axis);
  add_dependent_point(name, at, std::move(sums), body);
}

void add_dependent_point(const std::string& name, const Eigen::Vector3d& at,
                         std::array<DofSum, 3> sums, BodyMatrices& body) {
  const auto node = static_cast<int>(body.node_dofs.size());
  body.nodes.conservativeResize(node + 1, Eigen::NoChange);
  body.nodes.row(node) = at.transpose();
  body.node_dofs.push_back({BodyMatrices::held, BodyMatrices::held});
  if (!body.across.empty()) body.across.push_back(BodyMatrices::held);
  body.dependent[node] = std::move(sums);
  body.points[name] = node;
}

void add_surface_loads(const std::string& name, const NodeShares& shares, BodyMatrices& body) {
  for (std::size_t axis = 0; axis < 3; ++axis) {
    DofSum load = sum_of(body, shares, axis);
    if (!load.empty()) body.loads[name + "." + axis_names[axis]] = std::move(load);
  }
}

void add_surface_springs(const std::map<std::string, SurfaceSpringParameters>& springs,
                         const std::function<NodeShares(const std::string& on)>& shares_of,
                         const std::vector<std::string>& known_names, BodyMatrices& body) {
  std::vector<Eigen::Triplet<double>> entries, damping_entries;
  for (const auto& [name, spring] : springs) {
    const std::string key = "springs." + name;
    if (body.surfaces.contains(name))
      throw ConfigError(Refusal::doubled_name, key,
                        fmt::format("'{}' is a surface; take another name", name));
    const NodeShares shares = shares_of(spring.on);
    if (shares.empty()) {
      throw ConfigError(
          Refusal::unknown_name, key + ".on",
          fmt::format("there is no surface or point '{}'{} (there are: {})", spring.on,
                      did_you_mean(spring.on, known_names), fmt::join(known_names, ", ")));
    }
    const Eigen::Vector3d along =
        spring.direction ? spring.direction->unit() : Eigen::Vector3d(Eigen::Vector3d::Zero());
    const Eigen::Matrix3d stiffness = spring_matrix(spring.stiffness, along);
    add_spring(stiffness, shares, body, entries);
    if (spring.damping)
      add_spring(spring_matrix(*spring.damping, along), shares, body, damping_entries);
    for (std::size_t axis = 0; axis < 3; ++axis)
      body.loads[name + "." + axis_names[axis]] = ground_end(stiffness, shares, body, axis);
    for (const Eigen::Vector3d& direction : spring_directions(spring.stiffness, along))
      body.springs.push_back({middle_of(shares, body), std::nullopt, direction});
  }
  const Eigen::Index n = body.num_dofs();
  if (!entries.empty()) {
    SparseMatrix stiffness(n, n);
    stiffness.setFromTriplets(entries.begin(), entries.end());
    body.stiffness += stiffness;
  }
  if (damping_entries.empty()) return;
  SparseMatrix damping(n, n);
  damping.setFromTriplets(damping_entries.begin(), damping_entries.end());
  if (body.velocity.size() == 0) {
    body.velocity.resize(n, n);
    body.circulatory.resize(n, n);
  }
  body.velocity += damping;
}

}  // namespace stridor
