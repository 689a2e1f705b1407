#include "coupling/laws/shear_friction.hpp"
#include "coupling/laws/stribeck_friction.hpp"
#include "coupling/system/contact_parameters.hpp"
#include "tests/support/constants.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <optional>
#include <string>
#include <vector>

namespace stridor {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::SizeIs;

using test::eps;

/// The drive of the paper.
DriveParameters paper_drive() {
  return {TimeCurve(0.03), TimeCurve(-0.2), 0.1};
}

TEST(MakeDrive, ConstantsRiseOverTheRamp) {
  const Drive drive = make_drive(paper_drive(), SlidingMode::moving);
  EXPECT_EQ(drive.velocity.table(), (TimeTable{{0.0, 0.1}, {0.0, 0.03}}));
  EXPECT_EQ(drive.load.table(), (TimeTable{{0.0, 0.1}, {0.0, -0.2}}));
  EXPECT_EQ(drive.velocity.value(0.0), 0.0);
  EXPECT_EQ(drive.load.value(0.1), -0.2);
  EXPECT_EQ(drive.constant_from(), 0.1);
  EXPECT_FALSE(drive.is_frozen);
}

TEST(MakeDrive, WithoutRampConstantsStay) {
  DriveParameters parameters = paper_drive();
  parameters.ramp = 0.0;
  const Drive drive = make_drive(parameters, SlidingMode::moving);
  EXPECT_EQ(drive.velocity.value(0.0), 0.03);
  EXPECT_EQ(drive.load.value(0.0), -0.2);
  EXPECT_EQ(drive.constant_from(), 0.0);
}

TEST(MakeDrive, TablesStayAsTheyAre) {
  const TimeTable velocity{{0.5, 1.0, 2.0}, {0.01, 0.05, 0.02}};
  const TimeTable load{{0.0, 3.0}, {-0.1, -0.4}};
  const Drive drive = make_drive({TimeCurve(velocity), TimeCurve(load), 0.1}, SlidingMode::moving);
  EXPECT_EQ(drive.velocity.table(), velocity);
  EXPECT_EQ(drive.load.table(), load);
  EXPECT_EQ(drive.constant_from(), 3.0);
}

TEST(MakeDrive, OneTableDoesNotKeepTheOtherFromRising) {
  const TimeTable load{{0.0, 3.0}, {-0.1, -0.4}};
  const Drive drive = make_drive({TimeCurve(0.03), TimeCurve(load), 0.1}, SlidingMode::moving);
  EXPECT_EQ(drive.velocity.value(0.0), 0.0);
  EXPECT_EQ(drive.load.value(0.0), -0.1);
}

TEST(MakeDrive, MovingSlidesByTheIntegralOfTheVelocity) {
  const Drive drive = make_drive(paper_drive(), SlidingMode::moving);
  // Half of the ramp counts; four rounded operations.
  EXPECT_NEAR(drive.displacement(2.25), 0.066, 4.0 * eps * 0.066);
  EXPECT_EQ(drive.displacement(0.0), 0.0);
  EXPECT_EQ(drive.acceleration(0.05), drive.velocity.slope(0.05));
  EXPECT_GT(drive.acceleration(0.05), 0.0);
  EXPECT_EQ(drive.acceleration(1.0), 0.0);
}

TEST(MakeDrive, DisplacementsOfSpringsRiseOverTheRamp) {
  DriveParameters parameters = paper_drive();
  parameters.displacement = TimeCurve(2e-3);
  parameters.displaces = {"pad.backing"};
  const Drive drive = make_drive(parameters, SlidingMode::moving, "drives.piston");
  EXPECT_EQ(drive.shift.table(), (TimeTable{{0.0, 0.1}, {0.0, 2e-3}}));
  EXPECT_EQ(drive.key, "drives.piston");
}

TEST(SceneDrive, MovesAndLoadsGuidedSupportsWhereNothingElseIsSaid) {
  SceneDrive drive{"drives.a", "a", {}, true};
  EXPECT_TRUE(drive.moves_guided());
  EXPECT_TRUE(drive.loads_guided());
  drive.is_only = false;
  EXPECT_FALSE(drive.moves_guided());
  EXPECT_FALSE(drive.loads_guided());
  drive.parameters.velocity = TimeCurve(-1.0);
  EXPECT_TRUE(drive.moves_guided());
  drive.parameters.moves = {"pad"};
  EXPECT_FALSE(drive.moves_guided());
  drive.parameters.load = TimeCurve(1.0);
  EXPECT_TRUE(drive.loads_guided());
  drive.parameters.load_on = {"pad.top", guided_supports};
  EXPECT_TRUE(drive.loads_guided());
  EXPECT_EQ(drive.key_of("load_on", 1), "drives.a.load_on.1");
}

TEST(MakeDrive, FrozenStaysInPlaceButKeepsTheVelocity) {
  const Drive drive = make_drive(paper_drive(), SlidingMode::frozen);
  EXPECT_TRUE(drive.is_frozen);
  for (const double time : {0.0, 0.05, 0.1, 2.25}) {
    EXPECT_EQ(drive.displacement(time), 0.0);
    EXPECT_EQ(drive.acceleration(time), 0.0);
  }
  EXPECT_EQ(drive.velocity.value(2.25), 0.03);
  EXPECT_EQ(drive.load.value(2.25), -0.2);
}

TEST(ContactParameters, SchemaRefusesAnEmptyListOfSlaves) {
  const auto problems_of = [](const ContactParameters& contact) {
    std::vector<Problem> problems;
    for (const auto& check : ContactParameters::schema().checks) check(&contact, problems);
    return problems;
  };
  ContactParameters contact;
  contact.friction.emplace().numbers["coefficient"] = 0.3;
  const std::vector<Problem> problems = problems_of(contact);
  ASSERT_THAT(problems, SizeIs(2));
  EXPECT_EQ(problems[0].text(),
            "slave: is missing: only a viscoelastic normal law, which `stridor contact` evaluates, "
            "goes without; name at least one point");
  EXPECT_EQ(problems[1].text(), "assumption: is missing; take subs_a, subs_b, subs_c or film");
  contact.slave = {"oblique.tip"};
  contact.assumption = ContactAssumption::subs_b;
  EXPECT_THAT(problems_of(contact), IsEmpty());
}

TEST(ContactParameters, ChoicesMeanWhatTheySay) {
  ContactParameters contact;
  const Schema& schema = ContactParameters::schema();
  const auto choose = [&](const char* key, const char* text) {
    schema.find(key)->assign(&contact, Value(std::string(text)));
  };
  choose("assumption", "subs_a");
  EXPECT_EQ(contact.assumption, ContactAssumption::subs_a);
  choose("assumption", "subs_b");
  EXPECT_EQ(contact.assumption, ContactAssumption::subs_b);
  choose("assumption", "subs_c");
  EXPECT_EQ(contact.assumption, ContactAssumption::subs_c);
  choose("assumption", "film");
  EXPECT_EQ(contact.assumption, ContactAssumption::film);
  EXPECT_EQ(contact.on_violation, OnViolation::stop);
  choose("on_violation", "unilateral");
  EXPECT_EQ(contact.on_violation, OnViolation::unilateral);
  choose("on_violation", "stop");
  EXPECT_EQ(contact.on_violation, OnViolation::stop);
  choose("sliding", "frozen");
  EXPECT_EQ(contact.sliding, SlidingMode::frozen);
  choose("sliding", "moving");
  EXPECT_EQ(contact.sliding, SlidingMode::moving);
  FrictionParameters friction;
  const auto choose_law = [&](const char* text) {
    FrictionParameters::schema().find("law")->assign(&friction, Value(std::string(text)));
    return friction.law;
  };
  EXPECT_EQ(choose_law("static_dynamic"), &friction_law_type("static_dynamic"));
  EXPECT_EQ(choose_law("stribeck"), &friction_law_type("stribeck"));
  EXPECT_EQ(choose_law("constant"), &friction_law_type("constant"));
  EXPECT_EQ(choose_law("shear"), &friction_law_type("shear"));
}

TEST(ContactParameters, PhysicalQuantitiesHaveNoDefault) {
  // A slave and an assumption are needed but where only the law is evaluated; see check_laws().
  EXPECT_FALSE(ContactParameters::schema().find("master")->is_optional);
  // A drive may leave out what it does not do.
  EXPECT_FALSE(DriveParameters::schema().find("ramp")->is_optional);
  // Which numbers are needed depends on the laws, see NormalParameters and FrictionParameters.
  EXPECT_THAT(NormalParameters{}.numbers, IsEmpty());
  EXPECT_TRUE(FrictionParameters{}.numbers.empty());
}

FrictionParameters friction_of(const char* law, FrictionNumbers numbers) {
  FrictionParameters friction;
  friction.law = &friction_law_type(law);
  friction.numbers = std::move(numbers);
  return friction;
}

/// Complaints about the keys of a section, one line each.
template <class Parameters>
std::vector<std::string> complaints(const Parameters& parameters) {
  std::vector<Problem> problems;
  for (const auto& check : Parameters::schema().checks) check(&parameters, problems);
  std::vector<std::string> lines;
  for (const Problem& problem : problems) lines.push_back(problem.text());
  return lines;
}

TEST(NormalParameters, EveryLawNeedsItsOwnKeys) {
  NormalParameters normal;
  EXPECT_THAT(complaints(normal), IsEmpty());
  normal.law = &normal_law_type("penalty");
  EXPECT_THAT(complaints(normal),
              ElementsAre("stiffness: missing: needed by the normal law penalty"));
  normal.numbers["stiffness"] = 1e6;
  EXPECT_THAT(complaints(normal), IsEmpty());
  normal.law = &normal_law_type("multiplier");
  normal.form = NormalParameters::boundary_element;
  EXPECT_THAT(complaints(normal), ElementsAre("stiffness: not used by the normal law multiplier",
                                              "form: not used by the normal law multiplier"));
  normal.law = &normal_law_type("viscoelastic");
  normal.form = "law.txt";
  EXPECT_THAT(complaints(normal),
              ElementsAre("stiffness: not used by the normal law viscoelastic",
                          "radius: missing: needed by the normal law viscoelastic, or `profile`",
                          "modulus: missing: needed by the normal law viscoelastic, or `material`",
                          "creep_time: missing: needed by the normal law viscoelastic, or "
                          "`material`",
                          "form: 'law.txt' is neither published_fit nor boundary_element nor solve "
                          "nor a file of `stridor contact --table` (*.h5)"));
}

NormalParameters rubber_sphere() {
  NormalParameters normal;
  normal.law = &normal_law_type("viscoelastic");
  normal.profile.emplace().shape = ProfileShape::sphere;
  normal.profile->radius = 2e-3;
  normal.material = ViscoelasticMaterial{0.75e6, 3e6, 0.5, {0.01, 0.1}, {0.5, 0.5}};
  normal.form = NormalParameters::solve;
  return normal;
}

TEST(NormalParameters, ProfileAndMaterialSayMoreThanRadiusModulusAndTime) {
  NormalParameters normal = rubber_sphere();
  normal.solver.emplace();
  EXPECT_THAT(complaints(normal), IsEmpty());
  EXPECT_EQ(normal.tip_radius(), 2e-3);
  EXPECT_DOUBLE_EQ(normal.composite_modulus(), 1e6);
  EXPECT_EQ(normal.first_creep_time(), 0.01);
  normal.numbers["radius"] = 1e-3;
  normal.numbers["modulus"] = 1e6;
  EXPECT_THAT(
      complaints(normal),
      ElementsAre("radius: cannot stand beside `profile`, which has a radius",
                  "material: cannot stand beside `modulus` and `creep_time`, which it says"));
  normal = rubber_sphere();
  normal.material.reset();
  normal.numbers["modulus"] = 1e6;
  normal.numbers["creep_time"] = 0.01;
  EXPECT_THAT(complaints(normal),
              ElementsAre(HasSubstr("material: missing: the form solve needs")));
}

TEST(NormalParameters, LawsBuiltInAreOfOneIndenterAndMaterial) {
  NormalParameters normal = rubber_sphere();
  normal.form = NormalParameters::boundary_element;
  normal.solver.emplace();
  EXPECT_THAT(complaints(normal),
              ElementsAre("solver: not used by the form boundary_element, but by solve",
                          HasSubstr("profile.shape: must be paraboloid with the form"),
                          HasSubstr("material.creep_times: must be one with the form"),
                          HasSubstr("material.glassy_modulus: must be 10 times rubbery_modulus")));
  normal.solver.reset();
  normal.profile->shape = ProfileShape::paraboloid;
  normal.material->creep_times = {0.01};
  normal.material->creep_shares.clear();
  normal.material->glassy_modulus = 7.5e6;
  EXPECT_THAT(complaints(normal), IsEmpty());
  // The same numbers as those of a radius, a modulus and a time.
  NormalParameters other;
  other.law = &normal_law_type("viscoelastic");
  other.numbers["radius"] = 2e-3;
  other.numbers["modulus"] = 1e6;
  other.numbers["creep_time"] = 0.01;
  other.form = NormalParameters::boundary_element;
  const SubstrateForces one = make_substrate_contact(normal).at(2e-5, 0.02, 1.0);
  const SubstrateForces same = make_substrate_contact(other).at(2e-5, 0.02, 1.0);
  EXPECT_NEAR(one.normal.value, same.normal.value, 1e-12 * same.normal.value);
  EXPECT_NEAR(one.tangential.value, same.tangential.value, 1e-12 * -same.tangential.value);
  normal.form = NormalParameters::solve;
  EXPECT_THROW((void)make_substrate_contact(normal), std::invalid_argument);
}

NormalParameters sphere_of_2_mm() {
  NormalParameters normal;
  normal.law = &normal_law_type("viscoelastic");
  normal.numbers["radius"] = 2e-3;
  normal.numbers["modulus"] = 1e6;
  normal.numbers["creep_time"] = 0.01;
  normal.form = NormalParameters::boundary_element;
  return normal;
}

TEST(ContactParameters, LawsThatDoNotGoTogetherAreRefused) {
  ContactParameters contact;
  contact.slave = {"reed.tip"};
  contact.master = "cantilever.top";
  contact.assumption = ContactAssumption::subs_b;
  EXPECT_THAT(complaints(contact),
              ElementsAre("friction: is missing: this normal law brings none of its own"));
  contact.friction.emplace().law = &friction_law_type("shear");
  EXPECT_THAT(
      complaints(contact),
      ElementsAre("normal.law: has no area of contact, with which the friction law shear is in "
                  "proportion; take {law: viscoelastic, ...}, or a friction coefficient"));
  contact.normal = sphere_of_2_mm();
  EXPECT_THAT(complaints(contact),
              ElementsAre("master: must be `half_space` with the viscoelastic normal law, which is "
                          "that of one",
                          "assumption: must be `film` with the viscoelastic normal law: it sticks, "
                          "slips and lifts off"));
  contact.master = half_space_master;
  contact.assumption = ContactAssumption::film;
  EXPECT_THAT(complaints(contact), IsEmpty());
  contact.friction.reset();
  EXPECT_THAT(complaints(contact), IsEmpty());
  contact.normal = {};
  contact.friction.emplace().numbers["coefficient"] = 0.3;
  EXPECT_THAT(
      complaints(contact),
      ElementsAre(
          "master: `half_space` takes the normal law viscoelastic, which `normal` must be"));
}

TEST(ViscoelasticNormalLaw, IsInSiUnits) {
  // F = E_0* R² F̃(y/R, v τ/R); at rest F̃ = 4/3 ŷ^{3/2}, Ã = π ŷ by the boundary elements.
  const SubstrateContact contact = make_substrate_contact(sphere_of_2_mm(), shear_friction(0.02e6));
  const double y = 2e-5;
  EXPECT_NEAR(contact.at(y, 0.0, 1.0).normal.value, 1e6 * 4e-6 * 4.0 / 3.0 * 1e-3, 1e-12);
  EXPECT_NEAR(contact.static_strength(y).value, 0.02 * 1e6 * 4e-6 * M_PI * 0.01, 1e-12);
}

TEST(ViscoelasticNormalLaw, FrictionOfTheInterfaceAddsToItsOwn) {
  FrictionLaw interface = stribeck_friction(0.5, 0.2, 0.03);
  const SubstrateContact bare = make_substrate_contact(sphere_of_2_mm());
  const SubstrateContact rubbing = make_substrate_contact(sphere_of_2_mm(), interface);
  const double y = 2e-5;
  for (const double v : {0.02, -0.4}) {
    const double direction = v > 0.0 ? 1.0 : -1.0;
    const SubstrateForces without = bare.at(y, v, direction);
    const SubstrateForces with = rubbing.at(y, v, direction);
    EXPECT_EQ(with.normal.value, without.normal.value);
    EXPECT_NEAR(with.tangential.value,
                without.tangential.value -
                    direction * sliding_friction(interface, v) * without.normal.value,
                1e-12);
    const auto tangential = [&](double at, double slip) {
      return rubbing.at(at, slip, direction).tangential.value;
    };
    EXPECT_NEAR(with.tangential.by_indentation,
                (tangential(y * 1.0001, v) - tangential(y * 0.9999, v)) / (2e-4 * y),
                1e-5 * std::abs(with.tangential.by_indentation));
    EXPECT_NEAR(with.tangential.by_slip,
                (tangential(y, v * 1.0001) - tangential(y, v * 0.9999)) / (2e-4 * v),
                1e-4 * std::abs(with.tangential.by_slip) + 1e-9);
  }
  EXPECT_NEAR(rubbing.static_strength(y).value, 0.5 * rubbing.at(y, 0.0, 1.0).normal.value, 1e-15);
  interface.sign = {RegularisedSign::Kind::tanh, 0.1};
  const SubstrateContact creeping = make_substrate_contact(sphere_of_2_mm(), interface);
  EXPECT_EQ(creeping.static_strength(y).value, 0.0);
  EXPECT_NEAR(creeping.at(y, 0.1, 1.0).tangential.value,
              std::tanh(1.0) * rubbing.at(y, 0.1, 1.0).tangential.value, 1e-12);
}

TEST(FrictionParameters, EveryLawNeedsItsOwnKeys) {
  FrictionParameters friction;
  EXPECT_THAT(complaints(friction),
              ElementsAre("coefficient: missing: needed by the constant friction law"));
  friction.law = &friction_law_type("static_dynamic");
  EXPECT_THAT(complaints(friction),
              ElementsAre("static: missing: needed by the static_dynamic friction law",
                          "dynamic: missing: needed by the static_dynamic friction law"));
  friction.law = &friction_law_type("stribeck");
  EXPECT_THAT(complaints(friction),
              ElementsAre("static: missing: needed by the stribeck friction law",
                          "dynamic: missing: needed by the stribeck friction law",
                          "decay_velocity: missing: needed by the stribeck friction law"));
}

TEST(FrictionParameters, KeysOfOtherLawsAreRefused) {
  const FrictionParameters all = friction_of(
      "constant",
      {{"coefficient", 0.3}, {"static", 0.4}, {"dynamic", 0.3}, {"decay_velocity", 0.01}});
  FrictionParameters friction = all;
  EXPECT_THAT(complaints(friction),
              ElementsAre("static: not used by the constant friction law",
                          "dynamic: not used by the constant friction law",
                          "decay_velocity: not used by the constant friction law"));
  friction.law = &friction_law_type("static_dynamic");
  EXPECT_THAT(complaints(friction),
              ElementsAre("coefficient: not used by the static_dynamic friction law",
                          "decay_velocity: not used by the static_dynamic friction law"));
  friction.law = &friction_law_type("stribeck");
  EXPECT_THAT(complaints(friction),
              ElementsAre("coefficient: not used by the stribeck friction law"));
}

TEST(FrictionParameters, CompleteLawsAreTaken) {
  EXPECT_THAT(complaints(friction_of("constant", {{"coefficient", 0.3}})), IsEmpty());
  EXPECT_THAT(complaints(friction_of("constant", {{"coefficient", 0.0}})), IsEmpty());
  EXPECT_THAT(complaints(friction_of("static_dynamic", {{"static", 0.4}, {"dynamic", 0.3}})),
              IsEmpty());
  EXPECT_THAT(complaints(friction_of(
                  "stribeck", {{"static", 0.4}, {"dynamic", 0.3}, {"decay_velocity", 0.01}})),
              IsEmpty());
  // A law may rise with the speed.
  EXPECT_THAT(complaints(friction_of(
                  "stribeck", {{"static", 0.3}, {"dynamic", 0.4}, {"decay_velocity", 0.01}})),
              IsEmpty());
}

TEST(FrictionParameters, AtRestNoLessThanInSlidingUnlessTheLawIsContinuous) {
  EXPECT_THAT(complaints(friction_of("static_dynamic", {{"static", 0.3}, {"dynamic", 0.4}})),
              ElementsAre("static: must not be below `dynamic`"));
  EXPECT_THAT(complaints(friction_of("static_dynamic", {{"static", 0.3}, {"dynamic", 0.3}})),
              IsEmpty());
}

TEST(FrictionParameters, CoefficientsMayBeZeroButNotNegativeAndTheDecayVelocityIsPositive) {
  const Schema& schema = FrictionParameters::schema();
  for (const char* key : {"coefficient", "static", "dynamic"}) {
    EXPECT_TRUE(schema.find(key)->range.contains(0.0)) << key;
    EXPECT_FALSE(schema.find(key)->range.contains(-1e-9)) << key;
  }
  EXPECT_FALSE(schema.find("decay_velocity")->range.contains(0.0));
  EXPECT_TRUE(schema.find("decay_velocity")->range.contains(1e-9));
}

TEST(FrictionParameters, BecomeTheLawThatTheyName) {
  const FrictionLaw constant = make_friction_law(friction_of("constant", {{"coefficient", 0.3}}));
  EXPECT_EQ(constant.sliding, nullptr);
  EXPECT_EQ(constant.static_coefficient, 0.3);
  EXPECT_EQ(constant.dynamic_coefficient, 0.3);
  const FrictionLaw jump =
      make_friction_law(friction_of("static_dynamic", {{"static", 0.4}, {"dynamic", 0.3}}));
  EXPECT_EQ(jump.sliding, nullptr);
  EXPECT_EQ(jump.static_coefficient, 0.4);
  EXPECT_EQ(jump.dynamic_coefficient, 0.3);
  const FrictionLaw stribeck = make_friction_law(
      friction_of("stribeck", {{"static", 0.4}, {"dynamic", 0.3}, {"decay_velocity", 0.01}}));
  EXPECT_NEAR(sliding_friction(stribeck, 0.01), 0.3 + 0.1 * std::exp(-1.0), 1e-15);
  EXPECT_EQ(stribeck.static_coefficient, 0.4);
  EXPECT_EQ(stribeck.dynamic_coefficient, 0.3);
  EXPECT_EQ(make_friction_law(friction_of("shear", {{"strength", 2e4}})).shear_strength, 2e4);
  EXPECT_THROW((void)make_friction_law(friction_of("shear", {})), std::out_of_range);
  EXPECT_THROW((void)friction_law_type("slippery"), std::out_of_range);
}

TEST(ContactPoint, IsUnilateralFromTheStartWithFilmAndFromItsArmingOnDemand) {
  ContactPoint contact;
  contact.armed_from = 0.1;
  constexpr double infinity = std::numeric_limits<double>::infinity();
  EXPECT_EQ(contact.unilateral_from(), infinity);
  contact.on_violation = OnViolation::unilateral;
  EXPECT_EQ(contact.unilateral_from(), 0.1);
  for (const OnViolation any : {OnViolation::stop, OnViolation::unilateral}) {
    contact.assumption = ContactAssumption::film;
    contact.on_violation = any;
    EXPECT_EQ(contact.unilateral_from(), -infinity);
  }
}

}  // namespace
}  // namespace stridor
