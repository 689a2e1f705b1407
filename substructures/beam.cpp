#include "substructures/beam.hpp"

#include <cmath>
#include <stdexcept>

#include "substructures/q8_element.hpp"

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
};

using Triplets = std::vector<Eigen::Triplet<double>>;

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
          .section("interface", &BeamParameters::interface,
                   {.doc = "Surface nodes kept for contact.", .optional = true})
          .section("reduction", &BeamParameters::reduction, {.doc = "Craig-Bampton reduction."});
  return keys;
}

BodyMatrices make_beam(const BeamParameters& parameters) {
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
  body.nodes.resize(grid.num_nodes(), 2);
  for (int i = 0; i <= last_column; ++i) {
    for (int j = 0; j <= last_row; j += (i % 2 == 0 ? 1 : 2)) {
      const double a = parameters.length * i / last_column;
      const double b = parameters.thickness * (static_cast<double>(j) / last_row - 0.5);
      body.nodes.row(grid.node(i, j)) << a * cosine - b * sine, a * sine + b * cosine;
    }
  }

  // Supports first mark what is held or shared; the DoFs are numbered after that.
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
  const auto element_nodes = [&](int column, int row) {
    const int i = 2 * column;
    const int j = 2 * row;
    return std::array<int, 8>{grid.node(i, j),         grid.node(i + 2, j), grid.node(i + 2, j + 2),
                              grid.node(i, j + 2),     grid.node(i + 1, j), grid.node(i + 2, j + 1),
                              grid.node(i + 1, j + 2), grid.node(i, j + 1)};
  };
  Q8Nodes corners;
  for (int k = 0; k < 8; ++k)
    corners.row(k) = body.nodes.row(element_nodes(0, 0)[static_cast<std::size_t>(k)]);
  const auto& material = parameters.material;
  const Q8Element element =
      make_q8_element(corners, {material.youngs_modulus, material.poissons_ratio, material.density},
                      parameters.width);

  Triplets mass;
  Triplets stiffness;
  const std::size_t num_entries =
      static_cast<std::size_t>(grid.along) * static_cast<std::size_t>(grid.through) * 256;
  mass.reserve(num_entries);
  stiffness.reserve(num_entries);
  if (body.follows_drive()) body.base_inertia = Eigen::VectorXd::Zero(num_dofs);
  for (int column = 0; column < grid.along; ++column) {
    for (int row = 0; row < grid.through; ++row) {
      const std::array<int, 8> nodes = element_nodes(column, row);
      for (int a = 0; a < 16; ++a) {
        const int dof_a =
            dofs_of(nodes[static_cast<std::size_t>(a / 2)])[static_cast<std::size_t>(a % 2)];
        if (dof_a == BodyMatrices::held) continue;
        for (int b = 0; b < 16; ++b) {
          const int dof_b =
              dofs_of(nodes[static_cast<std::size_t>(b / 2)])[static_cast<std::size_t>(b % 2)];
          if (body.follows_drive() && b % 2 == 0) body.base_inertia(dof_a) += element.mass(a, b);
          if (dof_b == BodyMatrices::held) continue;
          mass.emplace_back(dof_a, dof_b, element.mass(a, b));
          stiffness.emplace_back(dof_a, dof_b, element.stiffness(a, b));
        }
      }
    }
  }
  body.mass.resize(num_dofs, num_dofs);
  body.mass.setFromTriplets(mass.begin(), mass.end());
  body.stiffness.resize(num_dofs, num_dofs);
  body.stiffness.setFromTriplets(stiffness.begin(), stiffness.end());

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

}  // namespace stridor
