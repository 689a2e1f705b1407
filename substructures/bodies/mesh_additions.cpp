#include "substructures/bodies/mesh_additions.hpp"

#include <Eigen/Eigenvalues>
#include <Eigen/Geometry>
#include <Eigen/LU>
#include <algorithm>
#include <cmath>

#include "core/errors.hpp"
#include "substructures/bodies/surface_springs.hpp"
#include "substructures/elements/mesh_point.hpp"

namespace stridor {
namespace {

class MeshAdditions {
 public:
  MeshAdditions(const MeshBodyParameters& parameters, const NamedMesh& named,
                const MeshConstraints& constraints, BodyMatrices& body)
      : parameters_(parameters),
        named_(named),
        mesh_(named.mesh),
        constraints_(constraints),
        body_(body) {}

  void add_all() {
    for (const auto& [name, region] : constraints_.regions) {
      add_dependent_point(name, region.at, region.displacement, body_);
      add_dependent_point(name + "_rotation", region.at, region.rotation, body_);
    }
    for (const auto& [name, point] : parameters_.points) add_point(name, point);
    for (const auto& [name, mass] : parameters_.masses) add_mass("masses." + name, mass);
    for (const auto& entry : mesh_.surfaces)
      add_surface_loads(entry.first, named_.even_shares(entry.first), body_);
    for (const auto& [name, load] : parameters_.loads) add_load(name, load);
    add_springs();
  }

 private:
  void add_point(const std::string& name, const MeshPointParameters& point) {
    const std::string key = "points." + name;
    if (mesh_.surfaces.contains(name))
      throw ConfigError(Refusal::doubled_name, key,
                        fmt::format("'{}' is a surface; take another name", name));
    if (body_.points.contains(name))
      throw ConfigError(Refusal::doubled_name, key,
                        fmt::format("'{}' is a point already; take another name", name));
    if (point.node) {
      body_.points[name] = labelled(*point.node, key + ".node");
    } else if (!point.mean_of.empty()) {
      add_mean(name, key, point);
    } else {
      add_place(name, key, point.at);
    }
  }

  int labelled(std::int64_t label, const std::string& key) const {
    const auto found = std::find(mesh_.node_labels.begin(), mesh_.node_labels.end(), label);
    if (found != mesh_.node_labels.end())
      return static_cast<int>(found - mesh_.node_labels.begin());
    throw ConfigError(Refusal::unknown_name, key,
                      fmt::format("no element of the mesh has a node {}", label));
  }

  void add_mean(const std::string& name, const std::string& key, const MeshPointParameters& point) {
    NodeShares shares = named_.even_shares(point.mean_of);
    if (shares.empty()) {
      const std::vector<int> nodes = named_.nodes_on({point.mean_of}, key + ".mean_of");
      for (const int node : nodes)
        shares.push_back({node, 1.0 / static_cast<double>(nodes.size())});
    }
    add_dependent(name, shares);
    if (point.rotation) add_mean_rotation(name, key, shares);
  }

  Eigen::Vector3d mean_place(const NodeShares& shares) const {
    Eigen::Vector3d place = Eigen::Vector3d::Zero();
    for (const NodeShare& share : shares)
      place += share.share * mesh_.nodes.row(share.node).transpose();
    return place;
  }

  /// A point that moves as Σ share u of nodes, and is where the same sum of places is.
  void add_dependent(const std::string& name, const NodeShares& shares) {
    add_dependent_point(name, mean_place(shares), shares, body_);
  }

  /// θ = J⁻¹ Σ share r x u with J = Σ share (|r|² 1 − r rᵀ): the rotation of least squares.
  void add_mean_rotation(const std::string& name, const std::string& key,
                         const NodeShares& shares) {
    const Eigen::Vector3d centre = mean_place(shares);
    const bool is_planar = named_.dimension == 2;
    Eigen::Matrix3d inertia = Eigen::Matrix3d::Zero();
    const auto arm_of = [&](int node) {
      Eigen::Vector3d arm = mesh_.nodes.row(node).transpose() - centre;
      if (is_planar) arm.z() = 0.0;
      return arm;
    };
    for (const NodeShare& share : shares) {
      const Eigen::Vector3d arm = arm_of(share.node);
      inertia +=
          share.share * (arm.squaredNorm() * Eigen::Matrix3d::Identity() - arm * arm.transpose());
    }
    const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> pairs(inertia);
    constexpr double least = 1e-12;
    if (is_planar ? !(inertia(2, 2) > 0.0)
                  : !(pairs.eigenvalues()(0) > least * pairs.eigenvalues()(2)))
      throw ConfigError(Refusal::wrong_mesh, key + ".rotation",
                        "is not defined: all nodes are on one line, about which they do not turn");
    const Eigen::Matrix3d inverse =
        is_planar ? Eigen::Matrix3d(Eigen::Vector3d(0.0, 0.0, 1.0 / inertia(2, 2)).asDiagonal())
                  : Eigen::Matrix3d(inertia.inverse());
    std::array<DofSum, 3> sums;
    for (std::size_t axis = 0; axis < 3; ++axis) {
      DofSum all;
      for (const NodeShare& share : shares) {
        // Row `axis` of J⁻¹ [r x].
        const Eigen::Vector3d weights =
            share.share *
            inverse.row(static_cast<Eigen::Index>(axis)).transpose().cross(arm_of(share.node));
        for (std::size_t i = 0; i < 3; ++i) {
          const double weight = weights(static_cast<Eigen::Index>(i));
          if (weight == 0.0) continue;
          for (const DofWeight& dof : body_.displacement(share.node, i))
            all.push_back({dof.dof, weight * dof.weight});
        }
      }
      sums[axis] = merged(std::move(all));
    }
    add_dependent_point(name + "_rotation", centre, std::move(sums), body_);
  }

  void add_place(const std::string& name, const std::string& key,
                 const std::vector<double>& given) {
    const MeshPoint found =
        find_point(mesh_, named_.turned(given), share_of_extent * extent_of(mesh_));
    if (found.weights.empty()) {
      throw ConfigError(
          Refusal::off_the_surface, key + ".at",
          fmt::format("lies outside of the mesh: its nearest node, {}, is at {}, {:.4g} m away",
                      mesh_.node_labels[static_cast<std::size_t>(found.nearest)],
                      named_.place_text(found.nearest), found.distance));
    }
    if (found.nodes.size() == 1) {
      body_.points[name] = found.nodes.front();
      return;
    }
    NodeShares shares;
    for (std::size_t i = 0; i < found.nodes.size(); ++i)
      shares.push_back({found.nodes[i], found.weights[i]});
    add_dependent(name, shares);
  }

  /// M += m Σ s sᵀ over the displacements s of a point; likewise with its rotations.
  void add_mass(const std::string& key, const MeshMassParameters& mass) {
    const auto point = body_.points.find(mass.on);
    if (point == body_.points.end()) {
      throw ConfigError(Refusal::unknown_name, key + ".on",
                        fmt::format("there is no point or rigid region '{}'{}", mass.on,
                                    known(mass.on, names_of(body_.points))));
    }
    std::vector<Eigen::Triplet<double>> entries;
    const auto add = [&](const DofSum& sum, double inertia) {
      constexpr std::size_t most = 600;
      if (sum.size() > most)
        throw ConfigError(
            Refusal::contradiction, key + ".on",
            fmt::format("'{}' is a mean over {} unknowns, all of which the mass would "
                        "couple; make it a rigid region",
                        mass.on, sum.size()));
      for (const DofWeight& row : sum)
        for (const DofWeight& column : sum)
          entries.emplace_back(row.dof, column.dof, inertia * row.weight * column.weight);
    };
    for (std::size_t i = 0; i < 3; ++i) add(body_.displacement(point->second, i), mass.mass);
    if (body_.follows_drive())
      for (const DofWeight& dof : body_.displacement(point->second, 0))
        body_.base_inertia(dof.dof) += mass.mass * dof.weight;
    if (!mass.inertia.empty()) {
      if (!constraints_.regions.contains(mass.on))
        throw ConfigError(Refusal::contradiction, key + ".inertia",
                          fmt::format("is of a rigid region; '{}' is a point", mass.on));
      const std::size_t expected = named_.dimension == 2 ? 1 : 3;
      if (mass.inertia.size() != expected)
        throw ConfigError(Refusal::wrong_size, key + ".inertia",
                          expected == 1 ? "is one number in a plane" : "is three numbers in space");
      const int rotation = body_.points.at(mass.on + "_rotation");
      for (std::size_t i = 0; i < expected; ++i)
        add(body_.displacement(rotation, expected == 1 ? 2 : i), mass.inertia[i]);
    }
    SparseMatrix added(body_.num_dofs(), body_.num_dofs());
    added.setFromTriplets(entries.begin(), entries.end());
    body_.mass += added;
  }

  /// A pressure or traction of 1 N over the area of its surfaces.
  void add_load(const std::string& name, const MeshLoadParameters& load) {
    const std::string key = "loads." + name;
    if (mesh_.surfaces.contains(name) || body_.points.contains(name) ||
        parameters_.springs.contains(name))
      throw ConfigError(Refusal::doubled_name, key,
                        fmt::format("'{}' is a surface, point or spring; take another name", name));
    const MeshSections sections = named_.sections();
    std::vector<ElementSide> sides;
    for (const std::string& on : load.on) {
      const std::vector<ElementSide>& more = named_.surface(on, key + ".on");
      sides.insert(sides.end(), more.begin(), more.end());
    }
    std::sort(sides.begin(), sides.end());
    sides.erase(std::unique(sides.begin(), sides.end()), sides.end());
    const double area = node_areas(mesh_, sections, sides).sum();
    const Eigen::VectorXd forces =
        load.direction.empty() ? pressure_load(mesh_, sections, sides, 1.0 / area)
                               : traction_load(mesh_, sections, sides,
                                               named_.turned(load.direction).normalized() / area);
    DofSum all;
    for (std::size_t row = 0; row < constraints_.rows.size(); ++row) {
      const double force = forces(static_cast<Eigen::Index>(row));
      if (force == 0.0) continue;
      for (const DofWeight& dof : constraints_.rows[row])
        all.push_back({dof.dof, force * dof.weight});
    }
    body_.loads[name] = merged(std::move(all));
    if (body_.loads[name].empty())
      throw ConfigError(Refusal::motion_is_held, key, "acts on held nodes alone");
  }

  void add_springs() {
    const auto shares_of = [&](const std::string& on) -> NodeShares {
      const auto point = body_.points.find(on);
      if (point != body_.points.end()) return {{point->second, 1.0}};
      NodeShares shares = named_.even_shares(on);
      // A spring at each node, none of them negative.
      double sum = 0.0;
      for (NodeShare& share : shares) sum += share.share = std::abs(share.share);
      for (NodeShare& share : shares) share.share /= sum;
      return shares;
    };
    std::vector<std::string> names = names_of(mesh_.surfaces);
    for (const std::string& name : names_of(body_.points)) names.push_back(name);
    add_surface_springs(parameters_.springs, shares_of, names, body_);
  }

  const MeshBodyParameters& parameters_;
  const NamedMesh& named_;
  const Mesh& mesh_;
  const MeshConstraints& constraints_;
  BodyMatrices& body_;
};

}  // namespace

void add_to_mesh_body(const MeshBodyParameters& parameters, const NamedMesh& mesh,
                      const MeshConstraints& constraints, BodyMatrices& body) {
  MeshAdditions(parameters, mesh, constraints, body).add_all();
}

}  // namespace stridor
