#include "coupling/contact_parameters.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <limits>
#include <string>
#include <vector>

namespace stridor {
namespace {

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
  choose("sliding", "frozen");
  EXPECT_EQ(contact.sliding, SlidingMode::frozen);
  choose("sliding", "moving");
  EXPECT_EQ(contact.sliding, SlidingMode::moving);
}

TEST(ContactParameters, PhysicalQuantitiesHaveNoDefault) {
  for (const char* key : {"slave", "master", "assumption", "start", "friction"})
    EXPECT_FALSE(ContactParameters::schema().find(key)->is_optional) << key;
  for (const char* key : {"velocity", "load", "ramp"})
    EXPECT_FALSE(DriveParameters::schema().find(key)->is_optional) << key;
  EXPECT_FALSE(FrictionParameters::schema().find("coefficient")->is_optional);
}

}  // namespace
}  // namespace stridor
