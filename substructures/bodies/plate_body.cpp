#include "substructures/bodies/plate_body.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <numbers>

#include "core/errors.hpp"

namespace stridor {
namespace {

/// A row on the coordinates as a sum over them.
DofSum sum_of_row(const Eigen::VectorXd& row) {
  DofSum sum;
  for (Eigen::Index i = 0; i < row.size(); ++i)
    if (row(i) != 0.0) sum.push_back({static_cast<int>(i), row(i)});
  return sum;
}

/// Adds a node that moves along y only.
int add_plate_node(BodyMatrices& body, const AnnularPlate& plate,
                   const AnnularPlateParameters& keys, double radius, double angle) {
  const auto node = static_cast<int>(body.node_dofs.size());
  body.nodes.conservativeResize(node + 1, Eigen::NoChange);
  body.nodes.row(node) << keys.outer_radius * angle, 0.0, radius - keys.outer_radius;
  body.node_dofs.push_back({BodyMatrices::held, BodyMatrices::held});
  body.dependent[node] = {DofSum{}, sum_of_row(plate.rows(radius, angle).w), DofSum{}};
  return node;
}

/// Circles of nodes from the inner edge to the outer one, close enough to show the waves of all
/// modes.
struct PlateGrid {
  int num_rings = 0;  ///< between circles
  int num_sectors = 0;

  explicit PlateGrid(const AnnularPlateParameters& keys)
      : num_rings(std::clamp(3 * keys.radial_modes, 4, 16)),
        num_sectors(std::clamp(12 * keys.nodal_diameters, 48, 384)) {}
  int node(int ring, int sector) const { return ring * num_sectors + sector % num_sectors; }
};

/// What figures show: nodes of the grid, and both edges as lines.
void add_grid(BodyMatrices& body, const AnnularPlate& plate, const AnnularPlateParameters& keys) {
  const PlateGrid grid(keys);
  for (int ring = 0; ring <= grid.num_rings; ++ring) {
    const double radius =
        std::lerp(keys.inner_radius, keys.outer_radius, 1.0 * ring / grid.num_rings);
    for (int sector = 0; sector < grid.num_sectors; ++sector)
      add_plate_node(body, plate, keys, radius, 2.0 * std::numbers::pi * sector / grid.num_sectors);
  }
  for (const int ring : {grid.num_rings, 0}) {
    std::vector<int>& edge = body.outlines.emplace_back();
    for (int sector = 0; sector <= grid.num_sectors; ++sector)
      edge.push_back(grid.node(ring, sector));
  }
}

void add_faces(BodyMatrices& body, std::shared_ptr<const AnnularPlate> plate,
               const PlateBodyParameters& keys) {
  BodyFace face;
  face.half_thickness = 0.5 * keys.plate.thickness;
  face.spin = keys.spin;
  face.inner_radius = keys.plate.inner_radius;
  face.outer_radius = keys.plate.outer_radius;
  face.rows = [plate = std::move(plate)](double radius, double angle) -> std::array<DofSum, 5> {
    const PlateRows rows = plate->rows(radius, angle);
    return {sum_of_row(rows.w), sum_of_row(rows.w_r), sum_of_row(rows.w_phi),
            sum_of_row(rows.w_r_phi), sum_of_row(rows.w_phi_phi)};
  };
  face.side = 1;
  body.faces["top"] = face;
  face.side = -1;
  body.faces["bottom"] = std::move(face);
}

}  // namespace

const Schema& PlatePointParameters::schema() {
  using P = PlatePointParameters;
  static const Schema keys =
      SchemaOf<P>("plate_point")
          .real("radius", &P::radius,
                {.doc = "From the axis.", .unit = "m", .range = Range::positive()})
          .real("angle", &P::angle,
                {.doc = "Around the axis; the point does not turn with the plate.",
                 .unit = "rad",
                 .optional = true});
  return keys;
}

const Schema& PlateDampingParameters::schema() {
  using P = PlateDampingParameters;
  static const Schema keys = SchemaOf<P>("plate_damping")
                                 .real("alpha", &P::alpha,
                                       {.doc = "In proportion to mass.",
                                        .unit = "s-1",
                                        .range = Range::non_negative(),
                                        .optional = true})
                                 .real("beta", &P::beta,
                                       {.doc = "In proportion to stiffness.",
                                        .unit = "s",
                                        .range = Range::non_negative(),
                                        .optional = true});
  return keys;
}

const Schema& PlateBodyParameters::schema() {
  using P = PlateBodyParameters;
  static const Schema keys =
      SchemaOf<P>("plate_body")
          .include(&P::plate)
          .real("spin", &P::spin,
                {.doc = "Angular velocity about the axis, towards growing angles. At 0 friction on "
                        "its faces acts as in the limit of slow rotation.",
                 .unit = "rad s-1",
                 .range = Range::non_negative()})
          .section("damping", &P::damping,
                   {.doc = "Of the material, which turns with the plate.", .optional = true})
          .flag("centrifugal", &P::centrifugal,
                {.doc = "Whether the stress of the rotation stiffens the plate.",
                 .optional = true})
          .named_sections("points", &P::points,
                          {.doc = "Points at rest in space whose motion along the axis, y, is "
                                  "recorded, by name.",
                           .optional = true})
          .check([](const P& body, std::vector<Problem>& problems) {
            for (const auto& [name, point] : body.points) {
              if (point.radius >= body.plate.inner_radius &&
                  point.radius <= body.plate.outer_radius)
                continue;
              problems.push_back(
                  {Refusal::wrong_value, fmt::format("points.{}.radius", name),
                   fmt::format("must lie on the plate, {:g} to {:g} m, got {:g} m",
                               body.plate.inner_radius, body.plate.outer_radius, point.radius)});
            }
          });
  return keys;
}

BodyMatrices PlateBodyParameters::make() const {
  const auto modes =
      std::make_shared<const AnnularPlate>(plate, centrifugal ? spin : 0.0);
  const Eigen::Index n = modes->size();
  const double turning = terms().rotation ? spin : 0.0;
  const double alpha = terms().damping ? damping.alpha : 0.0;
  const double beta = terms().damping ? damping.beta : 0.0;
  const Eigen::VectorXd elastic = modes->omega().array().square();
  const Eigen::MatrixXd S = modes->spin();

  BodyMatrices body;
  body.is_modal = true;
  body.lowest_omitted = modes->lowest_omitted();
  body.mass = Eigen::MatrixXd::Identity(n, n).sparseView();
  Eigen::MatrixXd stiffness = elastic.asDiagonal();
  if (turning == 0.0) {
    body.damping.alpha = alpha;
    body.damping.beta = beta;
  } else {
    // β acts on the elastic stiffness alone, which K is not.
    const Eigen::MatrixXd C = (alpha + beta * elastic.array()).matrix().asDiagonal();
    stiffness -= turning * turning * S.transpose() * S;
    body.damping.alpha = alpha;
    const Eigen::MatrixXd by_stiffness = (beta * elastic).asDiagonal();
    body.velocity = (2.0 * turning * S + by_stiffness).sparseView();
    body.circulatory = (turning * C * S).sparseView();
  }
  body.stiffness = stiffness.sparseView();

  body.nodes.resize(0, 3);
  add_grid(body, *modes, plate);
  for (const auto& [name, point] : points)
    body.points[name] = add_plate_node(body, *modes, plate, point.radius, point.angle);
  add_faces(body, modes, *this);
  return body;
}

std::vector<DrawnElement> PlateBodyParameters::elements() const {
  const PlateGrid grid(plate);
  std::vector<DrawnElement> all;
  for (int ring = 0; ring < grid.num_rings; ++ring)
    for (int sector = 0; sector < grid.num_sectors; ++sector)
      all.push_back({ElementShape::quad4,
                     {grid.node(ring, sector), grid.node(ring + 1, sector),
                      grid.node(ring + 1, sector + 1), grid.node(ring, sector + 1)}});
  return all;
}

ReductionSize PlateBodyParameters::reduction_size(double /*interface_nodes*/) const {
  ReductionSize size;
  size.interface = (2.0 * plate.nodal_diameters + 1.0) * plate.radial_modes;
  return size;
}

SizeKey PlateBodyParameters::size_key() const {
  return {".nodal_diameters", "keep fewer nodal diameters or radial modes"};
}

}  // namespace stridor
