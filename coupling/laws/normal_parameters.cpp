#include "coupling/laws/normal_parameters.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <utility>

#include "coupling/laws/law_keys.hpp"

namespace stridor {
namespace {

void check_keys_of_law(const NormalParameters& normal, std::vector<Problem>& problems) {
  const NormalLawType& law = *normal.law;
  const auto refuse = [&](Refusal refusal, const std::string& key, const char* what) {
    problems.push_back({refusal, key, fmt::format("{} by the normal law {}", what, law.name)});
  };
  static const std::vector<NormalKey> all = keys_of_all(normal_law_types());
  for (const NormalKey& key : all) {
    const auto own = std::find_if(law.keys.begin(), law.keys.end(),
                                  [&](const NormalKey& other) { return other.name == key.name; });
    const bool is_given = normal.numbers.contains(key.name);
    if (own == law.keys.end()) {
      if (is_given) refuse(Refusal::contradiction, key.name, "not used");
    } else if (own->is_required && !is_given) {
      refuse(Refusal::missing, key.name, "missing: needed");
    }
  }
  const std::pair<const char*, bool> others[] = {
      {"profile", normal.profile.has_value()},
      {"material", normal.material.has_value()},
      {"form", normal.form != NormalParameters::published_fit},
      {"solver", normal.solver.has_value()}};
  for (const auto& [key, is_given] : others)
    if (is_given && !normal.takes(key)) refuse(Refusal::contradiction, key, "not used");
  if (law.check != nullptr) law.check(normal, problems);
}

}  // namespace

bool NormalParameters::takes(const std::string& key) const {
  return std::find(law->other_keys.begin(), law->other_keys.end(), key) != law->other_keys.end();
}

ProfileParameters NormalParameters::indenter() const {
  if (profile) return *profile;
  ProfileParameters paraboloid;
  paraboloid.radius = numbers.at("radius");
  return paraboloid;
}

const Schema& NormalParameters::schema() {
  static const Schema keys = [] {
    Schema made =
        SchemaOf<NormalParameters>("normal")
            .section(
                "profile", &NormalParameters::profile,
                {.doc = "The rigid axisymmetric indenter at the slave point.", .optional = true})
            .section("material", &NormalParameters::material,
                     {.doc = "The half-space: linear viscoelastic, isotropic; in the place of "
                             "`modulus` and `creep_time`, of which it says more.",
                      .optional = true})
            .text(
                "form", &NormalParameters::form,
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
    add_law_keys<NormalParameters>(made, normal_law_types());
    return made;
  }();
  return keys;
}

SubstrateContact make_substrate_contact(const NormalParameters& parameters,
                                        const FrictionLaw& friction) {
  SubstrateContact contact = parameters.law->make_contact(parameters);
  contact.shear = friction.shear_strength * contact.indentation_unit * contact.indentation_unit;
  contact.friction_load = FrictionLoad::contact;
  contact.sign = friction.sign;
  contact.interface_friction = friction;
  contact.interface_friction.sign = {};
  return contact;
}

}  // namespace stridor
