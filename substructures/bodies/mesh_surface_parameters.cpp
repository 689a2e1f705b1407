#include "substructures/bodies/mesh_surface_parameters.hpp"

#include <limits>

namespace stridor {

Eigen::Vector3d in_space(const std::vector<double>& components) {
  Eigen::Vector3d vector = Eigen::Vector3d::Zero();
  for (std::size_t i = 0; i < components.size() && i < 3; ++i)
    vector(static_cast<Eigen::Index>(i)) = components[i];
  return vector;
}

void expect_components(const std::vector<double>& given, const char* key, bool may_be_empty,
                       std::vector<Problem>& problems) {
  if (given.size() == 2 || given.size() == 3 || (may_be_empty && given.empty())) return;
  problems.push_back({Refusal::wrong_size, key, "must be two or three numbers"});
}

namespace {

void expect_direction(const std::vector<double>& given, const char* key, bool may_be_empty,
                      std::vector<Problem>& problems) {
  expect_components(given, key, may_be_empty, problems);
  if (given.empty() || in_space(given).norm() > 0.0) return;
  problems.push_back({Refusal::wrong_value, key, "must not be zero"});
}

}  // namespace

const Schema& MeshPlaneParameters::schema() {
  using P = MeshPlaneParameters;
  static const Schema keys =
      SchemaOf<P>("mesh_plane")
          .real_list("normal", &P::normal,
                     {.doc = "Normal of the plane: two or three components, of any length."})
          .real("offset", &P::offset,
                {.doc = "Distance of the plane from the origin, along the normal.",
                 .unit = "m",
                 .optional = true})
          .check([](const P& plane, std::vector<Problem>& problems) {
            expect_direction(plane.normal, "normal", false, problems);
          });
  return keys;
}

const Schema& MeshCylinderParameters::schema() {
  using P = MeshCylinderParameters;
  static const Schema keys =
      SchemaOf<P>("mesh_cylinder")
          .real("radius", &P::radius,
                {.doc = "Of the cylinder.", .unit = "m", .range = Range::positive()})
          .real_list(
              "point", &P::point,
              {.doc = "A point of the axis; default: the origin.", .unit = "m", .optional = true})
          .real_list("axis", &P::axis,
                     {.doc = "Direction of the axis, of any length; default: z.", .optional = true})
          .check([](const P& cylinder, std::vector<Problem>& problems) {
            expect_components(cylinder.point, "point", true, problems);
            expect_direction(cylinder.axis, "axis", true, problems);
          });
  return keys;
}

const Schema& MeshBoxParameters::schema() {
  using P = MeshBoxParameters;
  static const Schema keys =
      SchemaOf<P>("mesh_box")
          .real_list("lowest", &P::lowest, {.doc = "Corner of the least coordinates.", .unit = "m"})
          .real_list("highest", &P::highest,
                     {.doc = "Corner of the largest coordinates.", .unit = "m"})
          .check([](const P& box, std::vector<Problem>& problems) {
            expect_components(box.lowest, "lowest", false, problems);
            expect_components(box.highest, "highest", false, problems);
            if (((in_space(box.highest) - in_space(box.lowest)).array() < 0.0).any())
              problems.push_back({Refusal::wrong_value, "highest", "must not be below `lowest`"});
          });
  return keys;
}

const Schema& MeshSurfaceParameters::schema() {
  using P = MeshSurfaceParameters;
  static const Schema keys =
      SchemaOf<P>("mesh_surface")
          .section("plane", &P::plane, {.doc = "What lies in a plane.", .optional = true})
          .section("cylinder", &P::cylinder, {.doc = "What lies on a cylinder.", .optional = true})
          .section("box", &P::box, {.doc = "What lies in a box.", .optional = true})
          .real("tolerance", &P::tolerance,
                {.doc = "Distance up to which nodes lie there; default: 1e-6 of the extent of the "
                        "mesh.",
                 .unit = "m",
                 .range = Range::positive(),
                 .optional = true})
          .check([](const P& surface, std::vector<Problem>& problems) {
            if (surface.plane || surface.cylinder || surface.box) return;
            problems.push_back(
                {Refusal::missing, "plane", "is missing; give a plane, a cylinder or a box"});
          });
  return keys;
}

MeshRegion MeshSurfaceParameters::region() const {
  MeshRegion region;
  if (plane) region.plane = {in_space(plane->normal), plane->offset};
  if (cylinder) {
    const Eigen::Vector3d axis = cylinder->axis.empty() ? Eigen::Vector3d(Eigen::Vector3d::UnitZ())
                                                        : in_space(cylinder->axis);
    region.cylinder = {in_space(cylinder->point), axis, cylinder->radius};
  }
  if (box) {
    region.box = {in_space(box->lowest), in_space(box->highest)};
    // Of a planar mesh, z = 0.
    if (box->lowest.size() == 2) region.box->lowest.z() = -std::numeric_limits<double>::max();
    if (box->highest.size() == 2) region.box->highest.z() = std::numeric_limits<double>::max();
  }
  return region;
}

}  // namespace stridor
