// The normal laws that scenes can name, a line each.
#include <algorithm>
#include <stdexcept>

#include "coupling/laws/multiplier_law.hpp"
#include "coupling/laws/normal_law_type.hpp"
#include "coupling/laws/penalty_law.hpp"
#include "coupling/laws/viscoelastic_normal_law.hpp"

namespace stridor {

const std::vector<NormalLawType>& normal_law_types() {
  static const std::vector<NormalLawType> all{
      multiplier_law_type(),
      penalty_law_type(),
      viscoelastic_law_type(),
  };
  return all;
}

const NormalLawType& normal_law_type(const std::string& name) {
  const auto& all = normal_law_types();
  const auto found = std::find_if(all.begin(), all.end(),
                                  [&](const NormalLawType& type) { return type.name == name; });
  if (found == all.end()) throw std::out_of_range("normal_law_type: there is no " + name);
  return *found;
}

std::string normal_laws_with(bool (*wanted)(const NormalLawType& law)) {
  std::string names;
  for (const NormalLawType& law : normal_law_types())
    if (wanted(law)) names += (names.empty() ? "" : " or ") + law.name;
  return names;
}

NormalKey preload_key() {
  return {"preload",
          {.doc = "Force of each slave point in steady sliding on the face of a plate, about "
                  "undeformed bodies, where no drive presses them together.",
           .unit = "N",
           .range = Range::non_negative()},
          false};
}

NormalKey indenter_radius_key(bool is_required) {
  return {"radius",
          {.doc = "R of the sphere at the slave point, for short: a `profile` of the shape "
                  "paraboloid.",
           .unit = "m",
           .range = Range::positive()},
          is_required};
}

NormalKey half_space_modulus_key(bool is_required) {
  return {"modulus",
          {.doc = "E_0* = E_0/(1 − ν²) of the half-space at frequency zero.",
           .unit = "Pa",
           .range = Range::positive()},
          is_required};
}

}  // namespace stridor
