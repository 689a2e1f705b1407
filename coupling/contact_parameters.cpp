#include "coupling/contact_parameters.hpp"

#include <fmt/format.h>

namespace stridor {

void check_coefficient(const char* key, const std::optional<double>& coefficient,
                       std::vector<Problem>& problems) {
  constexpr double most = 100.0;
  if (!coefficient || *coefficient <= most) return;
  problems.push_back({key,
                      fmt::format("must be at most {:g}, got {:g}: solids in contact have "
                                  "coefficients of friction below about 10",
                                  most, *coefficient),
                      {},
                      0,
                      0});
}

const Schema& FrictionParameters::schema() {
  using Kind = FrictionLaw::Kind;
  static const Schema keys =
      SchemaOf<FrictionParameters>("friction")
          .choice(
              "law", &FrictionParameters::law,
              {{"constant", Kind::constant},
               {"static_dynamic", Kind::static_dynamic},
               {"stribeck", Kind::stribeck}},
              {.doc = "constant: `coefficient`; static_dynamic: `static` at rest, `dynamic` in "
                      "sliding; stribeck: from `static` to `dynamic` as exp(-|v|/decay_velocity).",
               .optional = true})
          .real("coefficient", &FrictionParameters::coefficient,
                {.doc = "Coulomb friction coefficient of the constant law, at most 100; rises with drive.ramp.",
                 .range = Range::non_negative(),
                 .optional = true})
          .real("static", &FrictionParameters::static_coefficient,
                {.doc = "Coefficient at rest, at most 100; rises with drive.ramp.",
                 .range = Range::non_negative(),
                 .optional = true})
          .real("dynamic", &FrictionParameters::dynamic_coefficient,
                {.doc = "Coefficient in (fast) sliding, at most 100; rises with drive.ramp.",
                 .range = Range::non_negative(),
                 .optional = true})
          .real("decay_velocity", &FrictionParameters::decay_velocity,
                {.doc = "Sliding velocity over which the Stribeck law falls by 1/e.",
                 .unit = "m s-1",
                 .range = Range::positive(),
                 .optional = true})
          .check([](const FrictionParameters& friction, std::vector<Problem>& problems) {
            const bool is_constant = friction.law == Kind::constant;
            const auto demand = [&](const char* key, bool is_given, bool is_wanted) {
              if (is_given == is_wanted) return;
              const char* kind = is_constant                      ? "constant"
                                 : friction.law == Kind::stribeck ? "stribeck"
                                                                  : "static_dynamic";
              problems.push_back({key,
                                  fmt::format("{} by the {} friction law",
                                              is_wanted ? "missing: needed" : "not used", kind),
                                  {},
                                  0,
                                  0});
            };
            demand("coefficient", friction.coefficient.has_value(), is_constant);
            demand("static", friction.static_coefficient.has_value(), !is_constant);
            demand("dynamic", friction.dynamic_coefficient.has_value(), !is_constant);
            demand("decay_velocity", friction.decay_velocity.has_value(),
                   friction.law == Kind::stribeck);
            check_coefficient("coefficient", friction.coefficient, problems);
            check_coefficient("static", friction.static_coefficient, problems);
            check_coefficient("dynamic", friction.dynamic_coefficient, problems);
            if (friction.static_coefficient && friction.dynamic_coefficient &&
                friction.law == Kind::static_dynamic &&
                *friction.static_coefficient < *friction.dynamic_coefficient) {
              problems.push_back({"static", "must not be below `dynamic`", {}, 0, 0});
            }
          });
  return keys;
}

FrictionLaw make_friction_law(const FrictionParameters& parameters) {
  if (parameters.law == FrictionLaw::Kind::constant) {
    return constant_friction(parameters.coefficient.value());
  }
  return {parameters.law, parameters.static_coefficient.value(),
          parameters.dynamic_coefficient.value(), parameters.decay_velocity.value_or(1.0)};
}

const Schema& ContactParameters::schema() {
  static const Schema keys =
      SchemaOf<ContactParameters>("contact")
          .text_list("slave", &ContactParameters::slave,
                     {.doc = "Slave: <body>.<point>, <body>.<surface> (every node of it), or a "
                             "list of them."})
          .text("master", &ContactParameters::master,
                {.doc = "Master surface: <body>.<surface>, or `rigid`: a rigid straight line along "
                        "+x without end, below the slave."})
          .choice("assumption", &ContactParameters::assumption,
                  {{"subs_a", ContactAssumption::subs_a},
                   {"subs_b", ContactAssumption::subs_b},
                   {"subs_c", ContactAssumption::subs_c},
                   {"film", ContactAssumption::film}},
                  {.doc = "subs_a: prescribed sliding on the undeformed master; subs_b: deformed "
                          "positions and normal; subs_c: deformed positions, undeformed normal; "
                          "all three slide persistently. film: as subs_b, with stick, slip and "
                          "lift-off."})
          .choice(
              "on_violation", &ContactParameters::on_violation,
              {{"stop", OnViolation::stop}, {"unilateral", OnViolation::unilateral}},
              {.doc = "What becomes of an armed contact that loses persistent sliding: stop the "
                      "run, or let it stick, slip and lift off.",
               .optional = true})
          .real("armed_from", &ContactParameters::armed_from,
                {.doc = "Violations of persistent sliding before this time are counted, not acted "
                        "on; default drive.ramp.",
                 .unit = "s",
                 .range = Range::non_negative(),
                 .optional = true})
          .real("start", &ContactParameters::start,
                {.doc = "Initial position of the first slave point along the master surface, from "
                        "its first node.",
                 .unit = "m",
                 .range = Range::non_negative()})
          .choice("sliding", &ContactParameters::sliding,
                  {{"moving", SlidingMode::moving}, {"frozen", SlidingMode::frozen}},
                  {.doc = "moving: the drive slides the slave; frozen: position held, friction as "
                          "in sliding.",
                   .optional = true})
          .choice(
              "surface", &ContactParameters::surface,
              {{"polyline", SurfaceKind::polyline}, {"smooth", SurfaceKind::smooth}},
              {.doc = "Shape of the master between its nodes. polyline: straight segments, with "
                      "a kink at every node; smooth: a cubic through the nodes with continuous "
                      "normal.",
               .optional = true})
          .section("roughness", &ContactParameters::roughness,
                   {.doc = "Random roughness of the master, added to the gap.", .optional = true})
          .section("friction", &ContactParameters::friction,
                   {.doc = "Friction law. This, or `substrate`.", .optional = true})
          .section("substrate", &ContactParameters::substrate,
                   {.doc = "The slave point carries a sphere that slides on a viscoelastic "
                           "half-space in the place of the rigid master; its law gives force and "
                           "friction. Takes master: rigid and assumption: film.",
                    .optional = true})
          .check([](const ContactParameters& contact, std::vector<Problem>& problems) {
            if (contact.slave.empty())
              problems.push_back({"slave", "is an empty list; name at least one point", {}, 0, 0});
            const auto refuse = [&](const char* key, const char* text) {
              problems.push_back({key, text, {}, 0, 0});
            };
            if (!contact.friction && !contact.substrate)
              refuse("friction", "is missing: give `friction`, or a `substrate`");
            if (!contact.substrate) return;
            if (contact.friction) refuse("friction", "not used with a substrate, whose law has it");
            if (contact.assumption != ContactAssumption::film)
              refuse("assumption",
                     "must be `film` with a substrate: it sticks, slips and lifts off");
          });
  return keys;
}

const Schema& DriveParameters::schema() {
  static const Schema keys =
      SchemaOf<DriveParameters>("drive")
          .curve("velocity", &DriveParameters::velocity,
                 {.doc = "Velocity of guided supports in +x: a number, which rises over `ramp`, or "
                         "{times, values}.",
                  .unit = "m s-1"})
          .curve("load", &DriveParameters::load,
                 {.doc = "Force on guided supports in +y: a number, which rises over `ramp`, or "
                         "{times, values}.",
                  .unit = "N"})
          .real(
              "ramp", &DriveParameters::ramp,
              {.doc =
                   "Time over which velocity, load and friction rise from 0 (quintic smoothstep).",
               .unit = "s",
               .range = Range::non_negative()});
  return keys;
}

Drive make_drive(const DriveParameters& parameters, SlidingMode sliding) {
  const auto ramped = [&](const TimeCurve& curve) {
    return curve.is_constant() ? TimeCurve::ramp(curve.value(0.0), parameters.ramp) : curve;
  };
  return {ramped(parameters.velocity), ramped(parameters.load), sliding == SlidingMode::frozen};
}

}  // namespace stridor
