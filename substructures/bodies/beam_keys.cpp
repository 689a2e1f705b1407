// Keys of a beam.
#include <fmt/format.h>

#include "substructures/bodies/beam.hpp"

namespace stridor {

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
                  {Refusal::wrong_value, "along", "along x through must not exceed 1e7 elements"});
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
              problems.push_back(
                  {Refusal::wrong_value, "end",
                   "both ends are guided; the drive can hold one end of a body only"});
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
                 .optional = true})
          .integer("modes", &InterfaceParameters::modes,
                   {.doc = "Number of characteristic constraint modes in which the interface moves, "
                           "for interfaces of hundreds or thousands of DoFs; default: in all of its DoFs.",
                    .optional = true,
                    .range = Range::between(1, 100'000)});
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
            problems.push_back({Refusal::wrong_value, "across",
                                "must be `held`: a support of an end holds it along z as well"});
          })
          .check([](const BeamParameters& beam, std::vector<Problem>& problems) {
            constexpr double flattest = 1e10;
            const double ratio =
                beam.length / beam.mesh.along / (beam.thickness / beam.mesh.through);
            if (ratio <= flattest && ratio >= 1.0 / flattest) return;
            problems.push_back({Refusal::wrong_value, "thickness",
                                fmt::format("{:g} m on a length of {:g} m makes elements {:.3g} "
                                            "times as long as high, of which no stiffness can be "
                                            "computed; check the units of both",
                                            beam.thickness, beam.length, ratio)});
          });
  return keys;
}

}  // namespace stridor
