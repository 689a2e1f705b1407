#include "solvers/time_parameters.hpp"

namespace stridor {

const Schema& RetainParameters::schema() {
  static const Schema keys =
      SchemaOf<RetainParameters>("retain")
          .real("frequency", &RetainParameters::frequency,
                {.doc = "Modes up to this frequency are kept.",
                 .unit = "Hz",
                 .range = Range::positive(),
                 .optional = true})
          .real("error", &RetainParameters::error,
                {.doc = "As many modes are kept as it takes for the frequencies of the bodies in "
                        "contact to have at most this relative error.",
                 .range = Range::inside(0.0, 1.0),
                 .optional = true})
          .real("upper", &RetainParameters::upper,
                {.doc = "Of the frequencies that `error` is asked of, the highest.",
                 .unit = "Hz",
                 .range = Range::positive(),
                 .optional = true})
          .check([](const RetainParameters& retain, std::vector<Problem>& problems) {
            if (retain.frequency.has_value() == retain.error.has_value())
              problems.push_back({"", "takes either frequency or error", {}, 0, 0});
          });
  return keys;
}

const Schema& TimeParameters::schema() {
  static const Schema keys =
      SchemaOf<TimeParameters>("time")
          .choice(
              "integrator", &TimeParameters::integrator,
              {{"central_difference", Integrator::central_difference},
               {"exact", Integrator::exact}},
              {.doc = "central_difference: the published scheme; exact: the exact motion of every "
                      "mode from step to step, of modal coordinates only.",
               .optional = true})
          .choice("coordinates", &TimeParameters::coordinates,
                  {{"modal", Coordinates::modal},
                   {"craig_bampton", Coordinates::craig_bampton},
                   {"craig_bampton_fused", Coordinates::craig_bampton_fused}},
                  {.doc = "modal: one recurrence per mode; craig_bampton: the published dense "
                          "form, kept as a baseline; "
                          "craig_bampton_fused: the same with constants folded in.",
                   .optional = true})
          .real("step", &TimeParameters::step,
                {.doc = "Time step.", .unit = "s", .range = Range::positive()})
          .real("end", &TimeParameters::end,
                {.doc = "End of the run.", .unit = "s", .range = Range::positive()})
          .section("retain", &TimeParameters::retain,
                   {.doc = "Modes that move on their own; the others follow the forces at once, as "
                           "a static residual.",
                    .optional = true,
                    .absent_word = "all"})
          .real(
              "contact_tolerance", &TimeParameters::contact_tolerance,
              {.doc = "Several unilateral contacts: largest change of a contact force in the last "
                      "sweep, relative to the largest force.",
               .range = Range::inside(0.0, 1.0),
               .optional = true})
          .integer("contact_sweeps", &TimeParameters::contact_sweeps,
                   {.doc = "Several unilateral contacts: most Gauss-Seidel sweeps in a step; where "
                           "they do not suffice the run ends.",
                    .optional = true,
                    .range = Range::between(1, 1e6)})
          .check([](const TimeParameters& time, std::vector<Problem>& problems) {
            if (time.coordinates != Coordinates::modal) {
              if (time.integrator == Integrator::exact)
                problems.push_back({"integrator", "exact takes coordinates: modal", {}, 0, 0});
              if (time.retain) problems.push_back({"retain", "takes coordinates: modal", {}, 0, 0});
            }
            if (time.end < time.step)
              problems.push_back({"end", "is shorter than one step", {}, 0, 0});
            if (time.end / time.step > 1e15) {
              problems.push_back({"step", "the run would take more than 1e15 steps", {}, 0, 0});
            }
          });
  return keys;
}

}  // namespace stridor
