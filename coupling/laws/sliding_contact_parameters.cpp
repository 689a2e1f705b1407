#include "coupling/laws/sliding_contact_parameters.hpp"

#include <fmt/format.h>

namespace stridor {

const Schema& SlidingContactParameters::schema() {
  static const Schema keys =
      SchemaOf<SlidingContactParameters>("contact_solver")
          .integer("grid", &SlidingContactParameters::grid,
                   {.doc = "Cells along a side of the square window; even.",
                    .optional = true,
                    .range = Range::between(16, 4096)})
          .real("window", &SlidingContactParameters::window,
                {.doc = "Half-width of the window over the contact radius of an elastic "
                        "half-space at the same indentation.",
                 .range = {1.0, 10.0, true, false},
                 .optional = true})
          .real("tolerance", &SlidingContactParameters::tolerance,
                {.doc = "Largest r.m.s. deviation of the surface from the indenter in the contact, "
                        "over the indentation.",
                 .range = Range::inside(0.0, 0.1),
                 .optional = true})
          .integer("max_rounds", &SlidingContactParameters::max_rounds,
                   {.doc = "Most sets of contact cells that are tried; where they do not suffice "
                           "the result says that it did not converge.",
                    .optional = true,
                    .range = Range::between(1, 1e6)})
          .check([](const SlidingContactParameters& solver, std::vector<Problem>& problems) {
            if (solver.grid % 2 != 0)
              problems.push_back(
                  {Refusal::wrong_value, "grid", fmt::format("{} is not even", solver.grid)});
          });
  return keys;
}

}  // namespace stridor
