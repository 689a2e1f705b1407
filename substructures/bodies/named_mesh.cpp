#include "substructures/bodies/named_mesh.hpp"

#include <cmath>
#include <map>
#include <stdexcept>
#include <utility>

#include "core/errors.hpp"
#include "core/units.hpp"

namespace stridor {
namespace {

/// From the frame of the mesh to that of the body; exact for right angles.
Eigen::Matrix2d turn_by(double angle) {
  double cosine = std::cos(angle);
  double sine = std::sin(angle);
  if (std::abs(cosine) < 1e-15) cosine = 0.0;
  if (std::abs(sine) < 1e-15) sine = 0.0;
  Eigen::Matrix2d turn;
  turn << cosine, -sine, sine, cosine;
  return turn;
}

/// Runs `act`, the errors of which get a key in front of theirs.
template <class Act>
auto below_key(const std::string& key, Act&& act) {
  try {
    return act();
  } catch (const ConfigError& error) {
    const Problem& problem = error.problems().front();
    throw ConfigError(problem.refusal, problem.key.empty() ? key : key + "." + problem.key,
                      problem.message);
  }
}

}  // namespace

NamedMesh::NamedMesh(const MeshBodyParameters& parameters, const NodalMatrices* given)
    : turn(turn_by(parameters.angle)), parameters_(parameters), given_(given) {
  if (!parameters.mesh)
    throw std::invalid_argument("MeshBodyParameters: the mesh has not been read");
  mesh = *parameters.mesh;
  mesh.nodes *= parameters.metres_per_unit();
  if (given_ == nullptr) {
    find_dimension();
  } else {
    dimension = given_->dimension;
    if (given_->rows.size() != static_cast<std::size_t>(dimension) * mesh.num_nodes())
      throw std::invalid_argument("NamedMesh: the matrices are of another mesh");
  }
  add_surfaces();
  mesh.nodes.leftCols<2>() *= turn.transpose();
}

void NamedMesh::find_dimension() {
  try {
    dimension = mesh.dimension();
  } catch (const std::invalid_argument&) {
    throw ConfigError(Refusal::wrong_mesh, "file",
                      "has planar elements beside volumes; give a mesh of one kind, of which "
                      "edges or faces are groups");
  }
  if (dimension == 2 && !parameters_.thickness)
    throw ConfigError(Refusal::wrong_mesh, "thickness", "is missing: the mesh is planar");
  if (dimension == 3 && parameters_.thickness)
    throw ConfigError(Refusal::wrong_mesh, "thickness",
                      "is of a planar mesh; this one has volumes");
}

void NamedMesh::refuse_empty(const std::string& key, const char* what) const {
  const Eigen::RowVector3d low = mesh.nodes.colwise().minCoeff();
  const Eigen::RowVector3d high = mesh.nodes.colwise().maxCoeff();
  throw ConfigError(Refusal::wrong_mesh, key,
                    fmt::format("{} lies there; the mesh reaches from ({:.6g}, {:.6g}, {:.6g}) to "
                                "({:.6g}, {:.6g}, {:.6g}) m",
                                what, low(0), low(1), low(2), high(0), high(1), high(2)));
}

void NamedMesh::add_node_sets() {
  const double extent = extent_of(mesh);
  for (const auto& [name, region_of] : parameters_.surfaces) {
    const MeshRegion region = region_of.region();
    const double tolerance = region_of.tolerance.value_or(share_of_extent * extent);
    std::vector<int> nodes;
    for (Eigen::Index node = 0; node < mesh.nodes.rows(); ++node) {
      if (region.contains(mesh.nodes.row(node), tolerance)) nodes.push_back(static_cast<int>(node));
    }
    if (nodes.empty()) refuse_empty("surfaces." + name, "no node");
    mesh.node_sets[name] = std::move(nodes);
  }
}

void NamedMesh::add_surfaces() {
  if (parameters_.surfaces.empty()) return;
  if (mesh.num_elements() == 0) return add_node_sets();
  const std::vector<ElementSide> outer = outer_sides(mesh);
  const double extent = extent_of(mesh);
  for (const auto& [name, given] : parameters_.surfaces) {
    const std::string key = "surfaces." + name;
    if (mesh.surfaces.contains(name))
      throw ConfigError(Refusal::doubled_name, key,
                        "the file has a surface of this name; take another");
    std::vector<ElementSide> sides = sides_within(
        mesh, outer, given.region(), given.tolerance.value_or(share_of_extent * extent));
    if (sides.empty()) refuse_empty(key, "no outer side of an element");
    mesh.surfaces[name] = std::move(sides);
  }
}

Eigen::Vector3d NamedMesh::turned(const std::vector<double>& given) const {
  Eigen::Vector3d vector = in_space(given);
  vector.head<2>() = (turn * vector.head<2>()).eval();
  return vector;
}

Eigen::RowVector3d NamedMesh::in_file(const Eigen::Vector3d& place) const {
  Eigen::RowVector3d there = place.transpose();
  there.head<2>() = (there.head<2>() * turn).eval();
  return there;
}

std::string NamedMesh::place_text(int node) const {
  const Eigen::RowVector3d at = in_file(mesh.nodes.row(node).transpose());
  return fmt::format("({:.6g}, {:.6g}, {:.6g}) m", at(0), at(1), at(2));
}

MeshSections NamedMesh::sections() const {
  const auto section_of = [&](const MeshMaterialParameters& material, const std::string& key) {
    return below_key(key, [&] {
      return material.section(dimension == 3 ? PlaneState::none : parameters_.plane, turn,
                              parameters_.thickness.value_or(1.0));
    });
  };
  MeshSections sections = one_section(mesh, section_of(parameters_.material, "material"));
  std::map<int, std::string> owner;
  for (const auto& [name, material] : parameters_.materials) {
    const std::string key = "materials." + name;
    const auto set = mesh.element_sets.find(name);
    if (set == mesh.element_sets.end()) {
      throw ConfigError(Refusal::unknown_name, key,
                        fmt::format("there is no element set '{}'{}", name,
                                    known(name, names_of(mesh.element_sets))));
    }
    const auto number = static_cast<int>(sections.sections.size());
    sections.sections.push_back(section_of(material, key));
    for (const int element : set->second) {
      const auto [found, is_new] = owner.emplace(element, name);
      if (!is_new) {
        throw ConfigError(
            Refusal::wrong_mesh, key,
            fmt::format("element {} is in '{}' as well, and can have one material only",
                        mesh.element_labels[static_cast<std::size_t>(element)], found->second));
      }
      sections.of_element[static_cast<std::size_t>(element)] = number;
    }
  }
  return sections;
}

std::vector<std::string> NamedMesh::known_names() const {
  std::vector<std::string> names = names_of(mesh.surfaces);
  for (const std::string& name : names_of(mesh.node_sets))
    if (!mesh.surfaces.contains(name)) names.push_back(name);
  return names;
}

std::vector<int> NamedMesh::nodes_on(const std::vector<std::string>& names,
                                     const std::string& key) const {
  std::vector<int> all;
  for (const std::string& name : names) {
    std::vector<int> nodes;
    if (const auto surface = mesh.surfaces.find(name); surface != mesh.surfaces.end()) {
      nodes = nodes_of(mesh, surface->second);
    } else if (const auto set = mesh.node_sets.find(name); set != mesh.node_sets.end()) {
      nodes = set->second;
    }
    if (nodes.empty()) {
      throw ConfigError(
          Refusal::unknown_name, key,
          fmt::format("there is no surface or node set '{}'{}", name, known(name, known_names())));
    }
    all.insert(all.end(), nodes.begin(), nodes.end());
  }
  return all;
}

const std::vector<ElementSide>& NamedMesh::surface(const std::string& name,
                                                   const std::string& key) const {
  const auto found = mesh.surfaces.find(name);
  if (found != mesh.surfaces.end()) return found->second;
  throw ConfigError(
      Refusal::unknown_name, key,
      fmt::format("there is no surface '{}'{}", name, known(name, names_of(mesh.surfaces))));
}

NodeShares NamedMesh::even_shares(const std::string& name) const {
  const auto surface = mesh.surfaces.find(name);
  if (surface == mesh.surfaces.end()) return {};
  // Shares are ratios, for which thickness and material do not matter.
  const ElementSection any{ElasticLaw(IsotropicElasticity{1.0, 0.0},
                                      dimension == 3 ? PlaneState::none : PlaneState::stress),
                           1.0, 1.0};
  const Eigen::VectorXd areas = node_areas(mesh, one_section(mesh, any), surface->second);
  NodeShares shares;
  for (const int node : nodes_of(mesh, surface->second))
    if (areas(node) != 0.0) shares.push_back({node, areas(node) / areas.sum()});
  return shares;
}

}  // namespace stridor
