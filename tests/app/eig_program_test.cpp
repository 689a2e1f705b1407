// The verb eig from outside, against independent calculations and by both methods.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <ostream>
#include <string>
#include <vector>

#include "tests/support/eigenvalue_program.hpp"
#include "tests/support/program.hpp"

namespace stridor {
namespace {

using namespace test;
using ::testing::HasSubstr;

/// An independent calculation of the two beams at mu = 0.3 about the undeformed geometry: the
/// lowest eigenvalues, and what is unstable below 12 kHz, to the digits printed.
struct Reference {
  std::string scene;
  std::string at;
  std::vector<Mode> lowest;
  std::vector<Mode> unstable;
};

void PrintTo(const Reference& reference, std::ostream* stream) {
  *stream << reference.scene << " at " << reference.at;
}

class UndeformedEigenvaluesTest : public ::testing::TestWithParam<Reference> {};

TEST_P(UndeformedEigenvaluesTest, AreThoseOfAnIndependentCalculation) {
  const Reference& reference = GetParam();
  const Json object = json_of({"eig", reference.scene, "--at", reference.at});
  const std::vector<Mode> modes = modes_of(object["eigenvalues"]);
  ASSERT_EQ(modes.size(), 20u);
  // Half a unit of the last digit printed, and as much again for the other calculation's rounding.
  for (std::size_t i = 0; i < reference.lowest.size(); ++i) {
    EXPECT_NEAR(modes[i].growth, reference.lowest[i].growth, 0.01) << i;
    EXPECT_NEAR(modes[i].frequency, reference.lowest[i].frequency, 0.01) << i;
  }
  std::vector<Mode> unstable;
  for (const Mode& mode : modes)
    if (mode.growth > 0.0 && mode.frequency < 12e3) unstable.push_back(mode);
  ASSERT_EQ(unstable.size(), reference.unstable.size());
  for (std::size_t i = 0; i < unstable.size(); ++i) {
    EXPECT_NEAR(unstable[i].growth, reference.unstable[i].growth, 0.01);
    EXPECT_NEAR(unstable[i].frequency, reference.unstable[i].frequency, 0.1);
  }
  EXPECT_EQ(object["stable"].get<bool>(), reference.unstable.empty());
  EXPECT_EQ(object["window"][0], 0.0);
  EXPECT_GE(object["window"][1].get<double>(), 12e3);
  // Without deformation the contact carries the load.
  EXPECT_NEAR(object["equilibrium"]["force"].get<double>(), 0.2, 1e-9);
  EXPECT_NEAR(object["equilibrium"]["friction_force"].get<double>(), 0.06, 1e-9);
  for (const Json& residual : object["residuals"]) EXPECT_LT(residual.get<double>(), 1e-9);
}

INSTANTIATE_TEST_SUITE_P(
    Positions, UndeformedEigenvaluesTest,
    ::testing::Values(
        Reference{trailing,
                  "48 mm",
                  {{-15.28, 40.13},
                   {-5.60, 141.92},
                   {-13.24, 288.88},
                   {-20.25, 792.16},
                   {-7.13, 1120.30},
                   {-16.77, 1562.40}},
                  {{20.40, 10572.2}}},
        Reference{trailing,
                  "0.0955",
                  {{-5.85, 24.79},
                   {-12.19, 191.85},
                   {-12.04, 289.45},
                   {-18.51, 738.73},
                   {-8.65, 1290.80}},
                  {{41.79, 6950.6}}},
        Reference{trailing, "0.0565", {}, {}},
        Reference{leading,
                  "0.048",
                  {{-15.46, 40.23},
                   {-6.55, 160.38},
                   {-10.26, 290.50},
                   {-20.19, 790.72},
                   {-8.63, 1097.20},
                   {-15.86, 1563.95}},
                  {{6.79, 10556.4}}},
        Reference{leading, "56.5 mm", {{-13.36, 37.43}, {-7.93, 173.83}, {-11.21, 289.96}}, {}}));

/// Peaks of growth about the deformed equilibrium, from an independent calculation with truncated
/// modes on a grid of 0.5 mm, good to 3 %. Its positions are those of the contact in the trailing
/// scene. In the leading one they are those of the drive, 0.0635, 0.074, 0.083, 0.091 and 0.0935,
/// which the tip is 0.02 to 0.04 mm ahead of.
struct DeformedReference {
  std::string scene;
  std::string at;
  std::vector<Mode> unstable;
};

class DeformedEigenvaluesTest : public ::testing::TestWithParam<DeformedReference> {};

TEST_P(DeformedEigenvaluesTest, HoldTheGrowthOfAnIndependentCalculation) {
  const DeformedReference& reference = GetParam();
  const Json object =
      json_of({"eig", reference.scene, "--at", reference.at, "--about", "deformed"});
  std::vector<Mode> unstable;
  for (const Mode& mode : modes_of(object["eigenvalues"]))
    if (mode.growth > 0.0) unstable.push_back(mode);
  for (const Mode& expected : reference.unstable) {
    const auto found = std::find_if(unstable.begin(), unstable.end(), [&](const Mode& mode) {
      return std::abs(mode.frequency - expected.frequency) < 0.005 * expected.frequency;
    });
    ASSERT_NE(found, unstable.end()) << expected.frequency;
    EXPECT_NEAR(found->growth, expected.growth, 0.03 * expected.growth + 0.5);
  }
}

INSTANTIATE_TEST_SUITE_P(Positions, DeformedEigenvaluesTest,
                         ::testing::Values(DeformedReference{leading, "0.06354", {{36, 3520}}},
                                           DeformedReference{leading, "0.07403", {{87, 3520}}},
                                           DeformedReference{leading, "0.08303", {{87, 3520}}},
                                           DeformedReference{leading, "0.09103", {{133, 3520}}},
                                           DeformedReference{leading, "0.09352", {{98, 10570}}},
                                           DeformedReference{trailing, "0.0625", {{43, 3520}}},
                                           DeformedReference{trailing, "0.075", {{90, 3520}}},
                                           DeformedReference{trailing, "0.0815", {{86, 3520}}},
                                           DeformedReference{trailing, "0.092", {{129, 3520}}},
                                           DeformedReference{trailing, "0.048", {{45, 10570}}},
                                           DeformedReference{trailing, "0.0935", {{71, 10570}}},
                                           DeformedReference{trailing, "0.0955", {{52, 6950}}}));

TEST(EigProgram, DenseMethodGivesTheSameEigenvalues) {
  for (const char* about : {"undeformed", "deformed"}) {
    const std::vector<std::string> arguments{"eig", leading, "--at", "0.091", "--about", about};
    const std::vector<Mode> secular = modes_of(json_of(arguments)["eigenvalues"]);
    std::vector<std::string> dense_arguments = arguments;
    dense_arguments.insert(dense_arguments.end(), {"--method", "dense"});
    const std::vector<Mode> dense = modes_of(json_of(dense_arguments)["eigenvalues"]);
    ASSERT_EQ(secular.size(), dense.size());
    // The dense method has an absolute error of some roundings of the highest frequency, 6e6 rad/s;
    // two modes that almost coincide magnify it by some thousands.
    for (std::size_t i = 0; i < dense.size(); ++i) {
      EXPECT_NEAR(secular[i].growth, dense[i].growth, 1e-4) << i;
      EXPECT_NEAR(secular[i].frequency, dense[i].frequency, 1e-4) << i;
    }
  }
}

TEST(EigProgram, BothMethodsAgreeForSeveralContactsAndRigidMasters) {
  // Two pairs; an edge of three points of which one is open, on a rigid master; a single point on a
  // rigid master under a law with a jump.
  for (const char* scene : {"two_pairs", "slave_edge", "stick_slip"}) {
    for (const char* about : {"undeformed", "deformed"}) {
      const auto modes = [&](const char* method) {
        return modes_of(
            json_of({"eig", scene_path(std::string("examples/") + scene + ".yaml"), "--about",
                     about, "--method", method, "--count", "6"})["eigenvalues"]);
      };
      const std::vector<Mode> secular = modes("secular");
      const std::vector<Mode> dense = modes("dense");
      ASSERT_GE(secular.size(), 6u) << scene;
      ASSERT_EQ(secular.size(), dense.size()) << scene;
      for (std::size_t i = 0; i < dense.size(); ++i) {
        EXPECT_NEAR(secular[i].growth, dense[i].growth, 1e-4) << scene << ' ' << i;
        EXPECT_NEAR(secular[i].frequency, dense[i].frequency, 1e-4) << scene << ' ' << i;
      }
    }
  }
}

TEST(EigProgram, DeformedEquilibriumBalancesTheLoad) {
  const Json object = json_of({"eig", leading, "--at", "0.091", "--about", "deformed"});
  const Json& state = object["equilibrium"];
  const double angle = state["angle"].get<double>();
  EXPECT_LT(angle, 0.0);  // the cantilever sags
  // lambda (cos g - mu sin g) is the load: what the contact carries in y.
  const double force = state["force"].get<double>();
  EXPECT_NEAR(force * (std::cos(angle) - 0.3 * std::sin(angle)), 0.2, 1e-9);
  EXPECT_NEAR(state["gap"].get<double>(), 0.0, 1e-12);
  EXPECT_LT(state["points"]["cantilever.free_end"][1].get<double>(), 0.0);
}

TEST(EigProgram, ExplanationAddsUpToTheGrowth) {
  const Json object =
      json_of({"eig", leading, "--at", "0.091", "--about", "deformed", "--explain"});
  const Json& explanation = object["explanation"];
  const double growth = explanation["growth"].get<double>();
  EXPECT_NEAR(growth, 134.0, 1.0);
  const Json& energy = explanation["energy"];
  EXPECT_NEAR(
      energy["growth_from_contact"].get<double>() + energy["growth_by_damping"].get<double>(),
      growth, 1e-6 * growth);
  EXPECT_LT(energy["growth_by_damping"].get<double>(), 0.0);
  // The contact is the only other source.
  EXPECT_GT(energy["growth_from_contact"].get<double>(), growth);
  EXPECT_LT(explanation["quotients"]["residual"].get<double>(), 1e-9);
  EXPECT_LT(explanation["quotients"]["margin"].get<double>(), 0.0);
  // Nearly all of it are two modes that are neighbours without friction.
  const Json& modes = explanation["frictionless_modes"];
  ASSERT_EQ(modes.size(), 2u);
  EXPECT_GT(modes[0]["share"].get<double>() + modes[1]["share"].get<double>(), 0.98);
  for (const Json& mode : modes) EXPECT_NEAR(mode["frequency"].get<double>(), 3500.0, 60.0);
}

TEST(EigProgram, ExplainsTheModesThatAreKept) {
  const Json object =
      json_of({"eig", leading, "--at", "0.091", "--about", "deformed", "--explain", "--set",
               "time.integrator=exact", "--set", "time.retain={frequency: 20 kHz}"});
  EXPECT_LT(object["explanation"]["quotients"]["residual"].get<double>(), 1e-9);
  EXPECT_LT(object["explanation"]["energy"]["residual"].get<double>(), 1e-9);
}

TEST(EigProgram, SaysWhyTheVerdictReachesNoFurther) {
  const ProgramResult asked = Program({"eig", leading, "--count", "4"}).run();
  EXPECT_THAT(asked.out, HasSubstr("Hz (nothing above was asked for; --below 72.03kHz looks as "
                                   "high as the bodies resolve)"));
  const ProgramResult all = Program({"eig", leading, "--count", "300"}).run();
  EXPECT_THAT(all.out, HasSubstr("a rule of thumb: half the frequency of the highest mode kept"));
  const ProgramResult locus =
      Program({"locus", leading, "--from", "0.05", "--to", "0.051", "--points", "2"}).run();
  EXPECT_THAT(locus.out, HasSubstr("Hz (nothing above was asked for; --below 72.03kHz looks as "
                                   "high as the bodies resolve)"));
}

TEST(EigProgram, ModeCanBeChosen) {
  const Json object = json_of({"eig", leading, "--at", "0.091", "--explain", "--mode", "2"});
  EXPECT_EQ(object["explanation"]["mode"], 2);
  EXPECT_EQ(object["explanation"]["growth"], object["eigenvalues"][1][0]);
  const ProgramResult refused =
      Program({"eig", leading, "--explain", "--mode", "30", "--count", "5"}).run();
  EXPECT_EQ(refused.exit_code, 2);
  EXPECT_THAT(refused.err, HasSubstr("--mode: there are 5 modes, got 30; raise --count"));
}

TEST(EigProgram, WithoutFrictionNothingGrows) {
  const Json object = json_of(
      {"eig", leading, "--at", "0.091", "--set", "contact.friction.coefficient=0", "--explain"});
  EXPECT_TRUE(object["stable"].get<bool>());
  // A normal force on a gap that stays closed does no work.
  const Json& explanation = object["explanation"];
  EXPECT_NEAR(explanation["energy"]["growth_from_contact"].get<double>(), 0.0,
              1e-6 * std::abs(explanation["growth"].get<double>()));
}

}  // namespace
}  // namespace stridor
