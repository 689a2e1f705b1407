#include "coupling/system/contact_parameters.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <string>
#include <utility>

namespace stridor {

namespace {

/// Which laws go together.
void check_laws(const ContactParameters& contact, std::vector<Problem>& problems) {
  const auto refuse = [&](Refusal refusal, const char* key, std::string text) {
    problems.push_back({refusal, key, std::move(text)});
  };
  const NormalLawType& law = *contact.normal.law;
  const auto with_area = [] {
    return normal_laws_with([](const NormalLawType& one) { return one.has_area(); });
  };
  if (!contact.friction && !law.has_area())
    refuse(Refusal::missing, "friction", "is missing: this normal law brings none of its own");
  if (contact.friction && contact.friction->law->needs_area && !law.has_area()) {
    refuse(Refusal::wrong_value, "normal.law",
           fmt::format("has no area of contact, with which the friction law {} is in proportion; "
                       "take {{law: {}, ...}}, or a friction coefficient",
                       contact.friction->law->name, with_area()));
  }
  if (contact.friction && contact.friction->viscoelastic == FrictionLoad::applied &&
      !law.has_friction) {
    refuse(Refusal::contradiction, "normal.law",
           fmt::format(
               "has no friction of its own, to which friction.viscoelastic belongs; take {{law: "
               "{}, ...}}, or leave that out",
               normal_laws_with([](const NormalLawType& one) { return one.has_friction; })));
  }
  if (law.has_area() && contact.master != half_space_master) {
    refuse(
        Refusal::contradiction, "master",
        fmt::format("must be `half_space` with the {} normal law, which is that of one", law.name));
  }
  if (!law.has_area() && contact.master == half_space_master) {
    refuse(
        Refusal::wrong_value, "master",
        fmt::format("`half_space` takes the normal law {}, which `normal` must be", with_area()));
  }
  if (contact.slave.empty() && !law.has_area()) {
    refuse(Refusal::missing, "slave",
           fmt::format("is missing: only a {} normal law, which `stridor contact` evaluates, goes "
                       "without; name at least one point",
                       with_area()));
  }
  if (contact.plane && contact.master != rigid_master)
    refuse(Refusal::contradiction, "plane", "is of the master `rigid`");
  if (!contact.assumption && !law.has_area())
    refuse(Refusal::missing, "assumption", "is missing; take subs_a, subs_b, subs_c or film");
  if (law.has_area() && contact.assumption_or_default() != ContactAssumption::film) {
    refuse(Refusal::contradiction, "assumption",
           fmt::format("must be `film` with the {} normal law: it sticks, slips and lifts off",
                       law.name));
  }
}

}  // namespace

SubstrateContact make_substrate_contact(const ContactParameters& contact, double load) {
  if (!contact.friction) return make_substrate_contact(contact.normal);
  const FrictionParameters& friction = *contact.friction;
  SubstrateContact made = make_substrate_contact(contact.normal, make_friction_law(friction));
  made.friction_load = friction.viscoelastic;
  made.load = load;
  return made;
}

const Schema& PlaneParameters::schema() {
  using P = PlaneParameters;
  static const Schema keys =
      SchemaOf<P>("plane")
          .real_list("normal", &P::normal,
                     {.doc = "Normal of the plane, towards the slave: three components, of any "
                             "length; default: y.",
                      .optional = true})
          .real_list("point", &P::point,
                     {.doc = "A point of the plane; default: the first slave point.",
                      .unit = "m",
                      .optional = true})
          .check([](const P& plane, std::vector<Problem>& problems) {
            const auto check = [&](const std::vector<double>& given, const char* key) {
              if (given.empty() || given.size() == 3) return;
              problems.push_back({Refusal::wrong_size, key, "must be three numbers"});
            };
            check(plane.normal, "normal");
            check(plane.point, "point");
            const bool is_zero = std::all_of(plane.normal.begin(), plane.normal.end(),
                                             [](double component) { return component == 0.0; });
            if (!plane.normal.empty() && is_zero)
              problems.push_back({Refusal::wrong_value, "normal", "must not be zero"});
          });
  return keys;
}

const Schema& StartParameters::schema() {
  using P = StartParameters;
  static const Schema keys =
      SchemaOf<P>("start")
          .real("along", &P::along,
                {.doc = "Position of the first slave point along the master surface, from its "
                        "first node.",
                 .unit = "m",
                 .range = Range::non_negative(),
                 .optional = true})
          .real("radius", &P::radius,
                {.doc = "Of the middle of the slave body on the face of a plate, from the axis.",
                 .unit = "m",
                 .range = Range::positive(),
                 .optional = true})
          .real("angle", &P::angle,
                {.doc = "Of that middle around the axis; default 0.",
                 .unit = "rad",
                 .optional = true})
          .real_list("at", &P::at,
                     {.doc = "Place of the first slave point of a contact in space, three "
                             "coordinates; default: where its mesh has it.",
                      .unit = "m",
                      .optional = true})
          .check([](const P& start, std::vector<Problem>& problems) {
            if (!start.at.empty() && start.at.size() != 3)
              problems.push_back({Refusal::wrong_size, "at", "must be three numbers"});
            if (start.along && start.radius) {
              problems.push_back({Refusal::contradiction, "",
                                  "is either a length along the master or, on the face of a plate, "
                                  "{radius, angle}"});
            } else if (start.along && start.angle) {
              problems.push_back(
                  {Refusal::contradiction, "angle", "goes with radius, on the face of a plate"});
            }
          });
  return keys;
}

// Long because it is a table: one entry for each key.
const Schema& ContactParameters::schema() {
  static const Schema keys =
      SchemaOf<ContactParameters>("contact")
          .text_list(
              "slave", &ContactParameters::slave,
              {.doc = "Slave: <body>.<point>, <body>.<surface> (every node of it), or a "
                      "list of them. May be absent where only `contact` evaluates the normal law.",
               .optional = true})
          .text("master", &ContactParameters::master,
                {.doc = "Master surface: <body>.<surface>, or a face of a plate; `rigid`: a rigid "
                        "straight line along +x "
                        "without end, below the slave, or a rigid plane (`plane`); or `half_space`: a viscoelastic one there, "
                        "of which the normal law is that of an indenter at the slave point."})
          .choice("assumption", &ContactParameters::assumption,
                  {{"subs_a", ContactAssumption::subs_a},
                   {"subs_b", ContactAssumption::subs_b},
                   {"subs_c", ContactAssumption::subs_c},
                   {"film", ContactAssumption::film}},
                  {.doc = "Required, but with a viscoelastic normal law, which has film; on the face "
                          "of a plate and in space subs_b or film. subs_a: prescribed sliding on "
                          "the undeformed master; subs_b: deformed positions and normal; subs_c: "
                          "deformed positions, undeformed normal; all three slide persistently. "
                          "film: as subs_b, with stick, slip and lift-off.",
                   .optional = true})
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
          .section("start", &ContactParameters::start,
                   {.doc = "Initial position of the first slave point along the master surface, "
                           "from its first node; on the face of a plate {radius, angle}.",
                    .optional = true,
                    .number_key = "along"})
          .section("plane", &ContactParameters::plane,
                   {.doc = "With the master `rigid`: a rigid plane, on which points slide in space, "
                           "with friction along two directions. Bodies in space have one without "
                           "this key, through the first slave point at right angles to y.",
                    .optional = true})
          .real("adjust", &ContactParameters::adjust,
                {.doc = "In space: gaps and overlaps of slave points up to this are taken as closed "
                        "at the start, without stress; default: a millionth of the size of the "
                        "bodies.",
                 .unit = "m",
                 .range = Range::non_negative(),
                 .optional = true})
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
          .section("normal", &ContactParameters::normal,
                   {.doc = "Normal law; default: a multiplier, which closes the gap exactly.",
                    .optional = true})
          .section("friction", &ContactParameters::friction,
                   {.doc = "Friction law. A viscoelastic normal law has friction of its own, to "
                           "which this adds that of the interface.",
                    .optional = true})
          .check(check_laws);
  return keys;
}

const Schema& DriveParameters::schema() {
  static const Schema keys =
      SchemaOf<DriveParameters>("drive")
          .curve("velocity", &DriveParameters::velocity,
                 {.doc = "Velocity of what it moves in +x: a number, which rises over `ramp`, or "
                         "{times, values}; default 0.",
                  .unit = "m s-1",
                  .optional = true})
          .curve("load", &DriveParameters::load,
                 {.doc = "Force in +y on each thing that it loads: a number, which rises over "
                         "`ramp`, or {times, values}; default 0.",
                  .unit = "N",
                  .optional = true})
          .curve("displacement", &DriveParameters::displacement,
                 {.doc = "Displacement in +y of the ground ends of springs: a number, which rises "
                         "over `ramp`, or {times, values}; their dampers stay where they "
                         "are. (What verbs vary as drive.displacement is how far the drive has "
                         "moved bodies.)",
                  .unit = "m",
                  .optional = true})
          .real(
              "ramp", &DriveParameters::ramp,
              {.doc = "Time over which velocity, load, displacement and friction rise from 0 "
                      "(quintic smoothstep); friction with the drive that moves one of its bodies, "
                      "else with one that loads them.",
               .unit = "s",
               .range = Range::non_negative()})
          .text_list("moves", &DriveParameters::moves,
                     {.doc = "What moves with the velocity: `guided` (all guided supports), <body> "
                             "(those of it), <contact>.master (a rigid or half_space one, along "
                             "itself), or a list of them; default: guided.",
                      .optional = true})
          .text_list("load_on", &DriveParameters::load_on,
                     {.doc = "What the load acts on: `guided`, <body> (its guided supports), "
                             "<body>.<point>, <body>.<surface> (spread evenly over it), or a list "
                             "of them; default: guided.",
                      .optional = true})
          .text_list("displaces", &DriveParameters::displaces,
                     {.doc = "What the displacement moves: the ground end of <body>.<spring>, or "
                             "of a list of them.",
                      .optional = true})
          .check([](const DriveParameters& drive, std::vector<Problem>& problems) {
            if (!drive.displacement.is_zero() && drive.displaces.empty())
              problems.push_back({Refusal::missing, "displaces",
                                  "is missing: name the springs that `displacement` moves"});
          });
  return keys;
}

bool SceneDrive::moves_guided() const {
  if (parameters.moves.empty()) return is_only || !parameters.velocity.is_zero();
  return std::find(parameters.moves.begin(), parameters.moves.end(), guided_supports) !=
         parameters.moves.end();
}

bool SceneDrive::loads_guided() const {
  if (parameters.load_on.empty()) return is_only || !parameters.load.is_zero();
  return std::find(parameters.load_on.begin(), parameters.load_on.end(), guided_supports) !=
         parameters.load_on.end();
}

Drive make_drive(const DriveParameters& parameters, SlidingMode sliding, const std::string& key) {
  const auto ramped = [&](const TimeCurve& curve) {
    return curve.is_constant() ? TimeCurve::ramp(curve.value(0.0), parameters.ramp) : curve;
  };
  return {ramped(parameters.velocity),     ramped(parameters.load),
          sliding == SlidingMode::frozen,  0.0,
          ramped(parameters.displacement), key};
}

}  // namespace stridor
