#include "substructures/elements/assembly.hpp"

#include <fmt/format.h>

#include <Eigen/Geometry>
#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <stdexcept>

#include "substructures/elements/shape_functions.hpp"

namespace stridor {
namespace {

void check_sections(const Mesh& mesh, const MeshSections& sections) {
  if (sections.of_element.size() != mesh.num_elements())
    throw std::invalid_argument("MeshSections: not one section per element");
  for (const int section : sections.of_element) {
    if (section < 0 || static_cast<std::size_t>(section) >= sections.sections.size())
      throw std::invalid_argument("MeshSections: an element has a section that is not there");
  }
  const int dimension = mesh.dimension();
  for (const ElementSection& section : sections.sections) {
    if (section.law.dimension() != dimension)
      throw std::invalid_argument("MeshSections: the law of a section is for another dimension");
    if (!(section.density > 0.0) || !std::isfinite(section.density))
      throw std::invalid_argument("MeshSections: the density of a section is not positive");
    if (!(section.thickness > 0.0) || !std::isfinite(section.thickness))
      throw std::invalid_argument("MeshSections: the thickness of a section is not positive");
  }
}

/// Lists of numbers one after the other.
struct ListOfLists {
  std::vector<std::size_t> first{0};  ///< of every list, and the end of the last
  std::vector<int> items;

  std::span<const int> operator[](std::size_t list) const {
    return {items.data() + first[list], first[list + 1] - first[list]};
  }
};

ListOfLists elements_of_nodes(const Mesh& mesh) {
  ListOfLists lists;
  lists.first.assign(mesh.num_nodes() + 1, 0);
  for (const int node : mesh.connectivity) ++lists.first[static_cast<std::size_t>(node) + 1];
  for (std::size_t node = 0; node < mesh.num_nodes(); ++node)
    lists.first[node + 1] += lists.first[node];
  lists.items.resize(mesh.connectivity.size());
  std::vector<std::size_t> next(lists.first.begin(), lists.first.end() - 1);
  for (std::size_t element = 0; element < mesh.num_elements(); ++element) {
    for (const int node : mesh.nodes_of(element))
      lists.items[next[static_cast<std::size_t>(node)]++] = static_cast<int>(element);
  }
  return lists;
}

/// Nodes that share an element with a node, itself included, ascending.
ListOfLists neighbours_of_nodes(const Mesh& mesh) {
  const ListOfLists elements = elements_of_nodes(mesh);
  ListOfLists lists;
  lists.first.reserve(mesh.num_nodes() + 1);
  std::vector<int> seen_from(mesh.num_nodes(), -1);
  // Counted first, so that no memory is left over.
  for (const bool is_counting : {true, false}) {
    std::fill(seen_from.begin(), seen_from.end(), -1);
    std::size_t count = 0;
    for (std::size_t node = 0; node < mesh.num_nodes(); ++node) {
      const std::size_t begin = count;
      for (const int element : elements[node]) {
        for (const int other : mesh.nodes_of(static_cast<std::size_t>(element))) {
          int& seen = seen_from[static_cast<std::size_t>(other)];
          if (seen == static_cast<int>(node)) continue;
          seen = static_cast<int>(node);
          if (!is_counting) lists.items[count] = other;
          ++count;
        }
      }
      if (is_counting) {
        lists.first.push_back(count);
      } else {
        std::sort(lists.items.begin() + static_cast<std::ptrdiff_t>(begin),
                  lists.items.begin() + static_cast<std::ptrdiff_t>(count));
      }
    }
    if (is_counting) lists.items.resize(count);
  }
  return lists;
}

/// A matrix of zeros with an entry for every pair of neighbours: in every pair of directions
/// (`per_pair` = dimension), or only between equal directions (`per_pair` = 1).
SparseMatrix zeros_between(const ListOfLists& neighbours, int dimension, int per_pair) {
  const std::size_t num_nodes = neighbours.first.size() - 1;
  const auto num_dofs = static_cast<Eigen::Index>(num_nodes) * dimension;
  const auto num_entries =
      static_cast<Eigen::Index>(neighbours.items.size()) * dimension * per_pair;
  if (num_entries > std::numeric_limits<int>::max())
    throw std::invalid_argument("assemble_mesh: the mesh is too large for 2^31 entries");
  SparseMatrix matrix(num_dofs, num_dofs);
  matrix.resizeNonZeros(num_entries);
  int* outer = matrix.outerIndexPtr();
  int* inner = matrix.innerIndexPtr();
  int count = 0;
  for (std::size_t node = 0; node < num_nodes; ++node) {
    for (int direction = 0; direction < dimension; ++direction) {
      *outer++ = count;
      for (const int other : neighbours[node]) {
        if (per_pair == 1) {
          inner[count++] = other * dimension + direction;
        } else {
          for (int i = 0; i < dimension; ++i) inner[count++] = other * dimension + i;
        }
      }
    }
  }
  *outer = count;
  std::fill_n(matrix.valuePtr(), count, 0.0);
  return matrix;
}

template <ElementShape shape>
ElementNodes<shape> places_of(const Mesh& mesh, std::size_t element) {
  ElementNodes<shape> places;
  Eigen::Index row = 0;
  for (const int node : mesh.nodes_of(element))
    places.row(row++) = mesh.nodes.row(node).template head<ElementSizes<shape>::dimension>();
  return places;
}

/// Adds the matrices of one element.
template <ElementShape shape>
void add_to_mesh(const Mesh& mesh, std::size_t element, const ElementSection& section,
                 const SectionFactors& factors, const ListOfLists& neighbours,
                 MeshMatrices& matrices) {
  constexpr int dimension = ElementSizes<shape>::dimension;
  constexpr int num_nodes = ElementSizes<shape>::num_nodes;
  const ElementNodes<shape> places = places_of<shape>(mesh, element);
  const std::int64_t label = mesh.element_labels[element];
  ElementStiffness<shape> stiffness = element_stiffness<shape>(places, section, label);
  NodalMass<shape> mass = element_mass<shape>(places, section, label);
  if (factors.stiffness != 1.0) stiffness *= factors.stiffness;
  if (factors.mass != 1.0) mass *= factors.mass;
  const std::span<const int> nodes = mesh.nodes_of(element);
  double* const stiffness_values = matrices.stiffness.valuePtr();
  double* const mass_values = matrices.mass.valuePtr();
  for (int b = 0; b < num_nodes; ++b) {
    const int column_node = nodes[static_cast<std::size_t>(b)];
    const std::span<const int> column = neighbours[static_cast<std::size_t>(column_node)];
    const auto degree = static_cast<std::ptrdiff_t>(column.size());
    // Entries of a node's columns follow each other.
    const std::ptrdiff_t start = matrices.mass.outerIndexPtr()[column_node * dimension];
    for (int a = 0; a < num_nodes; ++a) {
      const std::ptrdiff_t place =
          std::lower_bound(column.begin(), column.end(), nodes[static_cast<std::size_t>(a)]) -
          column.begin();
      const double nodal_mass = mass(a, b);
      for (int j = 0; j < dimension; ++j) {
        mass_values[start + j * degree + place] += nodal_mass;
        double* const block = stiffness_values + dimension * (start + j * degree + place);
        for (int i = 0; i < dimension; ++i)
          block[i] += stiffness(dimension * a + i, dimension * b + j);
      }
    }
  }
}

/// Calls action(values, normal x area, place) at the points of a side: normal out of the body.
template <class Action>
void for_points_of_side(const Mesh& mesh, const MeshSections& sections, const ElementSide& side,
                        Action&& action) {
  const auto element = static_cast<std::size_t>(side.element);
  if (side.element < 0 || element >= mesh.num_elements())
    throw std::invalid_argument("a side of an element that is not there");
  const ShapeFacts& facts = facts_of(mesh.shapes[element]);
  if (side.side < 0 || static_cast<std::size_t>(side.side) >= facts.sides.size())
    throw std::invalid_argument(fmt::format(
        "element {} ({}) has no side {}", mesh.element_labels[element], facts.name, side.side + 1));
  const SideNodes& nodes = facts.sides[static_cast<std::size_t>(side.side)];
  const SideShape shape = shape_of(nodes);
  Eigen::Matrix<double, Eigen::Dynamic, 3, 0, 8, 3> places(nodes.count, 3);
  for (int k = 0; k < nodes.count; ++k) {
    const int within = nodes.nodes[static_cast<std::size_t>(k)];
    places.row(k) = mesh.nodes.row(mesh.nodes_of(element)[static_cast<std::size_t>(within)]);
  }
  for (const IntegrationPoint& point : side_points(shape)) {
    const ShapeFunctions functions = shape_functions(shape, point.place);
    const Eigen::Vector3d first = places.transpose() * functions.derivatives.col(0);
    Eigen::Vector3d normal;
    if (dimension_of(shape) == 1) {
      // The body is on the left of an edge.
      normal = sections.of(element).thickness * Eigen::Vector3d{first.y(), -first.x(), 0.0};
    } else {
      const Eigen::Vector3d second = places.transpose() * functions.derivatives.col(1);
      normal = first.cross(second);
    }
    action(functions.values, Eigen::Vector3d(point.weight * normal),
           Eigen::Vector3d(places.transpose() * functions.values), nodes);
  }
}

int node_of_side(const Mesh& mesh, const ElementSide& side, const SideNodes& nodes, int k) {
  return mesh.nodes_of(static_cast<std::size_t>(
      side.element))[static_cast<std::size_t>(nodes.nodes[static_cast<std::size_t>(k)])];
}

}  // namespace

MeshSections one_section(const Mesh& mesh, const ElementSection& section) {
  return {{section}, std::vector<int>(mesh.num_elements(), 0)};
}

MeshMatrices assemble_mesh(const Mesh& mesh, const MeshSections& sections) {
  const std::vector<SectionFactors> ones(sections.sections.size(), {1.0, 1.0});
  return assemble_mesh(mesh, sections, ones);
}

MeshMatrices assemble_mesh(const Mesh& mesh, const MeshSections& sections,
                           std::span<const SectionFactors> factors) {
  check_sections(mesh, sections);
  if (factors.size() != sections.sections.size())
    throw std::invalid_argument("assemble_mesh: not one factor per section");
  const int dimension = mesh.dimension();
  const ListOfLists neighbours = neighbours_of_nodes(mesh);
  MeshMatrices matrices{zeros_between(neighbours, dimension, dimension),
                        zeros_between(neighbours, dimension, 1)};
  for (std::size_t element = 0; element < mesh.num_elements(); ++element) {
    const SectionFactors& factor = factors[static_cast<std::size_t>(sections.of_element[element])];
    if (factor.stiffness == 0.0 && factor.mass == 0.0) continue;
    with_shape(mesh.shapes[element], [&]<ElementShape shape>() {
      add_to_mesh<shape>(mesh, element, sections.of(element), factor, neighbours, matrices);
    });
  }
  return matrices;
}

std::vector<int> nodes_without_elements(const Mesh& mesh) {
  std::vector<bool> has_element(mesh.num_nodes(), false);
  for (const int node : mesh.connectivity) has_element[static_cast<std::size_t>(node)] = true;
  std::vector<int> without;
  for (std::size_t node = 0; node < has_element.size(); ++node) {
    if (!has_element[node]) without.push_back(static_cast<int>(node));
  }
  return without;
}

Eigen::MatrixXd rigid_motions(const Mesh& mesh) {
  const Eigen::Index dimension = mesh.dimension();
  const Eigen::RowVector3d centre = mesh.nodes.colwise().mean();
  Eigen::MatrixXd motions =
      Eigen::MatrixXd::Zero(dimension * mesh.nodes.rows(), dimension == 2 ? 3 : 6);
  for (Eigen::Index node = 0; node < mesh.nodes.rows(); ++node) {
    const Eigen::Vector3d arm = (mesh.nodes.row(node) - centre).transpose();
    auto rows = motions.middleRows(dimension * node, dimension);
    rows.leftCols(dimension).setIdentity();
    if (dimension == 2) {
      rows.col(2) << -arm.y(), arm.x();
    } else {
      for (Eigen::Index axis = 0; axis < 3; ++axis)
        rows.col(3 + axis) = Eigen::Vector3d::Unit(axis).cross(arm);
    }
  }
  return motions;
}

MassProperties mass_properties(const Mesh& mesh, const MeshSections& sections) {
  check_sections(mesh, sections);
  MassProperties total;
  const bool is_planar = mesh.dimension() == 2;
  // About the mean of the nodes first, so that little cancels.
  const Eigen::Vector3d origin = mesh.nodes.colwise().mean().transpose();
  Eigen::Vector3d first = Eigen::Vector3d::Zero();
  Eigen::Matrix3d second = Eigen::Matrix3d::Zero();
  for (std::size_t element = 0; element < mesh.num_elements(); ++element) {
    const ElementSection& section = sections.of(element);
    with_shape(mesh.shapes[element], [&]<ElementShape shape>() {
      const NodalMass<shape> mass = element_mass<shape>(places_of<shape>(mesh, element), section,
                                                        mesh.element_labels[element]);
      Eigen::Matrix<double, ElementSizes<shape>::num_nodes, 3> arms;
      Eigen::Index row = 0;
      for (const int node : mesh.nodes_of(element))
        arms.row(row++) = mesh.nodes.row(node) - origin.transpose();
      if (is_planar) arms.col(2).setZero();
      const Eigen::Matrix<double, ElementSizes<shape>::num_nodes, 3> moved = mass.lazyProduct(arms);
      total.mass += mass.sum();
      total.volume += mass.sum() / section.density;
      first += moved.colwise().sum().transpose();
      second += arms.transpose().lazyProduct(moved);
    });
  }
  const Eigen::Vector3d arm = first / total.mass;
  total.centre = origin + arm;
  second -= total.mass * arm * arm.transpose();
  total.inertia = second.trace() * Eigen::Matrix3d::Identity() - second;
  return total;
}

SideGeometry side_geometry(const Mesh& mesh, const MeshSections& sections,
                           const ElementSide& side) {
  SideGeometry geometry;
  for_points_of_side(mesh, sections, side,
                     [&](const auto&, const Eigen::Vector3d& normal, const Eigen::Vector3d& place,
                         const SideNodes&) {
                       geometry.area += normal.norm();
                       geometry.normal += normal;
                       geometry.centre += normal.norm() * place;
                     });
  if (!(geometry.area > 0.0))
    throw std::invalid_argument(
        fmt::format("side {} of element {} has no area", side.side + 1,
                    mesh.element_labels[static_cast<std::size_t>(side.element)]));
  geometry.normal.normalize();
  geometry.centre /= geometry.area;
  return geometry;
}

Eigen::VectorXd node_areas(const Mesh& mesh, const MeshSections& sections,
                           std::span<const ElementSide> sides) {
  Eigen::VectorXd areas = Eigen::VectorXd::Zero(mesh.nodes.rows());
  for (const ElementSide& side : sides) {
    for_points_of_side(mesh, sections, side,
                       [&](const auto& values, const Eigen::Vector3d& normal,
                           const Eigen::Vector3d&, const SideNodes& nodes) {
                         for (int k = 0; k < nodes.count; ++k)
                           areas(node_of_side(mesh, side, nodes, k)) += values(k) * normal.norm();
                       });
  }
  return areas;
}

Eigen::VectorXd traction_load(const Mesh& mesh, const MeshSections& sections,
                              std::span<const ElementSide> sides, const Eigen::Vector3d& traction) {
  const Eigen::Index dimension = mesh.dimension();
  const Eigen::VectorXd areas = node_areas(mesh, sections, sides);
  Eigen::VectorXd load(dimension * areas.size());
  for (Eigen::Index node = 0; node < areas.size(); ++node)
    load.segment(dimension * node, dimension) = areas(node) * traction.head(dimension);
  return load;
}

Eigen::VectorXd pressure_load(const Mesh& mesh, const MeshSections& sections,
                              std::span<const ElementSide> sides, double pressure) {
  const Eigen::Index dimension = mesh.dimension();
  Eigen::VectorXd load = Eigen::VectorXd::Zero(dimension * mesh.nodes.rows());
  for (const ElementSide& side : sides) {
    for_points_of_side(mesh, sections, side,
                       [&](const auto& values, const Eigen::Vector3d& normal,
                           const Eigen::Vector3d&, const SideNodes& nodes) {
                         for (int k = 0; k < nodes.count; ++k) {
                           load.segment(dimension * node_of_side(mesh, side, nodes, k),
                                        dimension) -= pressure * values(k) * normal.head(dimension);
                         }
                       });
  }
  return load;
}

}  // namespace stridor
