#include "coupling/laws/friction_parameters.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <utility>

#include "coupling/laws/law_keys.hpp"

namespace stridor {

void check_coefficient(const char* key, const std::optional<double>& coefficient,
                       std::vector<Problem>& problems) {
  constexpr double most = 100.0;
  if (!coefficient || *coefficient <= most) return;
  problems.push_back({Refusal::wrong_value, key,
                      fmt::format("must be at most {:g}, got {:g}: solids in contact have "
                                  "coefficients of friction below about 10",
                                  most, *coefficient)});
}

namespace {

void check_keys_of_friction(const FrictionParameters& friction, std::vector<Problem>& problems) {
  const FrictionLawType& law = *friction.law;
  const auto demand = [&](const std::string& key, bool is_wanted) {
    if (friction.numbers.contains(key) == is_wanted) return;
    problems.push_back({is_wanted ? Refusal::missing : Refusal::contradiction, key,
                        fmt::format("{} by the {} friction law",
                                    is_wanted ? "missing: needed" : "not used", law.name)});
  };
  static const std::vector<FrictionKey> all = keys_of_all(friction_law_types());
  for (const FrictionKey& key : all) {
    demand(key.name, std::any_of(law.keys.begin(), law.keys.end(),
                                 [&](const FrictionKey& own) { return own.name == key.name; }));
  }
  for (const FrictionKey& key : all) {
    const auto given = friction.numbers.find(key.name);
    if (key.is_coefficient && given != friction.numbers.end())
      check_coefficient(key.name.c_str(), given->second, problems);
  }
  if (law.check != nullptr) law.check(friction.numbers, problems);
  if (friction.regularisation && law.has_jump) {
    std::string others;
    for (const FrictionLawType& type : friction_law_types()) {
      if (!type.has_jump && !type.needs_area) others += (others.empty() ? "" : " or ") + type.name;
    }
    problems.push_back({Refusal::contradiction, "regularisation",
                        "goes with a law that is continuous in sliding: a regularised contact "
                        "never rests, so that `static` would never act; take " +
                            others});
  }
}

}  // namespace

const Schema& FrictionRegularisation::schema() {
  using Kind = RegularisedSign::Kind;
  static const Schema keys =
      SchemaOf<FrictionRegularisation>("friction_regularisation")
          .choice("law", &FrictionRegularisation::law,
                  {{"tanh", Kind::tanh},
                   {"linear", Kind::linear},
                   {"square_root", Kind::square_root},
                   {"atan", Kind::atan}},
                  {.doc = "What stands in the place of the sign of the slip, with u the slip over "
                          "`speed`: tanh u, u up to 1, u/(1 + u²)^1/2 or (2/π) arctan u.",
                   .optional = true})
          .real("speed", &FrictionRegularisation::speed,
                {.doc = "Slip over which friction rises.",
                 .unit = "m s-1",
                 .range = Range::positive()});
  return keys;
}

const Schema& FrictionParameters::schema() {
  static const Schema keys = [] {
    Schema made =
        SchemaOf<FrictionParameters>("friction")
            .choice(
                "viscoelastic", &FrictionParameters::viscoelastic,
                {{"applied", FrictionLoad::applied}, {"contact", FrictionLoad::contact}},
                {.doc = "What the friction coefficient of a viscoelastic normal law is multiplied "
                        "with: the drive's load, or the force of the contact at the instant.",
                 .optional = true})
            .section("regularisation", &FrictionParameters::regularisation,
                     {.doc = "Friction without sticking, as a smooth function of the slip: the "
                             "contact creeps where it would stick.",
                      .optional = true})
            .check(check_keys_of_friction);
    add_law_keys<FrictionParameters>(made, friction_law_types());
    return made;
  }();
  return keys;
}

FrictionLaw make_friction_law(const FrictionParameters& parameters) {
  FrictionLaw law = parameters.law->make(parameters.numbers);
  if (parameters.regularisation)
    law.sign = {parameters.regularisation->law, parameters.regularisation->speed};
  return law;
}

}  // namespace stridor
