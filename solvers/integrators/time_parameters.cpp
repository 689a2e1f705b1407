#include "solvers/integrators/time_parameters.hpp"

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
              problems.push_back({Refusal::contradiction, "", "takes either frequency or error"});
          });
  return keys;
}

namespace {

void check_step(const TimeParameters& time, std::vector<Problem>& problems) {
  const auto refuse = [&](Refusal refusal, const char* key, const char* text) {
    problems.push_back({refusal, key, text});
  };
  if (time.is_event_driven()) {
    if (time.step > 0.0)
      refuse(Refusal::contradiction, "step", "not used by the integrator event_driven");
    if (time.coordinates != Coordinates::modal)
      refuse(Refusal::contradiction, "coordinates", "not used by the integrator event_driven");
    if (time.retain)
      refuse(Refusal::contradiction, "retain", "not used by the integrator event_driven");
    return;
  }
  if (!(time.step > 0.0)) {
    refuse(Refusal::missing, "", "`step` is missing, which this integrator needs");
    return;
  }
  if (time.coordinates != Coordinates::modal) {
    if (time.integrator == Integrator::exact)
      refuse(Refusal::contradiction, "integrator", "exact takes coordinates: modal");
    if (time.retain) refuse(Refusal::contradiction, "retain", "takes coordinates: modal");
  }
  if (time.end < time.step) refuse(Refusal::wrong_value, "end", "is shorter than one step");
  if (time.end / time.step > 1e15)
    refuse(Refusal::wrong_value, "step", "the run would take more than 1e15 steps");
}

/// A number that is not given where its member is 0.
void leave_out_zero(Schema& schema, const std::string& name) {
  for (Key& key : schema.keys) {
    if (key.name != name) continue;
    key.read = [read = key.read](const void* object) {
      const Value value = read(object);
      return std::get<double>(value) == 0.0 ? Value{} : value;
    };
  }
}

}  // namespace

const ChoiceWords<Integrator>& integrator_words() {
  static const ChoiceWords<Integrator> words{{"central_difference", Integrator::central_difference},
                                             {"exact", Integrator::exact},
                                             {"event_driven", Integrator::event_driven}};
  return words;
}

const ChoiceWords<Coordinates>& coordinates_words() {
  static const ChoiceWords<Coordinates> words{
      {"modal", Coordinates::modal},
      {"craig_bampton", Coordinates::craig_bampton},
      {"craig_bampton_fused", Coordinates::craig_bampton_fused}};
  return words;
}

const Schema& TimeParameters::schema() {
  static const Schema keys = [] {
    Schema made =
        SchemaOf<TimeParameters>("time")
            .choice(
                "integrator", &TimeParameters::integrator, integrator_words(),
                {.doc =
                     "central_difference: the published scheme; exact: the exact motion of every "
                     "mode from step to step, of modal coordinates only; event_driven: adaptive "
                     "steps of order 8 that end at every change between stick, slip and lift-off, "
                     "for one mass that moves in x and y on a half_space.",
                 .optional = true})
            .choice("coordinates", &TimeParameters::coordinates, coordinates_words(),
                    {.doc = "modal: one recurrence per mode; craig_bampton: the published dense "
                            "form, kept as a baseline; "
                            "craig_bampton_fused: the same with constants folded in.",
                     .optional = true})
            .real("step", &TimeParameters::step,
                  {.doc = "Time step; not of the integrator event_driven.",
                   .unit = "s",
                   .range = Range::positive(),
                   .optional = true})
            .real("end", &TimeParameters::end,
                  {.doc = "End of the run.", .unit = "s", .range = Range::positive()})
            .section(
                "retain", &TimeParameters::retain,
                {.doc = "Modes that move on their own; the others follow the forces at once, as "
                        "a static residual.",
                 .optional = true,
                 .absent_word = "all"})
            .real("contact_tolerance", &TimeParameters::contact_tolerance,
                  {.doc =
                       "Several unilateral contacts: largest change of a contact force in the last "
                       "sweep, relative to the largest force.",
                   .range = Range::inside(0.0, 1.0),
                   .optional = true})
            .integer(
                "contact_sweeps", &TimeParameters::contact_sweeps,
                {.doc = "Several unilateral contacts: most Gauss-Seidel sweeps in a step; where "
                        "they do not suffice the run ends.",
                 .optional = true,
                 .range = Range::between(1, 1e6)})
            .real(
                "tolerance", &TimeParameters::tolerance,
                {.doc = "Relative error of a step of the integrator event_driven, and of `cycle`.",
                 .range = Range::between(1e-14, 1e-2),
                 .optional = true})
            .check(check_step);
    leave_out_zero(made, "step");
    return made;
  }();
  return keys;
}

}  // namespace stridor
