#include "coupling/laws/normal_parameters.hpp"

#include <fmt/format.h>

#include <cmath>
#include <stdexcept>
#include <utility>

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

void add(std::vector<Problem>& problems, const char* key, std::string message) {
  problems.push_back({key, std::move(message), {}, 0, 0});
}

/// A viscoelastic law needs either of two keys, or sets of keys.
void check_either(const NormalParameters& normal, std::vector<Problem>& problems) {
  if (normal.profile && normal.radius)
    add(problems, "radius", "cannot stand beside `profile`, which has a radius");
  if (!normal.profile && !normal.radius) {
    add(problems, "radius",
        fmt::format("missing: needed by the normal law {}, or `profile`", name_of(normal.law)));
  }
  if (normal.material) {
    if (normal.modulus || normal.creep_time)
      add(problems, "material", "cannot stand beside `modulus` and `creep_time`, which it says");
    return;
  }
  for (const auto& [key, number] :
       {std::pair("modulus", &normal.modulus), std::pair("creep_time", &normal.creep_time)}) {
    if (*number) continue;
    add(problems, key,
        fmt::format("missing: needed by the normal law {}, or `material`", name_of(normal.law)));
  }
}

/// The laws that the program has built in are of one indenter and one kind of material.
void check_shipped_form(const NormalParameters& normal, std::vector<Problem>& problems) {
  if (normal.profile && normal.profile->shape != ProfileShape::paraboloid) {
    add(problems, "profile.shape",
        fmt::format("must be paraboloid with the form {}, which is the law of one; take solve",
                    normal.form));
  }
  if (!normal.material) return;
  if (normal.material->creep_times.size() != 1) {
    add(problems, "material.creep_times",
        fmt::format("must be one with the form {}, which is the law of such a material; take solve",
                    normal.form));
  }
  constexpr double ratio = 0.1;
  if (std::abs(normal.material->modulus_ratio() - ratio) > 1e-6 * ratio) {
    add(problems, "material.glassy_modulus",
        fmt::format("must be 10 times rubbery_modulus with the form {}, which is the law of such a "
                    "material; take solve",
                    normal.form));
  }
}

void check_viscoelastic(const NormalParameters& normal, std::vector<Problem>& problems) {
  check_either(normal, problems);
  if (normal.is_solved()) {
    if (!normal.material && normal.modulus && normal.creep_time) {
      add(problems, "material",
          "missing: the form solve needs the whole material, in the place of `modulus` and "
          "`creep_time`");
    }
    return;
  }
  if (normal.solver)
    add(problems, "solver", fmt::format("not used by the form {}, but by solve", normal.form));
  if (!normal.has_table()) {
    check_shipped_form(normal, problems);
  } else if (!normal.form.ends_with(".h5")) {
    add(problems, "form",
        fmt::format("'{}' is neither published_fit nor boundary_element nor solve nor a file of "
                    "`stridor contact --table` (*.h5)",
                    normal.form));
  }
}

void check_keys_of_law(const NormalParameters& normal, std::vector<Problem>& problems) {
  const bool is_penalty = normal.law == NormalLaw::penalty;
  if (normal.stiffness.has_value() != is_penalty) {
    add(problems, "stiffness",
        fmt::format("{} by the normal law {}", is_penalty ? "missing: needed" : "not used",
                    name_of(normal.law)));
  }
  if (normal.law == NormalLaw::viscoelastic) {
    if (normal.preload) add(problems, "preload", "not used by the normal law viscoelastic");
    check_viscoelastic(normal, problems);
    return;
  }
  const std::pair<const char*, bool> others[] = {
      {"radius", normal.radius.has_value()},
      {"profile", normal.profile.has_value()},
      {"modulus", normal.modulus.has_value()},
      {"creep_time", normal.creep_time.has_value()},
      {"material", normal.material.has_value()},
      {"form", normal.form != NormalParameters::published_fit},
      {"solver", normal.solver.has_value()}};
  for (const auto& [key, is_given] : others) {
    if (is_given)
      add(problems, key, fmt::format("not used by the normal law {}", name_of(normal.law)));
  }
}

}  // namespace

std::shared_ptr<const ViscoelasticContactLaw> shipped_law(SphereContactLaw law) {
  using Law = std::shared_ptr<const ViscoelasticContactLaw>;
  static const Law published = std::make_shared<FittedLaw>(published_coefficients());
  static const Law boundary_element = std::make_shared<BoundaryElementLaw>(shipped_master_curve());
  return law == SphereContactLaw::boundary_element ? boundary_element : published;
}

std::shared_ptr<const ViscoelasticContactLaw> law_of(const NormalParameters& parameters) {
  if (parameters.form == NormalParameters::published_fit)
    return shipped_law(SphereContactLaw::published_fit);
  if (parameters.form == NormalParameters::boundary_element)
    return shipped_law(SphereContactLaw::boundary_element);
  if (parameters.is_solved())
    throw std::invalid_argument("law_of: the form solve is computed contact by contact");
  if (!parameters.table) throw std::invalid_argument("law_of: the table has not been read");
  return parameters.table;
}

ProfileParameters NormalParameters::indenter() const {
  if (profile) return *profile;
  ProfileParameters paraboloid;
  paraboloid.radius = radius.value();
  return paraboloid;
}

const Schema& NormalParameters::schema() {
  static const Schema keys =
      SchemaOf<NormalParameters>("normal")
          .choice("law", &NormalParameters::law,
                  {{"multiplier", NormalLaw::multiplier},
                   {"penalty", NormalLaw::penalty},
                   {"viscoelastic", NormalLaw::viscoelastic}},
                  {.doc = "multiplier: the gap is closed exactly; penalty: a spring of `stiffness` "
                          "at each slave point; viscoelastic: each slave point carries an indenter "
                          "on a viscoelastic half-space (master: half_space).",
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
                {.doc = "R of the sphere at the slave point, for short: a `profile` of the shape "
                        "paraboloid.",
                 .unit = "m",
                 .range = Range::positive(),
                 .optional = true})
          .section("profile", &NormalParameters::profile,
                   {.doc = "The rigid axisymmetric indenter at the slave point.", .optional = true})
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
          .section("material", &NormalParameters::material,
                   {.doc = "The half-space: linear viscoelastic, isotropic; in the place of "
                           "`modulus` and `creep_time`, of which it says more.",
                    .optional = true})
          .text("form", &NormalParameters::form,
                {.doc = "Of the viscoelastic law: published_fit, the fits as published, whose axis "
                        "of speed is off by about two decades; boundary_element, the boundary "
                        "elements of a paraboloid with one creep time and E∞/E0 = 10; solve, the "
                        "boundary elements of `profile` and `material`, of which a run needs a "
                        "table; or a file, from the folder of the scene: a table of `stridor "
                        "contact --table` (*.h5).",
                 .optional = true})
          .section("solver", &NormalParameters::solver,
                   {.doc = "Numerical settings of the form solve.", .optional = true})
          .check(check_keys_of_law);
  return keys;
}

SubstrateContact make_substrate_contact(const NormalParameters& p, const FrictionLaw& friction) {
  const double radius = p.tip_radius();
  const double square = radius * radius;
  SubstrateContact contact;
  contact.law = law_of(p);
  contact.indentation_unit = radius;
  contact.speed_unit = radius / p.first_creep_time();
  contact.force_unit = p.composite_modulus() * square;
  contact.shear = friction.shear_strength * square;
  contact.friction_load = FrictionLoad::contact;
  contact.sign = friction.sign;
  contact.interface_friction = friction;
  contact.interface_friction.sign = {};
  return contact;
}

}  // namespace stridor
