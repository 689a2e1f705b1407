#include "substructures/bodies/mesh_material.hpp"

#include <fmt/format.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <stdexcept>
#include <utility>

#include "core/errors.hpp"
#include "substructures/bodies/mesh_surface_parameters.hpp"

namespace stridor {
namespace {

void add_problem(std::vector<Problem>& problems, Refusal refusal, const char* key,
                 const char* text) {
  problems.push_back({refusal, key, text});
}

Eigen::Vector3d turned(const Eigen::Matrix2d& turn, Eigen::Vector3d vector) {
  vector.head<2>() = (turn * vector.head<2>()).eval();
  return vector;
}

std::array<double, 3> triple(const std::vector<double>& numbers) {
  return {numbers[0], numbers[1], numbers[2]};
}

/// Axes 1, 2, 3 as columns, in the frame of the body.
Eigen::Matrix3d fixed_axes(const MaterialAxesParameters& axes, const Eigen::Matrix2d& turn) {
  if (axes.angle) {
    const double c = std::cos(*axes.angle);
    const double s = std::sin(*axes.angle);
    return axes_from(turned(turn, {c, s, 0.0}), turned(turn, {-s, c, 0.0}));
  }
  return axes_from(turned(turn, in_space(axes.first)), turned(turn, in_space(axes.second)));
}

}  // namespace

const Schema& OrthotropicParameters::schema() {
  using P = OrthotropicParameters;
  static const Schema keys =
      SchemaOf<P>("orthotropic")
          .real_list("youngs_moduli", &P::youngs_moduli,
                     {.doc = "Young's moduli along the axes 1, 2 and 3 of the material.",
                      .unit = "Pa",
                      .range = Range::positive()})
          .real_list("poissons_ratios", &P::poissons_ratios,
                     {.doc = "Poisson's ratios 12, 13 and 23: contraction along the second axis "
                             "over extension along the first, under a stress along the first."})
          .real_list(
              "shear_moduli", &P::shear_moduli,
              {.doc = "Shear moduli 12, 13 and 23.", .unit = "Pa", .range = Range::positive()})
          .check([](const P& given, std::vector<Problem>& problems) {
            for (const auto& [key, list] : {std::pair("youngs_moduli", &given.youngs_moduli),
                                            std::pair("poissons_ratios", &given.poissons_ratios),
                                            std::pair("shear_moduli", &given.shear_moduli)})
              if (list->size() != 3)
                add_problem(problems, Refusal::wrong_size, key, "must be three numbers");
          });
  return keys;
}

const Schema& AxisParameters::schema() {
  using P = AxisParameters;
  static const Schema keys =
      SchemaOf<P>("axis")
          .real_list("point", &P::point,
                     {.doc = "A point of the axis, in the frame of the mesh; default: the origin.",
                      .unit = "m",
                      .optional = true})
          .real_list("direction", &P::direction,
                     {.doc = "Of the axis, of any length; default: z.", .optional = true})
          .check([](const P& axis, std::vector<Problem>& problems) {
            expect_components(axis.point, "point", true, problems);
            expect_components(axis.direction, "direction", true, problems);
            if (!axis.direction.empty() && !(in_space(axis.direction).norm() > 0.0))
              add_problem(problems, Refusal::wrong_value, "direction", "must not be zero");
          });
  return keys;
}

AxisOfRevolution AxisParameters::axis(const Eigen::Matrix2d& turn) const {
  AxisOfRevolution axis;
  axis.point = turned(turn, in_space(point));
  if (!direction.empty()) axis.direction = turned(turn, in_space(direction)).normalized();
  return axis;
}

const Schema& MaterialAxesParameters::schema() {
  using P = MaterialAxesParameters;
  static const Schema keys =
      SchemaOf<P>("material_axes")
          .real("angle", &P::angle,
                {.doc = "Of axis 1 against x of the mesh, about z; axis 3 is z.",
                 .unit = "rad",
                 .optional = true})
          .real_list("first", &P::first,
                     {.doc = "In the place of `angle`: axis 1, of any length.", .optional = true})
          .real_list("second", &P::second,
                     {.doc = "With `first`: a vector in the plane of the axes 1 and 2, on the side "
                             "of axis 2.",
                      .optional = true})
          .section("around", &P::around,
                   {.doc = "In the place of `angle`: axis 1 is radial, 2 tangential and 3 along a "
                           "line.",
                    .optional = true})
          .check([](const P& axes, std::vector<Problem>& problems) {
            const bool has_vectors = !axes.first.empty() || !axes.second.empty();
            if (!axes.angle && !axes.around && !has_vectors)
              add_problem(problems, Refusal::wrong_value, "",
                          "is an angle, the vectors `first` and `second`, or `around` a line: one "
                          "of the three");
            if (axes.around && axes.angle)
              add_problem(problems, Refusal::contradiction, "angle",
                          "cannot stand beside `around`, which says the axes");
            for (const auto& [key, vector] :
                 {std::pair("first", &axes.first), std::pair("second", &axes.second)}) {
              if (vector->empty() || (!axes.angle && !axes.around)) continue;
              add_problem(problems, Refusal::contradiction, key,
                          axes.around ? "cannot stand beside `around`, which says the axes"
                                      : "cannot stand beside `angle`, which says the axes");
            }
            if (!has_vectors) return;
            expect_components(axes.first, "first", false, problems);
            expect_components(axes.second, "second", false, problems);
            const Eigen::Vector3d one = in_space(axes.first);
            const Eigen::Vector3d two = in_space(axes.second);
            if (!(one.cross(two).norm() > 1e-6 * one.norm() * two.norm()))
              add_problem(problems, Refusal::wrong_value, "second",
                          "must not be parallel to `first`, nor zero");
          });
  return keys;
}

const Schema& MaterialDampingParameters::schema() {
  using P = MaterialDampingParameters;
  static const Schema keys =
      SchemaOf<P>("material_damping")
          .real("alpha", &P::alpha,
                {.doc = "Mass-proportional damping of the elements of this material.",
                 .unit = "s-1",
                 .range = Range::non_negative()})
          .real("beta", &P::beta,
                {.doc = "Stiffness-proportional damping of them.",
                 .unit = "s",
                 .range = Range::non_negative()});
  return keys;
}

const Schema& MeshMaterialParameters::schema() {
  using P = MeshMaterialParameters;
  static const Schema keys =
      SchemaOf<P>("mesh_material")
          .real("youngs_modulus", &P::youngs_modulus,
                {.doc = "Young's modulus of an isotropic material.",
                 .unit = "Pa",
                 .range = Range::positive(),
                 .optional = true})
          .real("poissons_ratio", &P::poissons_ratio,
                {.doc = "Poisson's ratio of an isotropic material.",
                 .range = Range::inside(-1.0, 0.5),
                 .optional = true})
          .real("density", &P::density,
                {.doc = "Mass density.", .unit = "kg m-3", .range = Range::positive()})
          .section("orthotropic", &P::orthotropic,
                   {.doc = "Moduli of a material with three planes of symmetry, in the place of "
                           "youngs_modulus and poissons_ratio.",
                    .optional = true})
          .section(
              "axes", &P::axes,
              {.doc = "Of an orthotropic material; default: those of the mesh.", .optional = true})
          .section("damping", &P::damping,
                   {.doc = "Rayleigh damping of this material, besides that of the body.",
                    .optional = true})
          .real("loss_factor", &P::loss_factor,
                {.doc = "Structural damping of this material: its complex stiffness is K(1 + iη). "
                        "Every mode of the body gets the viscous damping of the same loss.",
                 .range = Range::non_negative(),
                 .optional = true})
          .check([](const P& material, std::vector<Problem>& problems) {
            for (const auto& [key, number] :
                 {std::pair("youngs_modulus", material.youngs_modulus),
                  std::pair("poissons_ratio", material.poissons_ratio)}) {
              if (number && material.orthotropic)
                add_problem(problems, Refusal::contradiction, key,
                            "is not used: the material is orthotropic");
              if (!number && !material.orthotropic)
                add_problem(problems, Refusal::missing, key,
                            "is missing; an isotropic material has both, another one "
                            "`orthotropic`");
            }
            if (material.axes && !material.orthotropic)
              add_problem(problems, Refusal::contradiction, "axes",
                          "are not used: the material is alike in all directions");
          });
  return keys;
}

ElementSection MeshMaterialParameters::section(PlaneState state, const Eigen::Matrix2d& turn,
                                               double thickness) const {
  if (!orthotropic) {
    if (!youngs_modulus || !poissons_ratio)
      throw ConfigError(Refusal::missing, "youngs_modulus", "is missing, with poissons_ratio");
    return {ElasticLaw(IsotropicElasticity{*youngs_modulus, *poissons_ratio}, state), density,
            thickness};
  }
  const OrthotropicElasticity elasticity{triple(orthotropic->youngs_moduli),
                                         triple(orthotropic->poissons_ratios),
                                         triple(orthotropic->shear_moduli)};
  const bool is_fixed = !axes || !axes->around;
  Eigen::Matrix3d fixed = Eigen::Matrix3d::Identity();
  fixed.topLeftCorner<2, 2>() = turn;
  if (axes && is_fixed) fixed = fixed_axes(*axes, turn);
  if (is_fixed && state != PlaneState::none &&
      !(fixed.col(2) - Eigen::Vector3d::UnitZ()).isZero(1e-9))
    throw ConfigError(Refusal::wrong_mesh, "axes",
                      "axis 3 of a planar mesh is z; `first` and `second` lie in its plane");
  try {
    ElementSection section{ElasticLaw(elasticity, state, fixed), density, thickness};
    if (is_fixed) return section;
    const AxisOfRevolution axis = axes->around->axis(turn);
    if (state != PlaneState::none && !(axis.direction - Eigen::Vector3d::UnitZ()).isZero(1e-9))
      throw ConfigError(Refusal::wrong_mesh, "axes.around.direction", "is z for a planar mesh");
    section.law_at = [elasticity, state, axis](const Eigen::Vector3d& place) {
      const std::optional<Eigen::Matrix3d> frame = axis.frame_at(place);
      if (!frame)
        throw std::invalid_argument("a material with radial axes reaches the line they are about");
      return ElasticLaw(elasticity, state, *frame).matrix();
    };
    return section;
  } catch (const std::invalid_argument&) {
    throw ConfigError(Refusal::wrong_matrix, "orthotropic",
                      "is not positive definite: |ν_ij| must be below √(E_i/E_j), and 1 − ν12 ν21 "
                      "− ν23 ν32 − ν13 ν31 − 2 ν21 ν32 ν13 positive");
  }
}

}  // namespace stridor
