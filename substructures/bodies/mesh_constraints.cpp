#include "substructures/bodies/mesh_constraints.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <optional>
#include <string_view>

#include "core/errors.hpp"
#include "substructures/bodies/free_motions.hpp"
#include "substructures/elements/mesh_surfaces.hpp"
#include "substructures/elements/side_search.hpp"
#include "substructures/matrices/dof_sum.hpp"

namespace stridor {
namespace {

/// What a support holds, read from its words.
struct HeldDirections {
  std::array<bool, 3> along{};  ///< x, y, z
  std::array<bool, 3> about{};  ///< rotations
  std::array<bool, 3> round{};  ///< radial, tangential, axial
  bool is_round() const { return round[0] || round[1] || round[2]; }
};

HeldDirections held_directions(const MeshSupportParameters& support) {
  constexpr std::array<std::string_view, 3> of_axes{"x", "y", "z"};
  constexpr std::array<std::string_view, 3> of_rotations{"rx", "ry", "rz"};
  constexpr std::array<std::string_view, 3> of_line{"radial", "tangential", "axial"};
  HeldDirections held;
  for (std::size_t i = 0; i < 3; ++i) {
    const auto has = [&](std::string_view word) {
      return std::find(support.held.begin(), support.held.end(), word) != support.held.end();
    };
    held.along[i] = support.held.empty() || has(of_axes[i]);
    held.about[i] = support.held.empty() || has(of_rotations[i]);
    held.round[i] = has(of_line[i]);
  }
  return held;
}

/// What holds one node.
struct NodeState {
  std::array<bool, 3> absent{};              ///< matrices from elsewhere have no row for it
  std::array<bool, 3> held{};                ///< along x, y, z
  std::vector<Eigen::Vector3d> held_across;  ///< along other directions, of length 1
  std::vector<Eigen::Vector3d> frame;        ///< in which its free directions are looked for
  bool is_guided = false;
  int region = -1;
  bool is_held() const { return held[0] || held[1] || held[2] || !held_across.empty(); }
};

class ConstraintBuilder {
 public:
  ConstraintBuilder(const MeshBodyParameters& parameters, NamedMesh& mesh)
      : parameters_(parameters), mesh_(mesh), d_(static_cast<std::size_t>(mesh.dimension)),
        nodes_(mesh.mesh.num_nodes()) {
    if (mesh.given() != nullptr) take_rows(*mesh.given());
  }

  MeshConstraints build() {
    mark_regions();
    for (const auto& [name, support] : parameters_.supports) mark_support(name, support);
    mark_guide();
    find_ties();
    made_.rows.resize(d_ * nodes_.size());
    for (std::size_t node = 0; node < nodes_.size(); ++node) number_node(node);
    number_regions();
    for (const auto& [node, point] : ties_) follow_face(node, point);
    for (std::size_t row = 0; row < other_rows_.size(); ++row)
      if (other_rows_[row] == OtherRow::free) made_.others[row] = made_.num_dofs++;
    if (made_.num_dofs == 0)
      throw ConfigError(Refusal::motion_is_held, "supports", "hold every node of the body");
    if (parameters_.guided && made_.load_dof == BodyMatrices::held)
      throw ConfigError(Refusal::motion_is_held, "guided.on",
                        "no node of it moves along y, so the drive has no load on it");
    if (mesh_.given() == nullptr) made_.determinate = determinate_dofs(mesh_.mesh, made_);
    return std::move(made_);
  }

 private:
  /// A row of matrices from elsewhere.
  enum class OtherRow { displacement, free, held };

  /// What they have no displacement for is held; what is no displacement of a node is a DoF.
  void take_rows(const NodalMatrices& given) {
    const auto num_rows = static_cast<std::size_t>(given.mass.rows());
    other_rows_.assign(num_rows, OtherRow::free);
    made_.others.assign(num_rows, BodyMatrices::held);
    for (std::size_t k = 0; k < given.rows.size(); ++k) {
      if (given.rows[k] == BodyMatrices::held) {
        nodes_[k / d_].absent[k % d_] = nodes_[k / d_].held[k % d_] = true;
      } else {
        other_rows_[static_cast<std::size_t>(given.rows[k])] = OtherRow::displacement;
      }
    }
  }

  /// Rotations of a node that is held in all directions.
  void hold_rotations(int node) {
    if (mesh_.given() == nullptr || mesh_.given()->rotations.empty()) return;
    for (std::size_t axis = 0; axis < 3; ++axis) {
      const int row = mesh_.given()->rotations[3 * static_cast<std::size_t>(node) + axis];
      if (row != BodyMatrices::held) other_rows_[static_cast<std::size_t>(row)] = OtherRow::held;
    }
  }

  [[noreturn]] void refuse_node(const std::string& key, int node, const std::string& why) const {
    throw ConfigError(
        Refusal::wrong_mesh, key,
        fmt::format("node {} at {} {}", mesh_.mesh.node_labels[static_cast<std::size_t>(node)],
                    mesh_.place_text(node), why));
  }

  NodeState& state(int node) { return nodes_[static_cast<std::size_t>(node)]; }

  void mark_regions() {
    int number = 0;
    for (const auto& [name, region] : parameters_.rigid_regions) {
      const std::string key = "rigid_regions." + name;
      if (mesh_.mesh.surfaces.contains(name) || parameters_.points.contains(name))
        throw ConfigError(Refusal::doubled_name, key,
                          fmt::format("'{}' is a surface or point; take another name", name));
      region_names_.push_back(name);
      std::vector<int>& nodes = region_nodes_.emplace_back();
      for (const int node : mesh_.nodes_on(region.on, key + ".on")) {
        if (state(node).region == number) continue;
        if (state(node).region >= 0) {
          refuse_node(key + ".on", node,
                      fmt::format("is in the rigid region '{}' as well",
                                  region_names_[static_cast<std::size_t>(state(node).region)]));
        }
        state(node).region = number;
        nodes.push_back(node);
      }
      region_held_.emplace_back();
      ++number;
    }
  }

  void mark_support(const std::string& name, const MeshSupportParameters& support) {
    const std::string key = "supports." + name;
    const HeldDirections held = held_directions(support);
    const bool is_named = !support.held.empty();
    if (d_ == 2 && is_named && (held.along[2] || held.round[2]))
      throw ConfigError(Refusal::motion_is_held, key + ".held",
                        "a planar body does not move along z");
    if (d_ == 2 && is_named && (held.about[0] || held.about[1]))
      throw ConfigError(Refusal::motion_is_held, key + ".held",
                        "a planar body turns about z alone");
    const AxisOfRevolution axis =
        support.about ? support.about->axis(mesh_.turn) : AxisOfRevolution{};
    if (d_ == 2 && held.is_round() && !(axis.direction - Eigen::Vector3d::UnitZ()).isZero(1e-9))
      throw ConfigError(Refusal::wrong_mesh, key + ".about.direction", "is z for a planar mesh");
    for (const std::string& on : support.on) {
      const auto region = std::find(region_names_.begin(), region_names_.end(), on);
      if (region != region_names_.end()) {
        if (held.is_round())
          throw ConfigError(Refusal::motion_is_held, key + ".held",
                            fmt::format("'{}' is a rigid region, which is held along "
                                        "x, y, z and about rx, ry, rz",
                                        on));
        HeldDirections& of_region =
            region_held_[static_cast<std::size_t>(region - region_names_.begin())];
        for (std::size_t i = 0; i < 3; ++i) {
          of_region.along[i] |= held.along[i];
          of_region.about[i] |= held.about[i];
        }
        continue;
      }
      if (is_named && (held.about[0] || held.about[1] || held.about[2]))
        throw ConfigError(Refusal::contradiction, key + ".held",
                          fmt::format("'{}' is no rigid region, so that it has no rotations", on));
      for (const int node : mesh_.nodes_on({on}, key + ".on")) hold_node(key, node, held, axis);
    }
  }

  void hold_node(const std::string& key, int node, const HeldDirections& held,
                 const AxisOfRevolution& axis) {
    NodeState& at = state(node);
    if (at.region >= 0) {
      refuse_node(key + ".on", node,
                  fmt::format("is in the rigid region '{0}'; hold '{0}' itself",
                              region_names_[static_cast<std::size_t>(at.region)]));
    }
    for (std::size_t i = 0; i < 3; ++i) at.held[i] |= held.along[i];
    if (held.about[0] && held.about[1] && held.about[2]) hold_rotations(node);
    if (!held.is_round()) return;
    const auto frame = axis.frame_at(mesh_.mesh.nodes.row(node).transpose());
    if (!frame) refuse_node(key + ".on", node, "is on the line, where nothing is radial");
    for (std::size_t i = 0; i < 3; ++i) {
      const Eigen::Vector3d direction = frame->col(static_cast<Eigen::Index>(i));
      if (i < d_) at.frame.push_back(direction);
      if (held.round[i]) at.held_across.push_back(direction);
    }
  }

  void mark_guide() {
    if (!parameters_.guided) return;
    for (const int node : mesh_.nodes_on(parameters_.guided->on, "guided.on")) {
      if (state(node).region >= 0) refuse_node("guided.on", node, "is in a rigid region as well");
      state(node).is_guided = true;
      hold_rotations(node);
    }
  }

  void find_ties() {
    for (const auto& [name, tie] : parameters_.ties) {
      const std::string key = "ties." + name;
      const auto& slave = mesh_.surface(tie.slave, key + ".slave");
      const auto& master = mesh_.surface(tie.master, key + ".master");
      const std::vector<int> master_nodes = nodes_of(mesh_.mesh, master);
      const SideSearch search(mesh_.mesh, master);
      std::map<int, SidePoint> found;
      for (const int node : nodes_of(mesh_.mesh, slave)) {
        if (std::binary_search(master_nodes.begin(), master_nodes.end(), node)) continue;
        if (state(node).is_guided || ties_.contains(node)) continue;
        constexpr double share = 0.05;
        const auto point =
            search.nearest(mesh_.mesh.nodes.row(node).transpose(), tie.tolerance, share);
        if (point) {
          check_slave(key, node);
          found.emplace(node, *point);
        } else if (!tie.partial) {
          refuse_node(key, node,
                      fmt::format("is not on a face of '{}'; give a larger tolerance, or `partial: "
                                  "true` where only a part of '{}' touches",
                                  tie.master, tie.slave));
        }
      }
      if (found.empty())
        throw ConfigError(Refusal::wrong_mesh, key,
                          fmt::format("ties nothing: no node of '{}' is on a face of '{}'",
                                      tie.slave, tie.master));
      for (auto& [node, point] : found) {
        mesh_.mesh.nodes.row(node) = point.place.transpose();
        ties_.emplace(node, std::move(point));
      }
    }
    for (const auto& [node, point] : ties_) {
      for (std::size_t i = 0; i < point.nodes.size(); ++i)
        if (point.weights[i] != 0.0 && ties_.contains(point.nodes[i]))
          refuse_node("ties", point.nodes[i], "is a master and a slave; let one side lead");
    }
  }

  void check_slave(const std::string& key, int node) {
    if (state(node).region >= 0)
      refuse_node(key, node, "of the slave is in a rigid region; let that side be the master");
    if (!state(node).held_across.empty())
      refuse_node(key, node, "of the slave is held about a line; let that side be the master");
  }

  DofSum next_dof() { return {{made_.num_dofs++, 1.0}}; }

  void number_node(std::size_t node) {
    const NodeState& at = nodes_[node];
    const bool is_tied = ties_.contains(static_cast<int>(node));
    if (at.region >= 0 || is_tied) return;
    DofSum* const rows = &made_.rows[d_ * node];
    if (at.is_guided) {
      if (at.absent[1]) return;
      if (made_.load_dof == BodyMatrices::held) made_.load_dof = made_.num_dofs++;
      rows[1] = {{made_.load_dof, 1.0}};
      return;
    }
    if (at.held_across.empty()) {
      for (std::size_t i = 0; i < d_; ++i)
        if (!at.held[i]) rows[i] = next_dof();
      return;
    }
    for (const Eigen::Vector3d& direction : free_directions(at)) {
      const int dof = made_.num_dofs++;
      for (std::size_t i = 0; i < d_; ++i) {
        const double weight = direction(static_cast<Eigen::Index>(i));
        if (weight != 0.0) rows[i].push_back({dof, weight});
      }
    }
  }

  /// Orthonormal, across all directions in which a node is held.
  std::vector<Eigen::Vector3d> free_directions(const NodeState& at) const {
    std::vector<Eigen::Vector3d> taken;
    constexpr double same = 1e-6;
    const auto rest = [&](Eigen::Vector3d vector) {
      for (int pass = 0; pass < 2; ++pass)
        for (const Eigen::Vector3d& other : taken) vector -= other.dot(vector) * other;
      return vector;
    };
    const auto take = [&](const Eigen::Vector3d& vector) {
      if (vector.norm() > same) taken.push_back(vector.normalized());
    };
    for (std::size_t i = 0; i < 3; ++i)
      if (at.held[i] || i >= d_) take(rest(Eigen::Vector3d::Unit(static_cast<Eigen::Index>(i))));
    for (const Eigen::Vector3d& direction : at.held_across) take(rest(direction));
    const auto num_held = static_cast<std::ptrdiff_t>(taken.size());
    while (taken.size() < 3) {
      Eigen::Vector3d best = Eigen::Vector3d::Zero();
      for (const Eigen::Vector3d& direction : at.frame)
        if (rest(direction).norm() > best.norm() + same) best = rest(direction);
      take(best);
    }
    return {taken.begin() + num_held, taken.end()};
  }

  void number_regions() {
    for (std::size_t number = 0; number < region_names_.size(); ++number) {
      const std::string& name = region_names_[number];
      const MeshRigidRegionParameters& given = parameters_.rigid_regions.at(name);
      RigidRegion region;
      for (const int node : region_nodes_[number])
        region.at += mesh_.mesh.nodes.row(node).transpose();
      region.at /= static_cast<double>(region_nodes_[number].size());
      if (!given.at.empty()) region.at = mesh_.turned(given.at);
      const HeldDirections& held = region_held_[number];
      for (std::size_t i = 0; i < 3; ++i)
        if (i < d_ && !held.along[i]) region.displacement[i] = next_dof();
      for (std::size_t i = 0; i < 3; ++i)
        if ((d_ == 3 || i == 2) && !held.about[i]) region.rotation[i] = next_dof();
      for (const int node : region_nodes_[number]) {
        const Eigen::Vector3d arm = mesh_.mesh.nodes.row(node).transpose() - region.at;
        for (std::size_t i = 0; i < d_; ++i) {
          // (θ x r)_i = θ_j r_k − θ_k r_j
          const std::size_t j = (i + 1) % 3;
          const std::size_t k = (i + 2) % 3;
          DofSum row = region.displacement[i];
          append(row, scaled(region.rotation[j], arm(static_cast<Eigen::Index>(k))));
          append(row, scaled(region.rotation[k], -arm(static_cast<Eigen::Index>(j))));
          made_.rows[d_ * static_cast<std::size_t>(node) + i] = gathered(std::move(row));
        }
      }
      made_.regions.emplace(name, std::move(region));
    }
  }

  /// A tied node moves as the face does, but for where it is held.
  void follow_face(int node, const SidePoint& point) {
    for (std::size_t i = 0; i < d_; ++i) {
      if (state(node).held[i]) continue;
      DofSum row;
      for (std::size_t b = 0; b < point.nodes.size(); ++b)
        append(row, scaled(made_.rows[d_ * static_cast<std::size_t>(point.nodes[b]) + i],
                           point.weights[b]));
      made_.rows[d_ * static_cast<std::size_t>(node) + i] = gathered(std::move(row));
    }
  }

  const MeshBodyParameters& parameters_;
  NamedMesh& mesh_;
  std::size_t d_;
  std::vector<NodeState> nodes_;
  std::vector<std::string> region_names_;
  std::vector<std::vector<int>> region_nodes_;
  std::vector<HeldDirections> region_held_;
  std::map<int, SidePoint> ties_;
  std::vector<OtherRow> other_rows_;
  MeshConstraints made_;
};

}  // namespace

SparseMatrix MeshConstraints::matrix() const {
  std::vector<Eigen::Triplet<double>> entries;
  for (std::size_t row = 0; row < rows.size(); ++row)
    for (const DofWeight& dof : rows[row])
      entries.emplace_back(static_cast<int>(row), dof.dof, dof.weight);
  SparseMatrix matrix(static_cast<Eigen::Index>(rows.size()), num_dofs);
  matrix.setFromTriplets(entries.begin(), entries.end());
  return matrix;
}

SparseMatrix MeshConstraints::matrix(const NodalMatrices& given) const {
  std::vector<Eigen::Triplet<double>> entries;
  for (std::size_t k = 0; k < rows.size(); ++k)
    for (const DofWeight& dof : rows[k]) entries.emplace_back(given.rows[k], dof.dof, dof.weight);
  for (std::size_t row = 0; row < others.size(); ++row)
    if (others[row] != BodyMatrices::held)
      entries.emplace_back(static_cast<int>(row), others[row], 1.0);
  SparseMatrix matrix(given.mass.rows(), num_dofs);
  matrix.setFromTriplets(entries.begin(), entries.end());
  return matrix;
}

MeshConstraints make_constraints(const MeshBodyParameters& parameters, NamedMesh& mesh) {
  return ConstraintBuilder(parameters, mesh).build();
}

}  // namespace stridor
