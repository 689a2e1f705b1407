#include "io/scene/channels.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "core/errors.hpp"
#include "tests/support/paper_model.hpp"

namespace stridor {
namespace {

using namespace test;
using ::testing::HasSubstr;

TEST(Channels, MotionsAndContactQuantitiesAreRead) {
  RecordParameters record;
  record.channels = {"cantilever.free_end.y.acceleration", "oblique.tip.x.velocity",
                     "contact.slip_velocity", "contact.friction_force", "contact.state"};
  const auto channels = parse_channels(record, paper_model());
  ASSERT_EQ(channels.size(), 5u);
  EXPECT_EQ(*channels[0].point, (PointName{"cantilever", "free_end"}));
  EXPECT_EQ(channels[0].direction, 1);
  EXPECT_EQ(channels[0].derivative, Derivative::second);
  EXPECT_EQ(channels[0].units(), "m/s^2");
  EXPECT_EQ(channels[1].direction, 0);
  EXPECT_EQ(channels[1].units(), "m/s");
  EXPECT_FALSE(channels[2].point.has_value());
  EXPECT_EQ(channels[2].pair, "contact");
  EXPECT_EQ(channels[2].quantity, ContactQuantity::slip_velocity);
  EXPECT_EQ(channels[3].quantity, ContactQuantity::friction_force);
  EXPECT_EQ(channels[3].units(), "N");
  EXPECT_TRUE(channels[2].is_filtered());
  EXPECT_FALSE(channels[3].is_filtered());
  EXPECT_EQ(channels[4].quantity, ContactQuantity::state);
  EXPECT_EQ(channels[4].units(), "1");
  EXPECT_FALSE(channels[4].is_filtered());
}

TEST(Channels, EnergyIsRecordedWholeOrNotAtAll) {
  RecordParameters record;
  record.channels = {"contact.force"};
  EXPECT_EQ(parse_channels(record, paper_model()).size(), 1u);
  record.energy = true;
  const auto channels = parse_channels(record, paper_model());
  std::vector<std::string> names;
  for (std::size_t i = 1; i < channels.size(); ++i) {
    ASSERT_NE(channels[i].energy, nullptr);
    names.push_back(channels[i].energy->name);
    EXPECT_EQ(channels[i].units(), "J");
    EXPECT_FALSE(channels[i].is_filtered());
  }
  EXPECT_THAT(names,
              ::testing::ElementsAre("kinetic", "strain", "damping_loss", "friction_loss",
                                     "contact_work", "drive_work", "load_work", "balance_error"));
}

TEST(Channels, EveryWrongNameIsReportedAtItsPlaceInTheList) {
  RecordParameters record;
  record.channels = {"contact.force",
                     "cantlever.free_end.y.velocity",
                     "oblique.tip.w.velocity",
                     "oblique.tip.x.speed",
                     "contac.force",
                     "contact.pressure",
                     "oblique.tip",
                     "a.b.c.d.e",
                     "contact.force"};
  try {
    parse_channels(record, paper_model());
    FAIL() << "not refused";
  } catch (const ConfigError& error) {
    const auto& problems = error.problems();
    ASSERT_EQ(problems.size(), 8u);
    EXPECT_EQ(problems[0].key, "record.channels.1");
    EXPECT_THAT(problems[0].message,
                HasSubstr("there is no substructure 'cantlever', did you mean 'cantilever'?"));
    EXPECT_THAT(problems[1].message, HasSubstr("'w' is not a direction; take x, y or z"));
    EXPECT_THAT(problems[2].message, HasSubstr("there is no motion 'speed'"));
    EXPECT_THAT(problems[3].message,
                HasSubstr("there is no contact pair 'contac', did you mean 'contact'?"));
    EXPECT_THAT(problems[4].message,
                HasSubstr("there is no contact quantity 'pressure' (there are: force, gap, "
                          "slip_velocity, position, friction_force, state, area, "
                          "friction_across, slip_across)"));
    EXPECT_THAT(problems[5].message, HasSubstr("there is no contact pair 'oblique'"));
    EXPECT_THAT(problems[6].message, HasSubstr("is neither <body>.<point>"));
    EXPECT_EQ(problems[7].key, "record.channels.8");
    EXPECT_THAT(problems[7].message, HasSubstr("is listed twice"));
  }
}

}  // namespace
}  // namespace stridor
