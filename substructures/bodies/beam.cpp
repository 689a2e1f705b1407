#include "substructures/bodies/beam.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <stdexcept>

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

const Schema& MaterialParameters::schema() {
  static const Schema keys =
      SchemaOf<MaterialParameters>("material")
          .real("youngs_modulus", &MaterialParameters::youngs_modulus,
                {.doc = "Young's modulus.", .unit = "Pa", .range = Range::positive()})
          .real("poissons_ratio", &MaterialParameters::poissons_ratio,
                {.doc = "Poisson's ratio.", .range = Range::inside(-1.0, 0.5)})
          .real("density", &MaterialParameters::density,
                {.doc = "Mass density.", .unit = "kg m-3", .range = Range::positive()});
  return keys;
}

const Schema& MeshParameters::schema() {
  static const Schema keys =
      SchemaOf<MeshParameters>("mesh")
          .integer("along", &MeshParameters::along,
                   {.doc = "Elements along the axis.", .range = Range::between(1, 1'000'000)})
          .integer("through", &MeshParameters::through,
                   {.doc = "Elements through the thickness.", .range = Range::between(1, 10'000)})
          .check([](const MeshParameters& mesh, std::vector<Problem>& problems) {
            if (static_cast<double>(mesh.along) * mesh.through > 1e7) {
              problems.push_back(
                  {"along", "along x through must not exceed 1e7 elements", {}, 0, 0});
            }
          });
  return keys;
}

const Schema& SupportParameters::schema() {
  static const std::vector<std::pair<std::string, Support>> names{{"free", Support::free},
                                                                  {"clamped", Support::clamped},
                                                                  {"pinned", Support::pinned},
                                                                  {"guided", Support::guided}};
  static const Schema keys =
      SchemaOf<SupportParameters>("supports")
          .choice("start", &SupportParameters::start, names,
                  {.doc = "Support of the end where the axis starts.", .optional = true})
          .choice("end", &SupportParameters::end, names,
                  {.doc = "Support of the other end; a guided end follows drive.velocity in x and "
                          "carries drive.load in y.",
                   .optional = true})
          .check([](const SupportParameters& supports, std::vector<Problem>& problems) {
            if (supports.start == Support::guided && supports.end == Support::guided) {
              problems.push_back({"end",
                                  "both ends are guided; the drive can hold one end of a body only",
                                  {},
                                  0,
                                  0});
            }
          });
  return keys;
}

const Schema& InterfaceParameters::schema() {
  static const Schema keys =
      SchemaOf<InterfaceParameters>("interface")
          .real("spacing", &InterfaceParameters::spacing,
                {.doc = "Distance of the surface nodes kept as master nodes; default: every node.",
                 .unit = "m",
                 .range = Range::positive(),
                 .optional = true});
  return keys;
}

const Schema& ReductionParameters::schema() {
  static const Schema keys =
      SchemaOf<ReductionParameters>("reduction")
          .integer("fixed_interface_modes", &ReductionParameters::fixed_interface_modes,
                   {.doc = "Number of fixed-interface modes kept (Craig-Bampton).",
                    .range = Range::between(0, 100'000)});
  return keys;
}

const Schema& BeamParameters::schema() {
  static const Schema keys =
      SchemaOf<BeamParameters>("beam")
          .real("length", &BeamParameters::length,
                {.doc = "Length along the axis.", .unit = "m", .range = Range::positive()})
          .real("thickness", &BeamParameters::thickness,
                {.doc = "Thickness in the plane.", .unit = "m", .range = Range::positive()})
          .real("width", &BeamParameters::width,
                {.doc = "Width out of the plane.", .unit = "m", .range = Range::positive()})
          .real("angle", &BeamParameters::angle,
                {.doc = "Angle of the axis, from its start (the tip) to its end, against +x.",
                 .unit = "rad",
                 .range = Range::between(-7.0, 7.0)})
          .section("material", &BeamParameters::material,
                   {.doc = "Isotropic linear elastic material."})
          .section("mesh", &BeamParameters::mesh,
                   {.doc = "Structured mesh of plane-stress Q8 elements."})
          .section("damping", &BeamParameters::damping,
                   {.doc = "Rayleigh damping and its schedule."})
          .section("supports", &BeamParameters::supports,
                   {.doc = "What holds the ends.", .optional = true})
          .named_sections("points", &BeamParameters::points,
                          {.doc = "Points of its own, by name.", .optional = true})
          .named_sections("springs", &BeamParameters::springs,
                          {.doc = "Springs to the ground, by name; the damping of the beam "
                                  "includes them.",
                           .optional = true})
          .choice("across", &BeamParameters::across,
                  {{"held", AcrossMotion::held}, {"rigid", AcrossMotion::rigid}},
                  {.doc = "Motion across the plane, along z: none, or as a rigid body on what "
                          "springs have along z.",
                   .optional = true})
          .section("interface", &BeamParameters::interface,
                   {.doc = "Surface nodes kept for contact.", .optional = true})
          .section("reduction", &BeamParameters::reduction, {.doc = "Craig-Bampton reduction."})
          .check([](const BeamParameters& beam, std::vector<Problem>& problems) {
            if (beam.across == AcrossMotion::held) return;
            if (beam.supports.start == Support::free && beam.supports.end == Support::free) return;
            problems.push_back({"across",
                                "must be `held`: a support of an end holds it along z as well",
                                {},
                                0,
                                0});
          })
          .check([](const BeamParameters& beam, std::vector<Problem>& problems) {
            constexpr double flattest = 1e10;
            const double ratio =
                beam.length / beam.mesh.along / (beam.thickness / beam.mesh.through);
            if (ratio <= flattest && ratio >= 1.0 / flattest) return;
            problems.push_back({"thickness",
                                fmt::format("{:g} m on a length of {:g} m makes elements {:.3g} "
                                            "times as long as high, of which no stiffness can be "
                                            "computed; check the units of both",
                                            beam.thickness, beam.length, ratio),
                                {},
                                0,
                                0});
          });
  return keys;
}

namespace {

BodyMatrices make_mesh(const BeamParameters& parameters) {
  const auto& supports = parameters.supports;
  if (supports.start == Support::guided && supports.end == Support::guided) {
    throw std::invalid_argument("make_beam: both ends are guided");
  }
  const NodeGrid grid{parameters.mesh.along, parameters.mesh.through};
  const int last_column = grid.num_columns() - 1;
  const int last_row = grid.full_column() - 1;

  BodyMatrices body;
  body.damping = parameters.damping;

  // Exact directions for the right angles, so that a horizontal surface is exactly horizontal.
  double cosine = std::cos(parameters.angle);
  double sine = std::sin(parameters.angle);
  if (std::abs(cosine) < 1e-15) cosine = 0.0;
  if (std::abs(sine) < 1e-15) sine = 0.0;
  body.nodes.resize(grid.num_nodes(), 3);
  for (int i = 0; i <= last_column; ++i) {
    for (int j = 0; j <= last_row; j += (i % 2 == 0 ? 1 : 2)) {
      const double a = parameters.length * i / last_column;
      const double b = parameters.thickness * (static_cast<double>(j) / last_row - 0.5);
      body.nodes.row(grid.node(i, j)) << a * cosine - b * sine, a * sine + b * cosine, 0.0;
    }
  }

  // Supports first mark held and shared DoFs; the DoFs are numbered after that.
  constexpr int unset = -2;
  constexpr int shared_y = -3;
  body.node_dofs.assign(static_cast<std::size_t>(grid.num_nodes()), {unset, unset});
  const auto dofs_of = [&](int node) -> std::array<int, 2>& {
    return body.node_dofs[static_cast<std::size_t>(node)];
  };
  const auto support_end = [&](Support support, int column) {
    if (support == Support::pinned)
      dofs_of(grid.node(column, grid.through)) = {BodyMatrices::held, BodyMatrices::held};
    for (int j = 0; j <= last_row; ++j) {
      if (support == Support::clamped)
        dofs_of(grid.node(column, j)) = {BodyMatrices::held, BodyMatrices::held};
      if (support == Support::guided)
        dofs_of(grid.node(column, j)) = {BodyMatrices::held, shared_y};
    }
  };
  support_end(supports.start, 0);
  support_end(supports.end, last_column);

  int num_dofs = 0;
  for (auto& dofs : body.node_dofs) {
    for (int& dof : dofs) {
      if (dof == unset) {
        dof = num_dofs++;
      } else if (dof == shared_y) {
        if (body.load_dof == BodyMatrices::held) body.load_dof = num_dofs++;
        dof = body.load_dof;
      }
    }
  }

  // All elements are congruent, so one pair of element matrices serves them all.
  const auto element_nodes = [&](int column, int row) { return grid.element(column, row); };
  ElementNodes<ElementShape::quad8> corners;
  for (int k = 0; k < 8; ++k)
    corners.row(k) = body.nodes.row(element_nodes(0, 0)[static_cast<std::size_t>(k)]).head<2>();
  const auto& material = parameters.material;
  const ElementSection section{
      ElasticLaw(IsotropicElasticity{material.youngs_modulus, material.poissons_ratio},
                 PlaneState::stress),
      material.density, parameters.width};
  Q8Matrix stiffness = element_stiffness<ElementShape::quad8>(corners, section, 1);
  const auto nodal_mass = element_mass<ElementShape::quad8>(corners, section, 1);
  Q8Matrix mass = Q8Matrix::Zero();
  direction_part(mass, 0, 0) = direction_part(mass, 1, 1) = nodal_mass;
  balance_translations(stiffness);

  std::vector<ElementDofs> elements;
  elements.reserve(static_cast<std::size_t>(grid.along) * static_cast<std::size_t>(grid.through));
  for (int column = 0; column < grid.along; ++column) {
    for (int row = 0; row < grid.through; ++row) {
      ElementDofs& dofs = elements.emplace_back();
      std::size_t k = 0;
      for (const int node : element_nodes(column, row))
        for (const int dof : dofs_of(node)) dofs[k++] = dof;
    }
  }
  body.mass = assemble(elements, mass, num_dofs);
  body.stiffness = assemble(elements, stiffness, num_dofs);
  if (body.follows_drive()) {
    body.base_inertia = Eigen::VectorXd::Zero(num_dofs);
    // Held nodes move with the support: every x displacement of an element counts.
    Eigen::Vector<double, 16> inertia = Eigen::Vector<double, 16>::Zero();
    for (Eigen::Index b = 0; b < 16; b += 2) inertia += mass.col(b);
    for (const ElementDofs& dofs : elements) {
      for (Eigen::Index a = 0; a < 16; ++a) {
        const int dof = dofs[static_cast<std::size_t>(a)];
        if (dof != BodyMatrices::held) body.base_inertia(dof) += inertia(a);
      }
    }
  }

  body.points = {
      {"start_bottom", grid.node(0, 0)},         {"start_top", grid.node(0, last_row)},
      {"end_bottom", grid.node(last_column, 0)}, {"end_top", grid.node(last_column, last_row)},
      {"start", grid.node(0, grid.through)},     {"end", grid.node(last_column, grid.through)}};
  const double rounding = 1e-12 * parameters.thickness;
  const bool top_is_lower = body.nodes(body.points["start_top"], 1) <
                            body.nodes(body.points["start_bottom"], 1) - rounding;
  body.points["tip"] = body.points[top_is_lower ? "start_top" : "start_bottom"];
  const bool start_is_free = supports.start == Support::free;
  if (start_is_free != (supports.end == Support::free)) {
    body.points["free_end"] = body.points[start_is_free ? "start_top" : "end_top"];
  }

  for (int i = 0; i <= last_column; ++i) {
    body.surfaces["top"].push_back(grid.node(i, last_row));
    body.surfaces["bottom"].push_back(grid.node(last_column - i, 0));
  }
  for (int j = 0; j <= last_row; ++j) {
    body.surfaces["start_face"].push_back(grid.node(0, j));
    body.surfaces["end_face"].push_back(grid.node(last_column, last_row - j));
  }
  return body;
}

}  // namespace

BodyMatrices make_beam(const BeamParameters& parameters) {
  BodyMatrices body = make_mesh(parameters);
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
  return {{"thickness",
           fmt::format(
               "is {:g} m on a length of {:g} m: {}; check the units of both", thickness, length,
               ratio < 1.0 ? "thicker than long" : fmt::format("{:.3g} times slender", ratio)),
           {},
           0,
           0}};
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
