#include "coupling/contact_parameters.hpp"

namespace stridor {

const Schema& FrictionParameters::schema() {
  static const Schema keys =
      SchemaOf<FrictionParameters>("friction")
          .real("coefficient", &FrictionParameters::coefficient,
                {.doc = "Coulomb friction coefficient; rises with drive.ramp.",
                 .range = Range::non_negative()});
  return keys;
}

const Schema& ContactParameters::schema() {
  static const Schema keys =
      SchemaOf<ContactParameters>("contact")
          .text_list("slave", &ContactParameters::slave,
                     {.doc = "Slave: <body>.<point>, <body>.<surface> (every node of it), or a "
                             "list of them."})
          .text("master", &ContactParameters::master, {.doc = "Master surface: <body>.<surface>."})
          .choice("assumption", &ContactParameters::assumption,
                  {{"subs_a", ContactAssumption::subs_a},
                   {"subs_b", ContactAssumption::subs_b},
                   {"subs_c", ContactAssumption::subs_c}},
                  {.doc = "subs_a: prescribed sliding on the undeformed master; subs_b: deformed "
                          "positions and normal; "
                          "subs_c: deformed positions, undeformed normal."})
          .choice("on_violation", &ContactParameters::on_violation, {{"stop", OnViolation::stop}},
                  {.doc = "What to do when persistent sliding is lost.", .optional = true})
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
          .choice("surface", &ContactParameters::surface, {{"polyline", SurfaceKind::polyline}},
                  {.doc = "Shape of the master between its nodes.", .optional = true})
          .section("friction", &ContactParameters::friction, {.doc = "Friction law."})
          .check([](const ContactParameters& contact, std::vector<Problem>& problems) {
            if (contact.slave.empty())
              problems.push_back({"slave", "is an empty list; name at least one point", {}, 0, 0});
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
