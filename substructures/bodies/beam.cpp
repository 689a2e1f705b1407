#include "substructures/bodies/beam.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include "substructures/bodies/beam_additions.hpp"
#include "substructures/bodies/beam_mesh.hpp"
#include "substructures/elements/solid_element.hpp"

namespace stridor {
namespace {

/// Numbering of the nodes of a structured Q8 mesh: column by column along the axis, so that the
/// matrices of a slender beam are narrow-banded. Columns alternate between 2 through + 1 nodes
/// (even) and through + 1 nodes (odd, mid-sides only).
struct NodeGrid {
  int along, through;

  int num_columns() const { return 2 * along + 1; }
  int full_column() const { return 2 * through + 1; }
  int thin_column() const { return through + 1; }
  int num_nodes() const { return (along + 1) * full_column() + along * thin_column(); }

  /// Node in column i (0 .. 2 along) and row j (0 .. 2 through, from bottom to top).
  int node(int i, int j) const {
    const int before = ((i + 1) / 2) * full_column() + (i / 2) * thin_column();
    return before + (i % 2 == 0 ? j : j / 2);
  }

  /// Nodes of the element in column 0 .. along − 1 and row 0 .. through − 1, as of quad8.
  std::array<int, 8> element(int column, int row) const {
    const int i = 2 * column;
    const int j = 2 * row;
    return {node(i, j),     node(i + 2, j),     node(i + 2, j + 2), node(i, j + 2),
            node(i + 1, j), node(i + 2, j + 1), node(i + 1, j + 2), node(i, j + 1)};
  }
};

/// Of an element, both directions interleaved.
using Q8Matrix = ElementStiffness<ElementShape::quad8>;

/// DoFs of an element in the order of its matrices, or `held`.
using ElementDofs = std::array<int, 16>;

/// Response in direction `row` to displacements in direction `column` (x: 0, y: 1), node by node.
Eigen::Map<Eigen::Matrix<double, 8, 8>, 0, Eigen::Stride<32, 2>> direction_part(
    Q8Matrix& matrix, Eigen::Index row, Eigen::Index column) {
  return Eigen::Map<Eigen::Matrix<double, 8, 8>, 0, Eigen::Stride<32, 2>>(&matrix(row, column));
}

/// Makes the forces of a rigid translation exactly zero, in one element and in their sum over any
/// mesh, by changing entries within rounding.
///
/// Rounded one by one the entries of a row do not cancel. As all elements are alike the remainders
/// add up to an elastic bedding, which is as stiff as a slender beam in bending once elements are a
/// thousand times shorter than it. Entries on a grid a little coarser than the rounding unit are
/// summed without error; the remainder of a row then goes to its diagonal.
void balance_translations(Q8Matrix& stiffness) {
  int exponent = 0;
  std::frexp(stiffness.cwiseAbs().maxCoeff(), &exponent);
  const double grid = std::ldexp(1.0, exponent - 51);
  stiffness = (0.5 / grid * (stiffness + stiffness.transpose())).array().round().eval();
  for (const Eigen::Index direction : {0, 1}) {
    auto part = direction_part(stiffness, direction, direction);
    part.diagonal() -= part.rowwise().sum().eval();
  }
  // The columns must cancel as well: the last column takes the remainder of the rows, then the
  // last row the remainder of the columns.
  auto mixed = direction_part(stiffness, 0, 1);
  mixed.col(7) -= mixed.rowwise().sum().eval();
  mixed.row(7) -= mixed.colwise().sum().eval();
  direction_part(stiffness, 1, 0) = mixed.transpose();
  stiffness *= grid;
}

/// Sum of a matrix over congruent elements, without entries that are zero: plane masses do not
/// couple x and y, and the stiffness between them cancels in regular meshes.
SparseMatrix assemble(const std::vector<ElementDofs>& elements, const Q8Matrix& matrix,
                      int num_dofs) {
  std::vector<Eigen::Triplet<double>> entries;
  entries.reserve(elements.size() * 256);
  for (const ElementDofs& dofs : elements) {
    for (Eigen::Index a = 0; a < 16; ++a) {
      const int row = dofs[static_cast<std::size_t>(a)];
      if (row == BodyMatrices::held) continue;
      for (Eigen::Index b = 0; b < 16; ++b) {
        const int column = dofs[static_cast<std::size_t>(b)];
        if (column != BodyMatrices::held) entries.emplace_back(row, column, matrix(a, b));
      }
    }
  }
  SparseMatrix result(num_dofs, num_dofs);
  result.setFromTriplets(entries.begin(), entries.end());
  result.prune(0.0);
  return result;
}

}  // namespace

namespace {

/// Makes the body of a beam from its nodes to its names.
class BeamMesher {
 public:
  explicit BeamMesher(const BeamParameters& parameters)
      : parameters_(parameters), grid_{parameters.mesh.along, parameters.mesh.through} {}

  BodyMatrices make() {
    body_.damping = parameters_.damping;
    place_nodes();
    assemble_elements(number_dofs());
    name_points();
    name_surfaces();
    return std::move(body_);
  }

 private:
  void place_nodes();
  int number_dofs();
  void hold_end(Support support, int column);
  void assemble_elements(int num_dofs);
  std::vector<ElementDofs> element_dofs() const;
  void add_base_inertia(const std::vector<ElementDofs>& elements, const Q8Matrix& mass);
  void name_points();
  void name_surfaces();

  int last_column() const { return grid_.num_columns() - 1; }
  int last_row() const { return grid_.full_column() - 1; }

  // DoFs before they are numbered.
  static constexpr int unset = -2;
  static constexpr int shared_y = -3;

  const BeamParameters& parameters_;
  NodeGrid grid_;
  BodyMatrices body_;
};

void BeamMesher::place_nodes() {
  // Exact directions for the right angles, so that a horizontal surface is exactly horizontal.
  double cosine = std::cos(parameters_.angle);
  double sine = std::sin(parameters_.angle);
  if (std::abs(cosine) < 1e-15) cosine = 0.0;
  if (std::abs(sine) < 1e-15) sine = 0.0;
  body_.nodes.resize(grid_.num_nodes(), 3);
  for (int i = 0; i <= last_column(); ++i) {
    for (int j = 0; j <= last_row(); j += (i % 2 == 0 ? 1 : 2)) {
      const double a = parameters_.length * i / last_column();
      const double b = parameters_.thickness * (static_cast<double>(j) / last_row() - 0.5);
      body_.nodes.row(grid_.node(i, j)) << a * cosine - b * sine, a * sine + b * cosine, 0.0;
    }
  }
}

void BeamMesher::hold_end(Support support, int column) {
  const auto set = [&](int row, const std::array<int, 2>& dofs) {
    body_.node_dofs[static_cast<std::size_t>(grid_.node(column, row))] = dofs;
  };
  if (support == Support::pinned) set(grid_.through, {BodyMatrices::held, BodyMatrices::held});
  for (int j = 0; j <= last_row(); ++j) {
    if (support == Support::clamped) set(j, {BodyMatrices::held, BodyMatrices::held});
    if (support == Support::guided) set(j, {BodyMatrices::held, shared_y});
  }
}

/// Numbers the DoFs that no support holds. @return how many there are
int BeamMesher::number_dofs() {
  body_.node_dofs.assign(static_cast<std::size_t>(grid_.num_nodes()), {unset, unset});
  hold_end(parameters_.supports.start, 0);
  hold_end(parameters_.supports.end, last_column());
  int num_dofs = 0;
  for (auto& dofs : body_.node_dofs) {
    for (int& dof : dofs) {
      if (dof == unset) {
        dof = num_dofs++;
      } else if (dof == shared_y) {
        if (body_.load_dof == BodyMatrices::held) body_.load_dof = num_dofs++;
        dof = body_.load_dof;
      }
    }
  }
  return num_dofs;
}

std::vector<ElementDofs> BeamMesher::element_dofs() const {
  std::vector<ElementDofs> elements;
  elements.reserve(static_cast<std::size_t>(grid_.along) * static_cast<std::size_t>(grid_.through));
  for (int column = 0; column < grid_.along; ++column) {
    for (int row = 0; row < grid_.through; ++row) {
      ElementDofs& dofs = elements.emplace_back();
      std::size_t k = 0;
      for (const int node : grid_.element(column, row))
        for (const int dof : body_.node_dofs[static_cast<std::size_t>(node)]) dofs[k++] = dof;
    }
  }
  return elements;
}

/// All elements are congruent, so one pair of element matrices serves them all.
void BeamMesher::assemble_elements(int num_dofs) {
  ElementNodes<ElementShape::quad8> corners;
  for (int k = 0; k < 8; ++k)
    corners.row(k) = body_.nodes.row(grid_.element(0, 0)[static_cast<std::size_t>(k)]).head<2>();
  const auto& material = parameters_.material;
  const ElementSection section{
      ElasticLaw(IsotropicElasticity{material.youngs_modulus, material.poissons_ratio},
                 PlaneState::stress),
      material.density, parameters_.width};
  Q8Matrix stiffness = element_stiffness<ElementShape::quad8>(corners, section, 1);
  const auto nodal_mass = element_mass<ElementShape::quad8>(corners, section, 1);
  Q8Matrix mass = Q8Matrix::Zero();
  direction_part(mass, 0, 0) = direction_part(mass, 1, 1) = nodal_mass;
  balance_translations(stiffness);

  const std::vector<ElementDofs> elements = element_dofs();
  body_.mass = assemble(elements, mass, num_dofs);
  body_.stiffness = assemble(elements, stiffness, num_dofs);
  if (body_.follows_drive()) add_base_inertia(elements, mass);
}

/// Held nodes move with the support: every x displacement of an element counts.
void BeamMesher::add_base_inertia(const std::vector<ElementDofs>& elements, const Q8Matrix& mass) {
  body_.base_inertia = Eigen::VectorXd::Zero(body_.mass.rows());
  Eigen::Vector<double, 16> inertia = Eigen::Vector<double, 16>::Zero();
  for (Eigen::Index b = 0; b < 16; b += 2) inertia += mass.col(b);
  for (const ElementDofs& dofs : elements) {
    for (Eigen::Index a = 0; a < 16; ++a) {
      const int dof = dofs[static_cast<std::size_t>(a)];
      if (dof != BodyMatrices::held) body_.base_inertia(dof) += inertia(a);
    }
  }
}

void BeamMesher::name_points() {
  std::map<std::string, int>& points = body_.points;
  points = {{"start_bottom", grid_.node(0, 0)},
            {"start_top", grid_.node(0, last_row())},
            {"end_bottom", grid_.node(last_column(), 0)},
            {"end_top", grid_.node(last_column(), last_row())},
            {"start", grid_.node(0, grid_.through)},
            {"end", grid_.node(last_column(), grid_.through)}};
  const double rounding = 1e-12 * parameters_.thickness;
  const bool top_is_lower =
      body_.nodes(points["start_top"], 1) < body_.nodes(points["start_bottom"], 1) - rounding;
  points["tip"] = points[top_is_lower ? "start_top" : "start_bottom"];
  const bool start_is_free = parameters_.supports.start == Support::free;
  if (start_is_free != (parameters_.supports.end == Support::free))
    points["free_end"] = points[start_is_free ? "start_top" : "end_top"];
}

void BeamMesher::name_surfaces() {
  for (int i = 0; i <= last_column(); ++i) {
    body_.surfaces["top"].push_back(grid_.node(i, last_row()));
    body_.surfaces["bottom"].push_back(grid_.node(last_column() - i, 0));
  }
  for (int j = 0; j <= last_row(); ++j) {
    body_.surfaces["start_face"].push_back(grid_.node(0, j));
    body_.surfaces["end_face"].push_back(grid_.node(last_column(), last_row() - j));
  }
}

}  // namespace

BodyMatrices make_beam(const BeamParameters& parameters) {
  if (parameters.supports.start == Support::guided && parameters.supports.end == Support::guided)
    throw std::invalid_argument("make_beam: both ends are guided");
  BodyMatrices body = BeamMesher(parameters).make();
  if (parameters.across == AcrossMotion::rigid) add_motion_across(parameters, body);
  for (const auto& [name, point] : parameters.points)
    add_beam_point("points." + name, name, point, body);
  add_beam_loads(body);
  add_beam_springs(parameters, body);
  return body;
}

std::vector<std::array<int, 8>> beam_elements(const MeshParameters& mesh) {
  const NodeGrid grid{mesh.along, mesh.through};
  std::vector<std::array<int, 8>> elements;
  elements.reserve(static_cast<std::size_t>(mesh.along) * static_cast<std::size_t>(mesh.through));
  for (int column = 0; column < mesh.along; ++column)
    for (int row = 0; row < mesh.through; ++row) elements.push_back(grid.element(column, row));
  return elements;
}

BodyMatrices BeamParameters::make() const {
  return make_beam(*this);
}

std::vector<DrawnElement> BeamParameters::elements() const {
  std::vector<DrawnElement> drawn;
  for (const std::array<int, 8>& nodes : beam_elements(mesh))
    drawn.push_back({ElementShape::quad8, {nodes.begin(), nodes.end()}});
  return drawn;
}

double BeamParameters::num_slave_nodes(const std::string& name) const {
  if (name == "top" || name == "bottom") return 2.0 * mesh.along + 1.0;
  if (name == "start_face" || name == "end_face") return 2.0 * mesh.through + 1.0;
  if (points.contains(name)) return 3.0;  // of an edge
  return 1.0;
}

double BeamParameters::num_master_nodes(const std::string& name) const {
  const double nodes = num_slave_nodes(name);
  return interface.spacing ? std::min(nodes, 1.0 + std::ceil(length / *interface.spacing)) : nodes;
}

ReductionSize BeamParameters::reduction_size(double interface_nodes) const {
  return size_of(mesh, reduction, interface_nodes);
}

SizeKey BeamParameters::size_key() const {
  return {".mesh.along", "take fewer elements, or keep fewer master nodes (interface.spacing)"};
}

std::vector<Problem> BeamParameters::warnings() const {
  constexpr double most_slender = 1e4;
  const double ratio = length / thickness;
  if (ratio >= 1.0 && ratio <= most_slender) return {};
  return {{Refusal::wrong_value, "thickness",
           fmt::format(
               "is {:g} m on a length of {:g} m: {}; check the units of both", thickness, length,
               ratio < 1.0 ? "thicker than long" : fmt::format("{:.3g} times slender", ratio))}};
}

ReductionSize size_of(const MeshParameters& mesh, const ReductionParameters& reduction,
                      double interface_nodes) {
  const double a = mesh.along;
  const double t = mesh.through;
  const double nodes = (a + 1.0) * (2.0 * t + 1.0) + a * (t + 1.0);
  // Pairs of nodes that share an element: 64 of each element; those of a shared edge (9) count
  // twice, that of an inner corner four times less four edges.
  const double pairs = 64.0 * a * t - 9.0 * ((a - 1.0) * t + a * (t - 1.0)) + (a - 1.0) * (t - 1.0);
  ReductionSize size;
  size.interface = 2.0 * interface_nodes;
  size.watched = size.interface;
  size.unknowns = std::max(2.0 * nodes - size.interface, 0.0);
  size.modes = reduction.fixed_interface_modes;
  size.matrix_entries = (4.0 + 2.0) * pairs;  // the mass does not couple x and y
  // A row of a band matrix reaches over an element; of broad meshes nested dissection leaves less.
  const double shorter = std::min(a, t);
  const double band = 6.0 * shorter + 12.0;
  const double dissected = 12.0 * std::log2(size.unknowns + 2.0);
  size.factor_entries = size.unknowns * std::min(band, dissected);
  // Triplets of all element matrices, and the same sorted into columns.
  size.assembly_bytes = 256.0 * a * t * (16.0 + sparse_entry_bytes);
  return size;
}

}  // namespace stridor
