// A mesh with supports, surfaces, points and springs.
#include "substructures/bodies/meshed_body.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <numeric>
#include <stdexcept>
#include <utility>

#include "core/errors.hpp"
#include "core/suggestion.hpp"
#include "core/units.hpp"
#include "substructures/elements/assembly.hpp"
#include "substructures/elements/mesh_point.hpp"

namespace stridor {
namespace {

constexpr double share_of_extent = 1e-6;

template <class Map>
std::vector<std::string> names_of(const Map& map) {
  std::vector<std::string> names;
  for (const auto& entry : map) names.push_back(entry.first);
  return names;
}

std::string known(const std::string& written, const std::vector<std::string>& names) {
  if (names.empty()) return " (there are none)";
  return fmt::format("{} (there are: {})", did_you_mean(written, names), fmt::join(names, ", "));
}

/// A mesh in metres with the surfaces that a scene adds, and what its matrices are made of.
class MeshedBody {
 public:
  /// @param given matrices from elsewhere; null: those of the elements
  explicit MeshedBody(const MeshBodyParameters& parameters, const NodalMatrices* given = nullptr)
      : parameters_(parameters), given_(given), turn_(turn_by(parameters.angle)) {
    if (!parameters.mesh)
      throw std::invalid_argument("MeshBodyParameters: the mesh has not been read");
    mesh_ = *parameters.mesh;
    mesh_.nodes *= scale();
    if (given_ != nullptr) {
      take_dimension();
    } else {
      find_dimension();
      check_plane();
    }
    add_surfaces();
    mesh_.nodes.leftCols<2>() *= turn_.transpose();
  }

  BodyMatrices make() {
    const NodalMatrices own = given_ == nullptr ? of_elements() : NodalMatrices();
    const NodalMatrices& all = given_ == nullptr ? own : *given_;
    BodyMatrices body;
    body.damping = all.damping;
    body.nodes = mesh_.nodes;
    number_dofs(all, body);
    constrain(all, body);
    add_outlines(body);
    add_points(body);
    add_loads_and_springs(body);
    return body;
  }

  const Mesh& mesh() const { return mesh_; }

 private:
  using Nodes = std::vector<int>;

  double scale() const {
    try {
      return parse_quantity("1 " + parameters_.length_unit, "m");
    } catch (const std::invalid_argument& error) {
      throw ConfigError("length_unit", error.what());
    }
  }

  void find_dimension() {
    try {
      dimension_ = mesh_.dimension();
    } catch (const std::invalid_argument&) {
      throw ConfigError("file",
                        "has planar elements beside volumes; give a mesh of one kind, of which "
                        "edges or faces are groups");
    }
  }

  void take_dimension() {
    dimension_ = given_->dimension;
    if (given_->rows.size() != static_cast<std::size_t>(dimension_) * mesh_.num_nodes())
      throw std::invalid_argument("make_meshed_body: the matrices are of another mesh");
  }

  /// Every displacement of every node.
  NodalMatrices of_elements() const {
    MeshMatrices assembled = [&] {
      try {
        return assemble_mesh(mesh_, sections());
      } catch (const std::invalid_argument& error) {
        throw ConfigError("file", error.what());
      }
    }();
    NodalMatrices all{dimension_, std::move(assembled.mass), std::move(assembled.stiffness),
                      parameters_.damping, {}, {}, {}, {}};
    all.rows.resize(static_cast<std::size_t>(all.mass.rows()));
    std::iota(all.rows.begin(), all.rows.end(), 0);
    return all;
  }

  void check_plane() const {
    if (dimension_ == 2 && !parameters_.thickness)
      throw ConfigError("thickness", "is missing: the mesh is planar");
    if (dimension_ == 3 && parameters_.thickness)
      throw ConfigError("thickness", "is of a planar mesh; this one has volumes");
  }

  void add_surfaces() {
    if (parameters_.surfaces.empty()) return;
    if (mesh_.num_elements() == 0) return add_node_sets();
    const std::vector<ElementSide> outer = outer_sides(mesh_);
    const double extent = extent_of(mesh_);
    for (const auto& [name, given] : parameters_.surfaces) {
      const std::string key = "surfaces." + name;
      if (mesh_.surfaces.contains(name))
        throw ConfigError(key, "the file has a surface of this name; take another");
      std::vector<ElementSide> sides = sides_within(
          mesh_, outer, given.region(), given.tolerance.value_or(share_of_extent * extent));
      if (sides.empty()) refuse_empty(key, "no outer side of an element");
      mesh_.surfaces[name] = std::move(sides);
    }
  }

  [[noreturn]] void refuse_empty(const std::string& key, const char* what) const {
    const Eigen::RowVector3d low = mesh_.nodes.colwise().minCoeff();
    const Eigen::RowVector3d high = mesh_.nodes.colwise().maxCoeff();
    throw ConfigError(key,
                      fmt::format("{} lies there; the mesh reaches from ({:.6g}, {:.6g}, {:.6g}) to "
                                  "({:.6g}, {:.6g}, {:.6g}) m",
                                  what, low(0), low(1), low(2), high(0), high(1), high(2)));
  }

  /// Where no elements are known, a surface is the set of the nodes that lie there.
  void add_node_sets() {
    const double extent = extent_of(mesh_);
    for (const auto& [name, given] : parameters_.surfaces) {
      const MeshRegion region = given.region();
      const double tolerance = given.tolerance.value_or(share_of_extent * extent);
      Nodes nodes;
      for (Eigen::Index node = 0; node < mesh_.nodes.rows(); ++node) {
        if (region.contains(mesh_.nodes.row(node), tolerance))
          nodes.push_back(static_cast<int>(node));
      }
      if (nodes.empty()) refuse_empty("surfaces." + name, "no node");
      mesh_.node_sets[name] = std::move(nodes);
    }
  }

  /// From the frame of the mesh to that of the body; exact for right angles.
  static Eigen::Matrix2d turn_by(double angle) {
    double cosine = std::cos(angle);
    double sine = std::sin(angle);
    if (std::abs(cosine) < 1e-15) cosine = 0.0;
    if (std::abs(sine) < 1e-15) sine = 0.0;
    Eigen::Matrix2d turn;
    turn << cosine, -sine, sine, cosine;
    return turn;
  }

  ElementSection section_of(const MaterialParameters& material) const {
    return {ElasticLaw(IsotropicElasticity{material.youngs_modulus, material.poissons_ratio},
                       dimension_ == 3 ? PlaneState::none : parameters_.plane),
            material.density, parameters_.thickness.value_or(1.0)};
  }

  MeshSections sections() const {
    MeshSections sections = one_section(mesh_, section_of(parameters_.material));
    std::map<int, std::string> owner;
    for (const auto& [name, material] : parameters_.materials) {
      const auto set = mesh_.element_sets.find(name);
      if (set == mesh_.element_sets.end()) {
        throw ConfigError("materials." + name,
                          fmt::format("there is no element set '{}'{}", name,
                                      known(name, names_of(mesh_.element_sets))));
      }
      const auto number = static_cast<int>(sections.sections.size());
      sections.sections.push_back(section_of(material));
      for (const int element : set->second) {
        const auto [found, is_new] = owner.emplace(element, name);
        if (!is_new) {
          throw ConfigError(
              "materials." + name,
              fmt::format("element {} is in '{}' as well, and can have one material only",
                          mesh_.element_labels[static_cast<std::size_t>(element)], found->second));
        }
        sections.of_element[static_cast<std::size_t>(element)] = number;
      }
    }
    return sections;
  }

  /// Nodes of a surface or node set; none where there is no such name.
  Nodes nodes_named(const std::string& name) const {
    const auto surface = mesh_.surfaces.find(name);
    if (surface != mesh_.surfaces.end()) return nodes_of(mesh_, surface->second);
    const auto set = mesh_.node_sets.find(name);
    return set == mesh_.node_sets.end() ? Nodes() : set->second;
  }

  std::vector<std::string> known_names() const {
    std::vector<std::string> names = names_of(mesh_.surfaces);
    for (const std::string& name : names_of(mesh_.node_sets))
      if (!mesh_.surfaces.contains(name)) names.push_back(name);
    return names;
  }

  Nodes nodes_on(const std::vector<std::string>& names, const std::string& key) const {
    Nodes all;
    for (const std::string& name : names) {
      const Nodes nodes = nodes_named(name);
      if (nodes.empty()) {
        throw ConfigError(key, fmt::format("there is no surface or node set '{}'{}", name,
                                           known(name, known_names())));
      }
      all.insert(all.end(), nodes.begin(), nodes.end());
    }
    return all;
  }

  static constexpr int unset = -2;
  static constexpr int shared = -3;

  /// Supports mark what is held and shared; the free DoFs are numbered after that.
  void number_dofs(const NodalMatrices& all, BodyMatrices& body) {
    mark_supports(all);
    number_free(all, body);
  }

  /// Rotations of nodes that are held in all directions.
  void hold_rotations(const NodalMatrices& all, int node) {
    for (std::size_t axis = 0; axis < 3 && !all.rotations.empty(); ++axis) {
      const int row = all.rotations[3 * static_cast<std::size_t>(node) + axis];
      if (row != BodyMatrices::held) dof_of_row_[static_cast<std::size_t>(row)] = BodyMatrices::held;
    }
  }

  void mark_supports(const NodalMatrices& all) {
    const auto d = static_cast<std::size_t>(dimension_);
    dof_of_row_.assign(static_cast<std::size_t>(all.mass.rows()), unset);
    int none = BodyMatrices::held;
    const auto mark = [&](int node, std::size_t direction) -> int& {
      const int row = all.rows[d * static_cast<std::size_t>(node) + direction];
      return row == BodyMatrices::held ? none : dof_of_row_[static_cast<std::size_t>(row)];
    };
    for (const auto& [name, support] : parameters_.supports) {
      const std::string key = "supports." + name;
      for (const int node : nodes_on(support.on, key + ".on")) {
        for (std::size_t i = 0; i < d; ++i) {
          const std::string axis(1, "xyz"[i]);
          if (support.held.empty() ||
              std::find(support.held.begin(), support.held.end(), axis) != support.held.end())
            mark(node, i) = BodyMatrices::held;
        }
        if (support.held.empty()) hold_rotations(all, node);
      }
      if (d == 2 && std::find(support.held.begin(), support.held.end(), "z") != support.held.end())
        throw ConfigError(key + ".held", "a planar body does not move along z");
    }
    if (parameters_.guided) {
      for (const int node : nodes_on(parameters_.guided->on, "guided.on")) {
        for (std::size_t i = 0; i < d; ++i) mark(node, i) = i == 1 ? shared : BodyMatrices::held;
        hold_rotations(all, node);
      }
    }
  }

  /// Numbers DoFs in the order of the nodes, then those that belong to no displacement of a node.
  void number_free(const NodalMatrices& all, BodyMatrices& body) {
    const auto d = static_cast<std::size_t>(dimension_);
    num_dofs_ = 0;
    const auto number = [&](int row) {
      int& dof = dof_of_row_[static_cast<std::size_t>(row)];
      if (dof == unset) dof = num_dofs_++;
      if (dof == shared) {
        if (body.load_dof == BodyMatrices::held) body.load_dof = num_dofs_++;
        dof = body.load_dof;
      }
      return dof;
    };
    body.node_dofs.assign(mesh_.num_nodes(), {BodyMatrices::held, BodyMatrices::held});
    if (d == 3) body.across.assign(mesh_.num_nodes(), BodyMatrices::held);
    for (std::size_t k = 0; k < all.rows.size(); ++k) {
      const int dof = all.rows[k] == BodyMatrices::held ? BodyMatrices::held : number(all.rows[k]);
      if (k % d < 2) {
        body.node_dofs[k / d][k % d] = dof;
      } else {
        body.across[k / d] = dof;
      }
    }
    for (Eigen::Index row = 0; row < all.mass.rows(); ++row) (void)number(static_cast<int>(row));
    if (num_dofs_ == 0) throw ConfigError("supports", "hold every node of the body");
    if (parameters_.guided && body.load_dof == BodyMatrices::held)
      throw ConfigError("guided.on", "no node of it moves along y, so the drive has no load on it");
  }

  /// M and K of the free DoFs, AᵀMA with A of ones where a DoF moves a displacement of the mesh.
  void constrain(const NodalMatrices& all, BodyMatrices& body) const {
    const Eigen::Index num_all = all.mass.rows();
    std::vector<Eigen::Triplet<double>> entries;
    for (Eigen::Index row = 0; row < num_all; ++row) {
      const int dof = dof_of_row_[static_cast<std::size_t>(row)];
      if (dof != BodyMatrices::held) entries.emplace_back(row, dof, 1.0);
    }
    SparseMatrix choice(num_all, num_dofs_);
    choice.setFromTriplets(entries.begin(), entries.end());
    const SparseMatrix transposed = choice.transpose();
    body.mass = (transposed * all.mass * choice).pruned(0.0, 0.0);
    body.stiffness = (transposed * all.stiffness * choice).pruned(0.0, 0.0);
    if (all.velocity.size() > 0) {
      body.velocity = transposed * all.velocity * choice;
      body.circulatory = transposed * all.circulatory * choice;
    }
    if (!body.follows_drive()) return;
    // Held nodes move with the support.
    Eigen::VectorXd along_x = Eigen::VectorXd::Zero(num_all);
    for (std::size_t k = 0; k < all.rows.size(); k += static_cast<std::size_t>(dimension_)) {
      if (all.rows[k] == BodyMatrices::held) {
        throw ConfigError("guided.on",
                          fmt::format("the matrices hold node {} along x, so the inertia of a body "
                                      "that is driven along x is not known; leave all nodes free "
                                      "there when they are written",
                                      mesh_.node_labels[k / static_cast<std::size_t>(dimension_)]));
      }
      along_x(all.rows[k]) = 1.0;
    }
    body.base_inertia = transposed * (all.mass * along_x);
  }

  /// Surfaces of a planar body that are a chain of edges; facets of a body in space.
  void add_outlines(BodyMatrices& body) const {
    if (dimension_ == 3) {
      for (const auto& [name, sides] : mesh_.surfaces) body.facets[name] = facets_of(mesh_, sides);
      return;
    }
    for (const auto& [name, sides] : mesh_.surfaces) {
      try {
        body.surfaces[name] = outline_of(mesh_, sides);
      } catch (const std::invalid_argument& error) {
        if (parameters_.surfaces.contains(name))
          throw ConfigError("surfaces." + name, error.what());
      }
    }
    // What is drawn whether surfaces have names or not.
    for (const ElementSide& side : outer_sides(mesh_)) {
      std::vector<int> nodes = nodes_of(mesh_, side);
      if (nodes.size() == 3) std::swap(nodes[1], nodes[2]);
      body.outlines.push_back(std::move(nodes));
    }
  }

  void add_points(BodyMatrices& body) const {
    for (const auto& [name, point] : parameters_.points) {
      const std::string key = "points." + name;
      if (mesh_.surfaces.contains(name))
        throw ConfigError(key, fmt::format("'{}' is a surface; take another name", name));
      if (point.node) {
        body.points[name] = labelled(*point.node, key + ".node");
      } else if (!point.mean_of.empty()) {
        add_mean(name, key, point.mean_of, body);
      } else {
        add_place(name, key, in_space(point.at), body);
      }
    }
  }

  int labelled(std::int64_t label, const std::string& key) const {
    const auto found = std::find(mesh_.node_labels.begin(), mesh_.node_labels.end(), label);
    if (found != mesh_.node_labels.end())
      return static_cast<int>(found - mesh_.node_labels.begin());
    throw ConfigError(key, fmt::format("no element of the mesh has a node {}", label));
  }

  void add_mean(const std::string& name, const std::string& key, const std::string& on,
                BodyMatrices& body) const {
    NodeShares shares = even_shares(on);
    if (shares.empty()) {
      const Nodes nodes = nodes_on({on}, key + ".mean_of");
      for (const int node : nodes)
        shares.push_back({node, 1.0 / static_cast<double>(nodes.size())});
    }
    add_dependent(name, shares, body);
  }

  /// A point that moves as Σ share u of nodes, and is where the same sum of places is.
  void add_dependent(const std::string& name, const NodeShares& shares, BodyMatrices& body) const {
    Eigen::Vector3d place = Eigen::Vector3d::Zero();
    for (const NodeShare& share : shares)
      place += share.share * mesh_.nodes.row(share.node).transpose();
    add_dependent_point(name, place, shares, body);
  }

  void add_place(const std::string& name, const std::string& key, const Eigen::Vector3d& given,
                 BodyMatrices& body) const {
    Eigen::Vector3d place = given;
    place.head<2>() = turn_ * given.head<2>();
    const MeshPoint found = find_point(mesh_, place, share_of_extent * extent_of(mesh_));
    if (found.weights.empty()) {
      Eigen::RowVector3d nearest = mesh_.nodes.row(found.nearest);
      nearest.head<2>() *= turn_;
      throw ConfigError(
          key + ".at",
          fmt::format("lies outside of the mesh: its nearest node, {}, is at ({:.6g}, {:.6g}, "
                      "{:.6g}) m, {:.4g} m away",
                      mesh_.node_labels[static_cast<std::size_t>(found.nearest)], nearest(0),
                      nearest(1), nearest(2), found.distance));
    }
    if (found.nodes.size() == 1) {
      body.points[name] = found.nodes.front();
      return;
    }
    NodeShares shares;
    for (std::size_t i = 0; i < found.nodes.size(); ++i)
      shares.push_back({found.nodes[i], found.weights[i]});
    add_dependent(name, shares, body);
  }

  /// Parts of an even load on a surface; none where there is no such surface.
  NodeShares even_shares(const std::string& name) const {
    const auto surface = mesh_.surfaces.find(name);
    if (surface == mesh_.surfaces.end()) return {};
    // Shares are ratios, for which thickness and material do not matter.
    const ElementSection any{ElasticLaw(IsotropicElasticity{1.0, 0.0},
                                        dimension_ == 3 ? PlaneState::none : PlaneState::stress),
                             1.0, 1.0};
    const Eigen::VectorXd areas = node_areas(mesh_, one_section(mesh_, any), surface->second);
    NodeShares shares;
    for (const int node : nodes_of(mesh_, surface->second))
      if (areas(node) != 0.0) shares.push_back({node, areas(node) / areas.sum()});
    return shares;
  }

  void add_loads_and_springs(BodyMatrices& body) const {
    for (const auto& entry : mesh_.surfaces)
      add_surface_loads(entry.first, even_shares(entry.first), body);
    const auto shares_of = [&](const std::string& on) -> NodeShares {
      const auto point = body.points.find(on);
      if (point != body.points.end()) return {{point->second, 1.0}};
      NodeShares shares = even_shares(on);
      // A spring at each node, none of them negative.
      double sum = 0.0;
      for (NodeShare& share : shares) sum += share.share = std::abs(share.share);
      for (NodeShare& share : shares) share.share /= sum;
      return shares;
    };
    std::vector<std::string> names = names_of(mesh_.surfaces);
    for (const std::string& name : names_of(body.points)) names.push_back(name);
    add_surface_springs(parameters_.springs, shares_of, names, body);
  }

  const MeshBodyParameters& parameters_;
  const NodalMatrices* given_;  ///< null: matrices of the elements
  Mesh mesh_;  ///< in metres, turned
  Eigen::Matrix2d turn_;
  int dimension_ = 2;
  std::vector<int> dof_of_row_;  ///< of every row of the matrices
  int num_dofs_ = 0;
};

}  // namespace

Mesh named_mesh(const MeshBodyParameters& parameters) {
  return MeshedBody(parameters).mesh();
}

Mesh named_mesh(const MeshBodyParameters& parameters, const NodalMatrices& matrices) {
  return MeshedBody(parameters, &matrices).mesh();
}

BodyMatrices make_meshed_body(const MeshBodyParameters& parameters) {
  return MeshedBody(parameters).make();
}

BodyMatrices make_meshed_body(const MeshBodyParameters& parameters, const NodalMatrices& matrices) {
  return MeshedBody(parameters, &matrices).make();
}

}  // namespace stridor
