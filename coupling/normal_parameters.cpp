#include "coupling/normal_parameters.hpp"

#include <fmt/format.h>

#include <stdexcept>

namespace stridor {
namespace {

const char* name_of(NormalLaw law) {
  switch (law) {
    case NormalLaw::multiplier:
      return "multiplier";
    case NormalLaw::penalty:
      return "penalty";
    case NormalLaw::viscoelastic:
      return "viscoelastic";
  }
  return "";
}

void check_keys_of_law(const NormalParameters& normal, std::vector<Problem>& problems) {
  const auto demand = [&](const char* key, bool is_given, NormalLaw of) {
    const bool is_wanted = normal.law == of;
    if (is_given == is_wanted) return;
    problems.push_back(
        {key,
         fmt::format("{} by the normal law {}", is_wanted ? "missing: needed" : "not used",
                     name_of(normal.law)),
         {},
         0,
         0});
  };
  demand("stiffness", normal.stiffness.has_value(), NormalLaw::penalty);
  demand("radius", normal.radius.has_value(), NormalLaw::viscoelastic);
  demand("modulus", normal.modulus.has_value(), NormalLaw::viscoelastic);
  demand("creep_time", normal.creep_time.has_value(), NormalLaw::viscoelastic);
  if (normal.preload && normal.law == NormalLaw::viscoelastic) {
    problems.push_back({"preload", "not used by the normal law viscoelastic", {}, 0, 0});
  }
  if (normal.has_table() && !normal.form.ends_with(".h5")) {
    problems.push_back({"form",
                        fmt::format("'{}' is neither published_fit nor boundary_element nor a file "
                                    "of `stridor contact --table` (*.h5)",
                                    normal.form),
                        {},
                        0,
                        0});
  }
  if (normal.law != NormalLaw::viscoelastic && normal.form != NormalParameters::published_fit) {
    problems.push_back(
        {"form", fmt::format("not used by the normal law {}", name_of(normal.law)), {}, 0, 0});
  }
}

std::shared_ptr<const ViscoelasticContactLaw> law_of(const NormalParameters& parameters) {
  if (parameters.form == NormalParameters::published_fit)
    return shipped_law(SphereContactLaw::published_fit);
  if (parameters.form == NormalParameters::boundary_element)
    return shipped_law(SphereContactLaw::boundary_element);
  if (!parameters.table)
    throw std::invalid_argument("make_substrate_contact: the table has not been read");
  return parameters.table;
}

}  // namespace

std::shared_ptr<const ViscoelasticContactLaw> shipped_law(SphereContactLaw law) {
  using Law = std::shared_ptr<const ViscoelasticContactLaw>;
  static const Law published = std::make_shared<FittedLaw>(published_coefficients());
  static const Law boundary_element = std::make_shared<BoundaryElementLaw>(shipped_master_curve());
  return law == SphereContactLaw::boundary_element ? boundary_element : published;
}

const Schema& NormalParameters::schema() {
  static const Schema keys =
      SchemaOf<NormalParameters>("normal")
          .choice("law", &NormalParameters::law,
                  {{"multiplier", NormalLaw::multiplier},
                   {"penalty", NormalLaw::penalty},
                   {"viscoelastic", NormalLaw::viscoelastic}},
                  {.doc = "multiplier: the gap is closed exactly; penalty: a spring of `stiffness` "
                          "at each slave point; viscoelastic: each slave point carries a sphere on "
                          "a viscoelastic half-space (master: half_space).",
                   .optional = true})
          .real("stiffness", &NormalParameters::stiffness,
                {.doc = "Of a penalty, per slave point.",
                 .unit = "N m-1",
                 .range = Range::positive(),
                 .optional = true})
          .real("preload", &NormalParameters::preload,
                {.doc = "Force of each slave point in steady sliding on the face of a plate, about "
                        "undeformed bodies, where no drive presses them together.",
                 .unit = "N",
                 .range = Range::non_negative(),
                 .optional = true})
          .real("radius", &NormalParameters::radius,
                {.doc = "R of the sphere at the slave point.",
                 .unit = "m",
                 .range = Range::positive(),
                 .optional = true})
          .real("modulus", &NormalParameters::modulus,
                {.doc = "E_0* = E_0/(1 − ν²) of the half-space at frequency zero.",
                 .unit = "Pa",
                 .range = Range::positive(),
                 .optional = true})
          .real("creep_time", &NormalParameters::creep_time,
                {.doc = "τ of the half-space.",
                 .unit = "s",
                 .range = Range::positive(),
                 .optional = true})
          .text("form", &NormalParameters::form,
                {.doc = "Of the viscoelastic law: published_fit, the fits as published, whose axis "
                        "of speed is off by about two decades; boundary_element, the boundary "
                        "elements of a paraboloid with one creep time and E∞/E0 = 10; or a file, "
                        "from the folder of the scene: a table of `stridor contact --table` "
                        "(*.h5).",
                 .optional = true})
          .check(check_keys_of_law);
  return keys;
}

SubstrateContact make_substrate_contact(const NormalParameters& p, double shear_strength,
                                        const FrictionLaw& friction) {
  const double radius = p.radius.value();
  const double square = radius * radius;
  SubstrateContact contact;
  contact.law = law_of(p);
  contact.indentation_unit = radius;
  contact.speed_unit = radius / p.creep_time.value();
  contact.force_unit = p.modulus.value() * square;
  contact.shear = shear_strength * square;
  contact.friction_load = FrictionLoad::contact;
  contact.sign = friction.sign;
  contact.interface_friction = friction;
  contact.interface_friction.sign = {};
  return contact;
}

}  // namespace stridor
