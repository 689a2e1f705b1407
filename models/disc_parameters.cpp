#include "models/disc_parameters.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "core/suggestion.hpp"
#include "coupling/contact_parameters.hpp"

namespace stridor {

const std::vector<std::string>& disc_term_names() {
  static const std::vector<std::string> names{"gyroscopic", "friction", "friction_damping",
                                              "geometric", "structural_damping"};
  return names;
}

DiscTerms disc_terms(const std::vector<std::string>& names) {
  DiscTerms terms;
  const std::vector<bool*> switches{&terms.gyroscopic, &terms.friction, &terms.friction_damping,
                                    &terms.geometric, &terms.structural_damping};
  for (const std::string& name : names) {
    const auto& known = disc_term_names();
    const auto found = std::find(known.begin(), known.end(), name);
    if (found == known.end())
      throw std::invalid_argument(fmt::format("disc: there is no term '{}'", name));
    *switches[static_cast<std::size_t>(found - known.begin())] = true;
  }
  return terms;
}

std::size_t num_contact_points(const DiscModelParameters& parameters) {
  if (!parameters.contact.offsets.empty()) return parameters.contact.offsets.size();
  if (parameters.pads.elastic)
    return 2 * static_cast<std::size_t>(parameters.pads.elastic->mesh.along) + 1;
  return 1;
}

std::vector<double> contact_offsets(const DiscModelParameters& parameters) {
  if (!parameters.contact.offsets.empty()) return parameters.contact.offsets;
  if (parameters.pads.elastic) return face_nodes(*parameters.pads.elastic);
  return {0.0};
}

namespace {

/// Contact points must lie on elastic pads, and leave them as many modes as are wanted.
void check_elastic_pads(const DiscModelParameters& model, std::vector<Problem>& problems) {
  const std::optional<ElasticPadParameters>& pad = model.pads.elastic;
  if (!pad) return;
  const std::string from_nodes = model.contact.offsets.empty() ? "pads.elastic.mesh.along" : "";
  const std::size_t asked = num_contact_points(model);
  if (asked > most_contact_points) {
    problems.push_back(
        {from_nodes.empty() ? "contact.offsets" : from_nodes,
         fmt::format("a pad may have up to {} contact points, got {}{}", most_contact_points, asked,
                     from_nodes.empty() ? "" : "; name some in contact.offsets"),
         {},
         0,
         0});
    return;
  }
  const std::vector<double> offsets = contact_offsets(model);
  bool is_inside = true;
  for (std::size_t i = 0; i < offsets.size(); ++i) {
    if (std::abs(offsets[i]) <= 0.5 * pad->length * (1.0 + 1e-12)) continue;
    is_inside = false;
    problems.push_back({fmt::format("contact.offsets.{}", i),
                        fmt::format("must lie on the pad, within {:g} m of its centre, got {:g} m",
                                    0.5 * pad->length, offsets[i]),
                        {},
                        0,
                        0});
  }
  if (!is_inside) return;
  const int most_modes = num_interior_dofs(*pad, offsets);
  if (pad->reduction.fixed_interface_modes > most_modes) {
    problems.push_back({"pads.elastic.reduction.fixed_interface_modes",
                        fmt::format("must not exceed {}, the degrees of freedom of the mesh away "
                                    "from the contact points, got {}",
                                    most_modes, pad->reduction.fixed_interface_modes),
                        {},
                        0,
                        0});
  }
}

}  // namespace

const Schema& MaterialDamping::schema() {
  static const Schema keys = SchemaOf<MaterialDamping>("material_damping")
                                 .real("alpha", &MaterialDamping::alpha,
                                       {.doc = "Damping in proportion to mass.",
                                        .unit = "s-1",
                                        .range = Range::non_negative(),
                                        .optional = true})
                                 .real("beta", &MaterialDamping::beta,
                                       {.doc = "Damping in proportion to stiffness.",
                                        .unit = "s",
                                        .range = Range::non_negative(),
                                        .optional = true});
  return keys;
}

const Schema& DiscParameters::schema() {
  static const Schema keys =
      SchemaOf<DiscParameters>("disc")
          .include(&DiscParameters::plate)
          .real("speed", &DiscParameters::speed,
                {.doc = "Angular velocity, towards growing angles. At 0 friction acts as in the "
                        "limit of slow rotation.",
                 .unit = "rad s-1",
                 .range = Range::non_negative()})
          .section("damping", &DiscParameters::damping,
                   {.doc = "Of the material, which turns with the disc.", .optional = true})
          .flag("centrifugal", &DiscParameters::centrifugal,
                {.doc = "Whether the stress of the rotation stiffens the disc.", .optional = true});
  return keys;
}

const Schema& PistonParameters::schema() {
  using P = PistonParameters;
  static const Schema keys =
      SchemaOf<P>("piston")
          .real("force", &P::force,
                {.doc = "Force on the back of each pad.",
                 .unit = "N",
                 .range = Range::non_negative(),
                 .optional = true})
          .real("displacement", &P::displacement,
                {.doc = "Displacement of the far ends of the springs towards the disc.",
                 .unit = "m",
                 .range = Range::non_negative(),
                 .optional = true})
          .check([](const P& piston, std::vector<Problem>& problems) {
            if (piston.force.has_value() == piston.displacement.has_value()) {
              problems.push_back({piston.force ? "displacement" : "force",
                                  "expected either `force` or `displacement`",
                                  {},
                                  0,
                                  0});
            }
          });
  return keys;
}

const Schema& PadsParameters::schema() {
  static const Schema keys =
      SchemaOf<PadsParameters>("pads")
          .real("mass", &PadsParameters::mass,
                {.doc = "Of each pad, where they are rigid.",
                 .unit = "kg",
                 .range = Range::positive(),
                 .optional = true})
          .section(
              "elastic", &PadsParameters::elastic,
              {.doc = "Pads that are elastic bodies, in place of `mass`. They move in the plane "
                      "of circumference and axis as plane stress, along the radius as rigid.",
               .optional = true})
          .section("stiffness", &PadsParameters::stiffness,
                   {.doc = "Springs that hold a pad; over the back of an elastic one they are "
                           "spread evenly."})
          .section("piston", &PadsParameters::piston,
                   {.doc = "What presses the pads on the disc, in place of contact.preload: the "
                           "sliding state is computed, with the forces of its contacts.",
                    .optional = true})
          .real("radius", &PadsParameters::radius,
                {.doc = "Where the pads stand, from the axis of the disc.",
                 .unit = "m",
                 .range = Range::positive()})
          .real("angle", &PadsParameters::angle,
                {.doc = "Where they stand around the disc; nothing depends on it.",
                 .unit = "rad",
                 .optional = true})
          .section("damping", &PadsParameters::damping, {.doc = "Of each pad.", .optional = true})
          .check([](const PadsParameters& pads, std::vector<Problem>& problems) {
            if (pads.mass.has_value() == pads.elastic.has_value()) {
              problems.push_back({pads.mass ? "elastic" : "mass",
                                  pads.mass ? "an elastic pad has the mass of its material; leave "
                                              "`mass` away"
                                            : "is required for rigid pads; elastic ones have a "
                                              "section `elastic` in its place",
                                  {},
                                  0,
                                  0});
            }
          });
  return keys;
}

const Schema& FaceFrictionParameters::schema() {
  static const Schema keys =
      SchemaOf<FaceFrictionParameters>("face_friction")
          .real("coefficient", &FaceFrictionParameters::coefficient,
                {.doc = "Coefficient of sliding friction, at most 100.",
                 .range = Range::non_negative()})
          .check([](const FaceFrictionParameters& friction, std::vector<Problem>& problems) {
            check_coefficient("coefficient", friction.coefficient, problems);
          });
  return keys;
}

const Schema& FaceContactParameters::schema() {
  using P = FaceContactParameters;
  static const Schema keys =
      SchemaOf<P>("face_contact")
          .real("preload", &P::preload,
                {.doc =
                     "Normal force of each pad in the sliding state, evenly on its contact points; "
                     "pads.piston takes its place.",
                 .unit = "N",
                 .range = Range::non_negative(),
                 .optional = true})
          .section("friction", &P::friction, {.doc = "Friction of both contacts."})
          .choice("formulation", &P::formulation,
                  {{"lagrange", ContactFormulation::lagrange},
                   {"penalty", ContactFormulation::penalty}},
                  {.doc = "Contact by Lagrange multipliers, or by springs.", .optional = true})
          .real("penalty", &P::penalty,
                {.doc = "Stiffness of the springs, one per contact point.",
                 .unit = "N m-1",
                 .range = Range::positive(),
                 .optional = true})
          .real_list("offsets", &P::offsets,
                     {.doc = "Contact points of a pad: distances from its centre along the "
                             "circumference; they share the preload. Default: one at the centre, "
                             "or every node of the face of an elastic pad.",
                      .unit = "m",
                      .optional = true})
          .check([](const P& contact, std::vector<Problem>& problems) {
            if (contact.formulation == ContactFormulation::penalty && !contact.penalty) {
              problems.push_back({"penalty", "is required with `formulation: penalty`", {}, 0, 0});
            }
          });
  return keys;
}

const Schema& DiscModelParameters::schema() {
  using P = DiscModelParameters;
  static const Schema keys =
      SchemaOf<P>("disc_model")
          .section("disc", &P::disc, {.doc = "The disc: an annular plate that spins."})
          .section("pads", &P::pads, {.doc = "Two pads, one on each face of the disc."})
          .section("contact", &P::contact, {.doc = "Contact between disc and pads."})
          .text_list("terms", &P::terms,
                     {.doc = "What is kept of the linearised equations: gyroscopic, friction, "
                             "friction_damping, geometric, structural_damping."})
          .check([](const P& model, std::vector<Problem>& problems) {
            const auto& known = disc_term_names();
            bool has_friction_damping = false;
            for (std::size_t i = 0; i < model.terms.size(); ++i) {
              const std::string& name = model.terms[i];
              has_friction_damping |= name == "friction_damping";
              if (std::find(known.begin(), known.end(), name) != known.end()) continue;
              std::string advice = did_you_mean(name, known);
              if (advice.empty()) advice = fmt::format("; known: {}", fmt::join(known, ", "));
              problems.push_back({"terms." + std::to_string(i),
                                  fmt::format("there is no term '{}'{}", name, advice),
                                  {},
                                  0,
                                  0});
            }
            if (has_friction_damping && !(model.disc.speed > 0.0)) {
              problems.push_back({"disc.speed",
                                  "must be positive with the term friction_damping, which grows "
                                  "without bound as the disc slows down",
                                  {},
                                  0,
                                  0});
            }
            const AnnularPlateParameters& plate = model.disc.plate;
            if (model.pads.radius <= plate.inner_radius ||
                model.pads.radius >= plate.outer_radius) {
              problems.push_back(
                  {"pads.radius",
                   fmt::format("must lie between the edges of the disc, {:g} and "
                               "{:g} m, got {:g} m",
                               plate.inner_radius, plate.outer_radius, model.pads.radius),
                   {},
                   0,
                   0});
            }
          })
          .check([](const P& model, std::vector<Problem>& problems) {
            if (model.contact.preload.has_value() == model.pads.piston.has_value()) {
              problems.push_back(
                  {model.contact.preload ? "pads.piston" : "contact.preload",
                   model.contact.preload
                       ? "the forces of the sliding state are prescribed by contact.preload; leave "
                         "one of them away"
                       : "is required, or a section pads.piston from which it follows",
                   {},
                   0,
                   0});
            }
          })
          .check([](const P& model, std::vector<Problem>& problems) {
            const bool is_rigid = model.contact.formulation == ContactFormulation::lagrange;
            const bool is_mass = model.pads.mass && !model.pads.elastic;
            if (!is_mass || !is_rigid || model.contact.offsets.size() < 2) return;
            problems.push_back(
                {"contact.offsets",
                 "pads that are rigid masses do not tilt, so that two rigid contacts "
                 "on each hold the disc between them twice over; keep one point, or "
                 "take `formulation: penalty` or elastic pads",
                 {},
                 0,
                 0});
          })
          .check(check_elastic_pads);
  return keys;
}

}  // namespace stridor
