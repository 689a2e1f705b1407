// The friction laws that scenes can name, a line each.
#include <algorithm>
#include <stdexcept>

#include "coupling/laws/constant_friction.hpp"
#include "coupling/laws/friction_law_type.hpp"
#include "coupling/laws/shear_friction.hpp"
#include "coupling/laws/static_dynamic_friction.hpp"
#include "coupling/laws/stribeck_friction.hpp"

namespace stridor {

const std::vector<FrictionLawType>& friction_law_types() {
  static const std::vector<FrictionLawType> all{
      constant_friction_type(),
      static_dynamic_friction_type(),
      stribeck_friction_type(),
      shear_friction_type(),
  };
  return all;
}

const FrictionLawType& friction_law_type(const std::string& name) {
  const auto& all = friction_law_types();
  const auto found = std::find_if(all.begin(), all.end(),
                                  [&](const FrictionLawType& type) { return type.name == name; });
  if (found == all.end()) throw std::out_of_range("friction_law_type: there is no " + name);
  return *found;
}

FrictionKey static_coefficient_key() {
  return {"static",
          {.doc = "Coefficient at rest, at most 100; rises with drive.ramp.",
           .range = Range::non_negative()},
          true};
}

FrictionKey dynamic_coefficient_key() {
  return {"dynamic",
          {.doc = "Coefficient in (fast) sliding, at most 100; rises with drive.ramp.",
           .range = Range::non_negative()},
          true};
}

}  // namespace stridor
