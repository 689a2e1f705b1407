#include "coupling/laws/viscoelastic_normal_law.hpp"

#include <fmt/format.h>

#include <cmath>
#include <stdexcept>
#include <utility>

#include "coupling/laws/normal_parameters.hpp"

namespace stridor {
namespace {

void add(std::vector<Problem>& problems, Refusal refusal, const char* key, std::string message) {
  problems.push_back({refusal, key, std::move(message)});
}

/// A viscoelastic law needs either of two keys, or sets of keys.
void check_either(const NormalParameters& normal, std::vector<Problem>& problems) {
  const bool has_radius = normal.numbers.contains("radius");
  if (normal.profile && has_radius)
    add(problems, Refusal::contradiction, "radius",
        "cannot stand beside `profile`, which has a radius");
  if (!normal.profile && !has_radius) {
    add(problems, Refusal::missing, "radius",
        fmt::format("missing: needed by the normal law {}, or `profile`", normal.law->name));
  }
  if (normal.material) {
    if (normal.numbers.contains("modulus") || normal.numbers.contains("creep_time"))
      add(problems, Refusal::contradiction, "material",
          "cannot stand beside `modulus` and `creep_time`, which it says");
    return;
  }
  for (const char* const key : {"modulus", "creep_time"}) {
    if (normal.numbers.contains(key)) continue;
    add(problems, Refusal::missing, key,
        fmt::format("missing: needed by the normal law {}, or `material`", normal.law->name));
  }
}

/// The laws that the program has built in are of one indenter and one kind of material.
void check_shipped_form(const NormalParameters& normal, std::vector<Problem>& problems) {
  if (normal.profile && normal.profile->shape != ProfileShape::paraboloid) {
    add(problems, Refusal::wrong_value, "profile.shape",
        fmt::format("must be paraboloid with the form {}, which is the law of one; take solve",
                    normal.form));
  }
  if (!normal.material) return;
  if (normal.material->creep_times.size() != 1) {
    add(problems, Refusal::wrong_value, "material.creep_times",
        fmt::format("must be one with the form {}, which is the law of such a material; take solve",
                    normal.form));
  }
  constexpr double ratio = 0.1;
  if (std::abs(normal.material->modulus_ratio() - ratio) > 1e-6 * ratio) {
    add(problems, Refusal::wrong_value, "material.glassy_modulus",
        fmt::format("must be 10 times rubbery_modulus with the form {}, which is the law of such a "
                    "material; take solve",
                    normal.form));
  }
}

void check_viscoelastic(const NormalParameters& normal, std::vector<Problem>& problems) {
  check_either(normal, problems);
  if (normal.is_solved()) {
    if (!normal.material && normal.numbers.contains("modulus") &&
        normal.numbers.contains("creep_time")) {
      add(problems, Refusal::missing, "material",
          "missing: the form solve needs the whole material, in the place of `modulus` and "
          "`creep_time`");
    }
    return;
  }
  if (normal.solver)
    add(problems, Refusal::contradiction, "solver",
        fmt::format("not used by the form {}, but by solve", normal.form));
  if (!normal.has_table()) {
    check_shipped_form(normal, problems);
  } else if (!normal.form.ends_with(".h5")) {
    add(problems, Refusal::wrong_value, "form",
        fmt::format("'{}' is neither published_fit nor boundary_element nor solve nor a file of "
                    "`stridor contact --table` (*.h5)",
                    normal.form));
  }
}

std::shared_ptr<const ViscoelasticContactLaw> form_of(const NormalParameters& parameters) {
  if (parameters.form == NormalParameters::published_fit)
    return shipped_law(SphereContactLaw::published_fit);
  if (parameters.form == NormalParameters::boundary_element)
    return shipped_law(SphereContactLaw::boundary_element);
  if (parameters.is_solved())
    throw std::invalid_argument(
        "viscoelastic normal law: the form solve is computed contact by contact");
  if (!parameters.table)
    throw std::invalid_argument("viscoelastic normal law: the table has not been read");
  return parameters.table;
}

SubstrateContact make_viscoelastic_contact(const NormalParameters& p) {
  const double radius = p.tip_radius();
  SubstrateContact contact;
  contact.law = form_of(p);
  contact.indentation_unit = radius;
  contact.speed_unit = radius / p.first_creep_time();
  contact.force_unit = p.composite_modulus() * radius * radius;
  return contact;
}

}  // namespace

std::shared_ptr<const ViscoelasticContactLaw> shipped_law(SphereContactLaw law) {
  using Law = std::shared_ptr<const ViscoelasticContactLaw>;
  static const Law published = std::make_shared<FittedLaw>(published_coefficients());
  static const Law boundary_element = std::make_shared<BoundaryElementLaw>(shipped_master_curve());
  return law == SphereContactLaw::boundary_element ? boundary_element : published;
}

NormalLawType viscoelastic_law_type() {
  return {.name = "viscoelastic",
          .doc =
              "each slave point carries an indenter on a viscoelastic half-space (master: "
              "half_space)",
          .keys = {indenter_radius_key(false),
                   half_space_modulus_key(false),
                   {"creep_time",
                    {.doc = "τ of the half-space.", .unit = "s", .range = Range::positive()},
                    false}},
          .other_keys = {"profile", "material", "form", "solver"},
          .make_contact = make_viscoelastic_contact,
          .has_friction = true,
          .check = check_viscoelastic};
}

}  // namespace stridor
