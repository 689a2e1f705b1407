#include "models/initial_parameters.hpp"

namespace stridor {

template <MotionKind kind>
const Schema& InitialMotionParameters<kind>::schema() {
  using Motion = InitialMotionParameters<kind>;
  constexpr bool is_velocity = kind == MotionKind::velocity;
  const std::string unit = is_velocity ? "m s-1" : "m";
  static const Schema keys =
      SchemaOf<Motion>(is_velocity ? "initial velocity" : "initial displacement")
          .text("at", &Motion::at,
                {.doc = "<body>.<point>: the body takes the static shape of least strain energy "
                        "through all points named; <body>: all of it alike."})
          .real("x", &Motion::x, {.doc = "Component in x.", .unit = unit, .optional = true})
          .real("y", &Motion::y, {.doc = "Component in y.", .unit = unit, .optional = true})
          .real("z", &Motion::z, {.doc = "Component in z.", .unit = unit, .optional = true})
          .check([](const Motion& motion, std::vector<Problem>& problems) {
            if (motion.x == 0.0 && motion.y == 0.0 && motion.z == 0.0)
              problems.push_back(
                  {Refusal::motion_is_held, "at", "moves nothing: give some of `x`, `y` and `z`"});
          });
  return keys;
}

template struct InitialMotionParameters<MotionKind::displacement>;
template struct InitialMotionParameters<MotionKind::velocity>;

const Schema& PerturbationParameters::schema() {
  static const Schema keys =
      SchemaOf<PerturbationParameters>("perturbation")
          .integer("eigenvalue", &PerturbationParameters::eigenvalue,
                   {.doc = "Which eigenvalue of the linearised system at the start, counted from 1 "
                           "over those with positive frequency, lowest first.",
                    .range = Range::between(1, 10000)})
          .real("amplitude", &PerturbationParameters::amplitude,
                {.doc = "Largest displacement of a contact point or recorded point in it.",
                 .unit = "m",
                 .range = Range::positive()});
  return keys;
}

const Schema& InitialParameters::schema() {
  static const Schema keys =
      SchemaOf<InitialParameters>("initial")
          .text(
              "state", &InitialParameters::state,
              {.doc = "State at the start: rest; equilibrium (steady sliding under the loads of "
                      "t = 0: needs drive.ramp 0); or a file, from the folder of the scene: a run "
                      "(*.h5), whose final motion is taken.",
               .optional = true})
          .section_list("displacement", &InitialParameters::displacement,
                        {.doc = "Displacements added to the state.", .optional = true})
          .section_list("velocity", &InitialParameters::velocity,
                        {.doc = "Velocities added to the state.", .optional = true})
          .section("perturbation", &InitialParameters::perturbation,
                   {.doc = "Eigenvector added to the state.", .optional = true})
          .real("indentation", &InitialParameters::indentation,
                {.doc = "Indentation of viscoelastic contacts at the start over that in "
                        "equilibrium; a body takes the static shape of least strain energy.",
                 .optional = true})
          .check([](const InitialParameters& initial, std::vector<Problem>& problems) {
            const std::string& start = initial.state;
            const bool is_run_file =
                start.size() > 3 && start.compare(start.size() - 3, 3, ".h5") == 0;
            if (initial.is_file() && !is_run_file) {
              problems.push_back({Refusal::wrong_value, "state",
                                  "'" + start +
                                      "' is neither rest nor equilibrium nor a run file "
                                      "(*.h5)"});
            }
            if (initial.indentation && start != InitialParameters::equilibrium) {
              problems.push_back({Refusal::wrong_value, "indentation",
                                  "is over that of the sliding equilibrium: needs state: "
                                  "equilibrium"});
            }
            if (initial.perturbation && start != InitialParameters::equilibrium) {
              problems.push_back({Refusal::wrong_value, "perturbation",
                                  "is added to the sliding equilibrium: needs state: equilibrium"});
            }
          });
  return keys;
}

}  // namespace stridor
