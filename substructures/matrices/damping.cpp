#include "substructures/matrices/damping.hpp"

#include <algorithm>

namespace stridor {

const Schema& RayleighDamping::schema() {
  static const Schema keys =
      SchemaOf<RayleighDamping>("damping")
          .real("alpha", &RayleighDamping::alpha,
                {.doc = "Mass-proportional damping, C = alpha M + beta K.",
                 .unit = "s-1",
                 .range = Range::non_negative()})
          .real("beta", &RayleighDamping::beta,
                {.doc = "Stiffness-proportional damping.",
                 .unit = "s",
                 .range = Range::non_negative()})
          .real("alpha_start", &RayleighDamping::alpha_start,
                {.doc = "alpha at the start of a run, until `hold`.",
                 .unit = "s-1",
                 .range = Range::non_negative(),
                 .optional = true})
          .real("hold", &RayleighDamping::hold,
                {.doc = "Time until which alpha_start holds.",
                 .unit = "s",
                 .range = Range::non_negative(),
                 .optional = true})
          .real("fade", &RayleighDamping::fade,
                {.doc = "Time over which alpha_start falls linearly to alpha.",
                 .unit = "s",
                 .range = Range::non_negative(),
                 .optional = true})
          .check([](const RayleighDamping& damping, std::vector<Problem>& problems) {
            if (!damping.alpha_start && (damping.hold > 0.0 || damping.fade > 0.0)) {
              problems.push_back(
                  {Refusal::missing, "alpha_start",
                   "missing: `hold` and `fade` say how long it lasts; give it or drop them"});
            }
          });
  return keys;
}

double RayleighDamping::alpha_at(double time) const {
  if (!alpha_start || time >= hold + fade) return alpha;
  if (time <= hold) return *alpha_start;
  return *alpha_start + (alpha - *alpha_start) * (time - hold) / fade;
}

double RayleighDamping::alpha_max() const {
  return std::max(alpha, alpha_start.value_or(alpha));
}

}  // namespace stridor
