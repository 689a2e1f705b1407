#include "coupling/contact_parameters.hpp"

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
using testing::IsEmpty;
using testing::SizeIs;

constexpr double eps = std::numeric_limits<double>::epsilon();

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
  contact.friction.emplace().coefficient = 0.3;
  const std::vector<Problem> problems = problems_of(contact);
  ASSERT_THAT(problems, SizeIs(1));
  EXPECT_EQ(problems[0].text(), "slave: is an empty list; name at least one point");
  contact.slave = {"oblique.tip"};
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
  EXPECT_EQ(choose_law("static_dynamic"), FrictionLaw::Kind::static_dynamic);
  EXPECT_EQ(choose_law("stribeck"), FrictionLaw::Kind::stribeck);
  EXPECT_EQ(choose_law("constant"), FrictionLaw::Kind::constant);
}

TEST(ContactParameters, PhysicalQuantitiesHaveNoDefault) {
  for (const char* key : {"slave", "master", "assumption", "start"})
    EXPECT_FALSE(ContactParameters::schema().find(key)->is_optional) << key;
  for (const char* key : {"velocity", "load", "ramp"})
    EXPECT_FALSE(DriveParameters::schema().find(key)->is_optional) << key;
  for (const char* key : {"radius", "modulus", "creep_time", "shear_strength"})
    EXPECT_FALSE(SubstrateParameters::schema().find(key)->is_optional) << key;
  // Friction is that of a law or of a substrate, see ContactOnSubstrate; which coefficients are
  // needed depends on the law, see FrictionParameters.
  EXPECT_EQ(FrictionParameters{}.coefficient, std::nullopt);
}

using Kind = FrictionLaw::Kind;

/// Complaints about the keys of a section, one line each.
template <class Parameters>
std::vector<std::string> complaints(const Parameters& parameters) {
  std::vector<Problem> problems;
  for (const auto& check : Parameters::schema().checks) check(&parameters, problems);
  std::vector<std::string> lines;
  for (const Problem& problem : problems) lines.push_back(problem.text());
  return lines;
}

TEST(ContactOnSubstrate, TakesThePlaceOfFriction) {
  ContactParameters contact;
  contact.slave = {"reed.tip"};
  contact.master = "cantilever.top";
  EXPECT_THAT(complaints(contact),
              ElementsAre("friction: is missing: give `friction`, or a `substrate`"));
  contact.friction.emplace();
  contact.substrate.emplace();
  EXPECT_THAT(
      complaints(contact),
      ElementsAre("friction: not used with a substrate, whose law has it",
                  "assumption: must be `film` with a substrate: it sticks, slips and lifts off"));
  contact.friction.reset();
  contact.assumption = ContactAssumption::film;
  EXPECT_THAT(complaints(contact), IsEmpty());
}

TEST(ContactOnSubstrate, LawIsInSiUnits) {
  // F = E_0* R² F̃(y/R, v τ/R); at rest F̃ = 4/3 ŷ^{3/2}, Ã = π ŷ by the boundary elements.
  const SubstrateContact contact =
      make_substrate_contact({2e-3, 1e6, 0.01, 0.02, SphereContactLaw::boundary_element});
  const double y = 2e-5;
  EXPECT_NEAR(contact.at(y, 0.0, 1.0).normal.value, 1e6 * 4e-6 * 4.0 / 3.0 * 1e-3, 1e-12);
  EXPECT_NEAR(contact.static_strength(y).value, 0.02 * 1e6 * 4e-6 * M_PI * 0.01, 1e-12);
}

TEST(FrictionParameters, EveryLawNeedsItsOwnKeys) {
  FrictionParameters friction;
  EXPECT_THAT(complaints(friction),
              ElementsAre("coefficient: missing: needed by the constant friction law"));
  friction.law = Kind::static_dynamic;
  EXPECT_THAT(complaints(friction),
              ElementsAre("static: missing: needed by the static_dynamic friction law",
                          "dynamic: missing: needed by the static_dynamic friction law"));
  friction.law = Kind::stribeck;
  EXPECT_THAT(complaints(friction),
              ElementsAre("static: missing: needed by the stribeck friction law",
                          "dynamic: missing: needed by the stribeck friction law",
                          "decay_velocity: missing: needed by the stribeck friction law"));
}

TEST(FrictionParameters, KeysOfOtherLawsAreRefused) {
  const FrictionParameters all{Kind::constant, 0.3, 0.4, 0.3, 0.01};
  FrictionParameters friction = all;
  EXPECT_THAT(complaints(friction),
              ElementsAre("static: not used by the constant friction law",
                          "dynamic: not used by the constant friction law",
                          "decay_velocity: not used by the constant friction law"));
  friction.law = Kind::static_dynamic;
  EXPECT_THAT(complaints(friction),
              ElementsAre("coefficient: not used by the static_dynamic friction law",
                          "decay_velocity: not used by the static_dynamic friction law"));
  friction.law = Kind::stribeck;
  EXPECT_THAT(complaints(friction),
              ElementsAre("coefficient: not used by the stribeck friction law"));
}

TEST(FrictionParameters, CompleteLawsAreTaken) {
  EXPECT_THAT(complaints<FrictionParameters>({Kind::constant, 0.3, {}, {}, {}}), IsEmpty());
  EXPECT_THAT(complaints<FrictionParameters>({Kind::constant, 0.0, {}, {}, {}}), IsEmpty());
  EXPECT_THAT(complaints<FrictionParameters>({Kind::static_dynamic, {}, 0.4, 0.3, {}}), IsEmpty());
  EXPECT_THAT(complaints<FrictionParameters>({Kind::stribeck, {}, 0.4, 0.3, 0.01}), IsEmpty());
  // A law may rise with the speed.
  EXPECT_THAT(complaints<FrictionParameters>({Kind::stribeck, {}, 0.3, 0.4, 0.01}), IsEmpty());
}

TEST(FrictionParameters, AtRestNoLessThanInSlidingUnlessTheLawIsContinuous) {
  EXPECT_THAT(complaints<FrictionParameters>({Kind::static_dynamic, {}, 0.3, 0.4, {}}),
              ElementsAre("static: must not be below `dynamic`"));
  EXPECT_THAT(complaints<FrictionParameters>({Kind::static_dynamic, {}, 0.3, 0.3, {}}), IsEmpty());
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
  const FrictionLaw constant = make_friction_law({Kind::constant, 0.3, {}, {}, {}});
  EXPECT_EQ(constant.kind, Kind::constant);
  EXPECT_EQ(constant.static_coefficient, 0.3);
  EXPECT_EQ(constant.dynamic_coefficient, 0.3);
  const FrictionLaw jump = make_friction_law({Kind::static_dynamic, {}, 0.4, 0.3, {}});
  EXPECT_EQ(jump.kind, Kind::static_dynamic);
  EXPECT_EQ(jump.static_coefficient, 0.4);
  EXPECT_EQ(jump.dynamic_coefficient, 0.3);
  const FrictionLaw stribeck = make_friction_law({Kind::stribeck, {}, 0.4, 0.3, 0.01});
  EXPECT_EQ(stribeck.kind, Kind::stribeck);
  EXPECT_EQ(stribeck.static_coefficient, 0.4);
  EXPECT_EQ(stribeck.dynamic_coefficient, 0.3);
  EXPECT_EQ(stribeck.decay_velocity, 0.01);
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
