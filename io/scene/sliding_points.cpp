#include "io/scene/sliding_points.hpp"

namespace stridor {

const Schema& SlidingPoints::schema() {
  static const Schema keys =
      SchemaOf<SlidingPoints>("sliding")
          .real_list("speeds", &SlidingPoints::speeds,
                     {.doc = "Sliding speeds v τ_1/R, with τ_1 the first creep time and R "
                             "the radius of the indenter; negative towards −x.",
                      .optional = true})
          .real_list("indentations", &SlidingPoints::indentations,
                     {.doc = "Indentations y/R.", .range = Range::positive(), .optional = true})
          .real_list("loads", &SlidingPoints::loads,
                     {.doc = "Normal forces F/(E_0* R²), E_0* = E_0/(1 − ν²), instead of "
                             "indentations.",
                      .range = Range::positive(),
                      .optional = true})
          .check([](const SlidingPoints& points, std::vector<Problem>& problems) {
            if (!points.loads.empty() && !points.indentations.empty())
              problems.push_back(
                  {Refusal::contradiction, "loads", "cannot stand beside `indentations`"});
          });
  return keys;
}

}  // namespace stridor
