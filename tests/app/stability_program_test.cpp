// The verbs about small vibrations from outside: eig, locus, threshold, map.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <fstream>
#include <nlohmann/json.hpp>
#include <numbers>

#include "tests/support/program.hpp"
#include "tests/support/temporary_folder.hpp"

namespace stridor {
namespace {

using namespace test;
using ::testing::HasSubstr;
using Json = nlohmann::json;

const std::string trailing = scene_path("beam_on_beam.yaml");
const std::string leading = scene_path("beam_on_beam_leading.yaml");

/// The JSON object that the program prints; null, with a failure, where it does not end well.
Json run_json(std::vector<std::string> arguments) {
  arguments.push_back("--json");
  const ProgramResult result = Program(arguments).run();
  EXPECT_EQ(result.exit_code, 0) << result.err;
  return result.exit_code == 0 ? Json::parse(result.out) : Json();
}

struct Mode {
  double growth;     ///< 1/s
  double frequency;  ///< Hz
};

Mode mode_of(const Json& eigenvalue) {
  return {eigenvalue[0].get<double>(), eigenvalue[1].get<double>() / (2.0 * std::numbers::pi)};
}

std::vector<Mode> modes_of(const Json& eigenvalues) {
  std::vector<Mode> modes;
  for (const Json& one : eigenvalues) modes.push_back(mode_of(one));
  return modes;
}

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
  const Json object = run_json({"eig", reference.scene, "--at", reference.at});
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
      run_json({"eig", reference.scene, "--at", reference.at, "--about", "deformed"});
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
    const std::vector<Mode> secular = modes_of(run_json(arguments)["eigenvalues"]);
    std::vector<std::string> dense_arguments = arguments;
    dense_arguments.insert(dense_arguments.end(), {"--method", "dense"});
    const std::vector<Mode> dense = modes_of(run_json(dense_arguments)["eigenvalues"]);
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
            run_json({"eig", scene_path(std::string("examples/") + scene + ".yaml"), "--about",
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

/// Two reeds drawn slowly over a strip under friction that falls with the sliding velocity.
class TwoReeds {
 public:
  TwoReeds() {
    const auto beam = [](const char* size, const char* angle, const char* material, int along,
                         const char* supports, int modes) {
      return std::string("{type: beam, ") + size + ", width: 15 mm, angle: " + angle +
             " deg, material: {" + material + "}, mesh: {along: " + std::to_string(along) +
             ", through: 1}, damping: {alpha: 5, beta: 1.0e-7}, supports: " + supports +
             ", reduction: {fixed_interface_modes: " + std::to_string(modes) + "}}\n";
    };
    const char* steel = "youngs_modulus: 210 GPa, poissons_ratio: 0.3, density: 7850";
    const char* light = "youngs_modulus: 70 GPa, poissons_ratio: 0.33, density: 2700";
    const auto contact = [](const char* slave, const char* start) {
      return std::string("{slave: ") + slave +
             ".tip, master: strip.top, assumption: film, start: " + start +
             " mm, friction: {law: stribeck, static: 0.55, dynamic: 0.3, decay_velocity: 5 mm/s}, "
             "surface: smooth}\n";
    };
    std::ofstream(path()) << "format: 2\nsubstructures:\n  strip: "
                          << beam("length: 240 mm, thickness: 4 mm", "0", steel, 80,
                                  "{start: clamped, end: free}", 20)
                          << "  front: "
                          << beam("length: 40 mm, thickness: 1.2 mm", "70", light, 20,
                                  "{end: guided}", 10)
                          << "  rear: "
                          << beam("length: 35 mm, thickness: 1 mm", "115", light, 20,
                                  "{end: guided}", 10)
                          << "contacts:\n  lead: " << contact("front", "150")
                          << "  trail: " << contact("rear", "90")
                          << "drive: {velocity: 3 mm/s, load: -2 N, ramp: 50 ms}\n"
                             "time: {integrator: exact, step: 2.0e-6, retain: {frequency: 60 kHz}, "
                             "end: 0.6}\n"
                             "record: {interval: 2.0e-5, channels: [lead.force]}\n";
  }
  std::string path() const { return (folder_ / "reeds.yaml").string(); }

 private:
  TemporaryFolder folder_;
};

TEST(EigProgram, FallsBackToTheDenseMethodAndSaysSo) {
  const TwoReeds reeds;
  const Json object = run_json({"eig", reeds.path(), "--set", "time.integrator=central_difference",
                                "--set", "time.step=1e-7", "--set", "time.retain=all"});
  EXPECT_EQ(object["method"], "dense");
  EXPECT_THAT(object["remark"].get<std::string>(), HasSubstr("did not converge: all 728"));
  EXPECT_GE(object["eigenvalues"].size(), 20u);
  EXPECT_TRUE(object["doubtful"].empty());
  const Json kept = run_json({"eig", reeds.path()});
  EXPECT_EQ(kept["method"], "secular");
  EXPECT_FALSE(kept.contains("remark"));
}

TEST(LocusProgram, GrowthWithoutOscillationIsCalledThat) {
  // Under falling friction a contact leaves sliding on its own, faster than the modes kept resolve.
  const TwoReeds reeds;
  const std::vector<std::string> arguments{"locus", reeds.path(), "--from",   "0",
                                           "--to",  "1 mm",       "--points", "2"};
  int num_fast = 0, num_slow = 0;
  const Json locus = run_json(arguments);
  for (const Json& window : locus["unstable"]) {
    if (window["frequency"] != 0.0) {
      EXPECT_TRUE(window["oscillates"]);
      continue;
    }
    EXPECT_FALSE(window["oscillates"]);
    EXPECT_EQ(window["resolved"], window["growth_max"] < 1e5);
    ++(window["resolved"] ? num_slow : num_fast);
  }
  EXPECT_EQ(num_fast, 2);
  EXPECT_EQ(num_slow, 2);
  const std::string text = Program(arguments).run().out;
  EXPECT_THAT(text, HasSubstr("none"));
  EXPECT_THAT(text, HasSubstr("(above what the reduction resolves)"));
  EXPECT_THAT(text, HasSubstr("sliding is left without oscillation"));
}

TEST(EigProgram, DeformedEquilibriumBalancesTheLoad) {
  const Json object = run_json({"eig", leading, "--at", "0.091", "--about", "deformed"});
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
      run_json({"eig", leading, "--at", "0.091", "--about", "deformed", "--explain"});
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
      run_json({"eig", leading, "--at", "0.091", "--about", "deformed", "--explain", "--set",
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
  const Json object = run_json({"eig", leading, "--at", "0.091", "--explain", "--mode", "2"});
  EXPECT_EQ(object["explanation"]["mode"], 2);
  EXPECT_EQ(object["explanation"]["growth"], object["eigenvalues"][1][0]);
  const ProgramResult refused =
      Program({"eig", leading, "--explain", "--mode", "30", "--count", "5"}).run();
  EXPECT_EQ(refused.exit_code, 2);
  EXPECT_THAT(refused.err, HasSubstr("--mode: there are 5 modes, got 30; raise --count"));
}

TEST(EigProgram, WithoutFrictionNothingGrows) {
  const Json object = run_json(
      {"eig", leading, "--at", "0.091", "--set", "contact.friction.coefficient=0", "--explain"});
  EXPECT_TRUE(object["stable"].get<bool>());
  // A normal force on a gap that stays closed does no work.
  const Json& explanation = object["explanation"];
  EXPECT_NEAR(explanation["energy"]["growth_from_contact"].get<double>(), 0.0,
              1e-6 * std::abs(explanation["growth"].get<double>()));
}

/// Windows of an independent calculation on a grid of 0.25 mm: where the grid hits them.
struct ExpectedWindow {
  double inside;     ///< a position that is unstable
  double frequency;  ///< Hz
};

/// Every window holds one of the positions, and every position is in a window.
void expect_windows(const Json& unstable, const std::vector<ExpectedWindow>& expected) {
  for (const ExpectedWindow& one : expected) {
    const bool is_found = std::any_of(unstable.begin(), unstable.end(), [&](const Json& window) {
      return window["from"].get<double>() <= one.inside &&
             one.inside <= window["to"].get<double>() &&
             std::abs(window["frequency"].get<double>() - one.frequency) < 0.01 * one.frequency;
    });
    EXPECT_TRUE(is_found) << one.inside << ' ' << one.frequency << " Hz\n" << unstable.dump(1);
  }
}

TEST(LocusProgram, UndeformedWindowsAreThoseOfTheTrailingScene) {
  const Json object =
      run_json({"locus", trailing, "--from", "30 mm", "--to", "98 mm", "--points", "69"});
  const Json& unstable = object["unstable"];
  expect_windows(unstable, {{0.048, 10570}, {0.04825, 10570}, {0.0515, 10570}, {0.0955, 6950}});
  for (const Json& window : unstable) {
    const double frequency = window["frequency"].get<double>();
    EXPECT_TRUE(std::abs(frequency - 10570) < 60 || std::abs(frequency - 6950) < 60) << frequency;
    EXPECT_LT(window["to"].get<double>() - window["from"].get<double>(), 1.5e-3);
    EXPECT_GT(window["growth_max"].get<double>(), 0.0);
    EXPECT_GT(window["growth_integral"].get<double>(), 0.0);
  }
  EXPECT_EQ(object["parameter"], "contact.start");
  EXPECT_EQ(object["values"].size(), 69u);
  EXPECT_EQ(object["eigenvalues"].size(), 69u);
  EXPECT_EQ(object["eigenvalues"][18].size(), 20u);
  EXPECT_TRUE(object["unverified"].empty());
  // The drive has gone 0.03 (t - 0.05) m.
  for (const Json& window : unstable) {
    EXPECT_NEAR(window["from_time"].get<double>(),
                0.05 + (window["from"].get<double>() - 0.03) / 0.03, 1e-6);
    EXPECT_NEAR(window["gain"].get<double>(), window["growth_integral"].get<double>() / 0.03,
                0.02 * window["gain"].get<double>());
  }
}

TEST(LocusProgram, LeadingSceneHasWindowsAt10Point5KilohertzOnly) {
  const Json object =
      run_json({"locus", leading, "--from", "0.03", "--to", "0.098", "--points", "35"});
  expect_windows(object["unstable"],
                 {{0.04775, 10557}, {0.048, 10557}, {0.05175, 10570}, {0.052, 10570}});
  for (const Json& window : object["unstable"])
    EXPECT_NEAR(window["frequency"].get<double>(), 10565.0, 60.0);
}

TEST(LocusProgram, DeformedLocusHoldsTheBursts) {
  const Json object = run_json({"locus", leading, "--from", "0.06", "--to", "0.095", "--points",
                                "36", "--about", "deformed"});
  expect_windows(object["unstable"],
                 {{0.0635, 3520}, {0.074, 3520}, {0.083, 3520}, {0.091, 3520}, {0.0935, 10570}});
}

TEST(LocusProgram, OnePointEqualsEig) {
  const Json locus =
      run_json({"locus", trailing, "--from", "0.048", "--to", "0.048", "--points", "1"});
  const Json eig = run_json({"eig", trailing, "--at", "0.048"});
  ASSERT_EQ(locus["eigenvalues"].size(), 1u);
  const std::vector<Mode> a = modes_of(locus["eigenvalues"][0]);
  const std::vector<Mode> b = modes_of(eig["eigenvalues"]);
  ASSERT_EQ(a.size(), b.size());
  for (std::size_t i = 0; i < a.size(); ++i) {
    EXPECT_NEAR(a[i].growth, b[i].growth, 1e-6);
    EXPECT_NEAR(a[i].frequency, b[i].frequency, 1e-6);
  }
}

TEST(LocusProgram, FollowsAnyNumericKey) {
  const Json friction =
      run_json({"locus", trailing, "--parameter", "contact.friction.coefficient", "--from", "0",
                "--to", "0.3", "--points", "4", "--set", "contact.start=48 mm"});
  const std::vector<Mode> with = modes_of(friction["eigenvalues"][3]);
  EXPECT_NEAR(with[0].growth, -15.28, 0.01);
  EXPECT_NEAR(with[15].growth, 20.40, 0.01);
  ASSERT_EQ(friction["unstable"].size(), 1u);
  EXPECT_EQ(friction["unstable"][0]["to"], 0.3);
  EXPECT_TRUE(friction["unstable"][0]["from_time"].is_null());

  const Json modes = run_json(
      {"locus", trailing, "--parameter", "substructures.oblique.reduction.fixed_interface_modes",
       "--from", "18", "--to", "20", "--points", "3", "--set", "contact.start=48 mm"});
  EXPECT_NEAR(mode_of(modes["eigenvalues"][2][0]).growth, -15.28, 0.01);
  EXPECT_EQ(modes["values"], Json({18.0, 19.0, 20.0}));
}

TEST(ThresholdProgram, StandsWhereTheLocusCrosses) {
  const Json object =
      run_json({"threshold", trailing, "--parameter", "contact.friction.coefficient", "--from",
                "0.05", "--to", "0.3", "--set", "contact.start=48 mm"});
  ASSERT_EQ(object["roots"].size(), 1u);
  const double critical = object["roots"][0]["value"].get<double>();
  EXPECT_NEAR(object["roots"][0]["frequency"].get<double>(), 10572.0, 5.0);
  EXPECT_EQ(object["roots"][0]["beyond"], "unstable");
  const auto growth_at = [&](double friction) {
    const Json eig = run_json({"eig", trailing, "--at", "48 mm", "--set",
                               "contact.friction.coefficient=" + std::to_string(friction)});
    double largest = -1e9;
    for (const Mode& mode : modes_of(eig["eigenvalues"])) largest = std::max(largest, mode.growth);
    return largest;
  };
  EXPECT_LT(growth_at(critical - 1e-5), 0.0);
  EXPECT_GT(growth_at(critical + 1e-5), 0.0);
}

TEST(ThresholdProgram, FindsBothEndsOfEveryWindow) {
  const Json object =
      run_json({"threshold", trailing, "--from", "0.05", "--to", "0.098", "--points", "20"});
  const Json& roots = object["roots"];
  ASSERT_EQ(roots.size() % 2, 0u);
  for (std::size_t i = 0; i < roots.size(); ++i)
    EXPECT_EQ(roots[i]["beyond"], i % 2 == 0 ? "unstable" : "stable");
}

TEST(MapProgram, DoesNotDependOnTheNumberOfThreads) {
  const std::vector<std::string> arguments{"map",
                                           trailing,
                                           "--x",
                                           "contact.start",
                                           "0.047",
                                           "0.049",
                                           "5",
                                           "--y",
                                           "contact.friction.coefficient",
                                           "0.1",
                                           "0.4",
                                           "4",
                                           "--json"};
  std::vector<std::string> one = arguments;
  one.insert(one.end(), {"--threads", "1"});
  std::vector<std::string> two = arguments;
  two.insert(two.end(), {"--threads", "2"});
  const ProgramResult first = Program(one).run();
  ASSERT_EQ(first.exit_code, 0) << first.err;
  EXPECT_EQ(first.out, Program(two).run().out);

  const Json object = Json::parse(first.out);
  EXPECT_EQ(object["x"].size(), 5u);
  EXPECT_EQ(object["y"].size(), 4u);
  ASSERT_EQ(object["growth"].size(), 4u);
  EXPECT_NEAR(object["growth"][2][2].get<double>(), 20.40, 0.01);  // 48 mm, 0.3
  EXPECT_LT(object["growth"][0][2].get<double>(), 0.0);
  ASSERT_FALSE(object["boundary"].empty());
  for (const Json& point : object["boundary"][0]) {
    EXPECT_GE(point[0].get<double>(), 0.047);
    EXPECT_LE(point[0].get<double>(), 0.049);
    EXPECT_GT(point[1].get<double>(), 0.1);
    EXPECT_LE(point[1].get<double>(), 0.4);
  }
}

struct WrongUse {
  std::vector<std::string> arguments;
  int exit_code;
  std::string message;
};

void PrintTo(const WrongUse& use, std::ostream* stream) {
  *stream << use.message;
}

class WrongUseTest : public ::testing::TestWithParam<WrongUse> {};

TEST_P(WrongUseTest, IsRefusedWithARemedy) {
  const ProgramResult result = Program(GetParam().arguments).run();
  EXPECT_EQ(result.exit_code, GetParam().exit_code) << result.err;
  EXPECT_THAT(result.err, HasSubstr(GetParam().message));
  EXPECT_TRUE(result.out.empty()) << result.out;
}

std::vector<std::string> locus_of(const std::string& key, const std::string& from,
                                  const std::string& to, const std::string& points = "5") {
  return {"locus", trailing, "--parameter", key, "--from", from, "--to", to, "--points", points};
}

INSTANTIATE_TEST_SUITE_P(
    Values, WrongUseTest,
    ::testing::Values(
        WrongUse{{"eig", trailing, "--at", "0.2"}, 2, "0.2 m is off the master 'cantilever.top'"},
        WrongUse{{"eig", trailing, "--at", "-1 mm"}, 2, "--at: contact.start must be >= 0 m"},
        WrongUse{{"eig", trailing, "--at", "3 kg"}, 2, "--at"},
        WrongUse{{"eig", trailing, "--about", "bent"}, 2, "--about"},
        WrongUse{{"eig", trailing, "--mode", "2"}, 2, "add --explain or --shapes"},
        WrongUse{{"eig", trailing, "--explain", "--mode", "0"}, 2, "not in range 1 to 100000"},
        WrongUse{
            locus_of("contact.start", "0.05", "0.2"), 2,
            "0.2 m is off the master 'cantilever.top', which is 0.1 m long; allowed: 0 to 0.1 m"},
        WrongUse{locus_of("contact.start", "0.06", "0.05"), 2,
                 "--from: '0.06' is beyond --to '0.05'"},
        WrongUse{locus_of("contact.frction.coefficient", "0", "1"), 2,
                 "--parameter: 'contact.frction.coefficient': there is no key 'frction' in "
                 "'contact', did you mean 'friction'?"},
        WrongUse{locus_of("substructures.obliqe.length", "0.07", "0.08"), 2,
                 "there is no key 'obliqe' in 'substructures', did you mean 'oblique'?"},
        WrongUse{locus_of("contact.assumption", "0", "1"), 2,
                 "'contact.assumption' is no number that could be varied"},
        WrongUse{locus_of("contact.friction", "0", "1"), 2,
                 "'contact.friction' is a section; name one of its numbers"},
        WrongUse{locus_of("time.step", "1e-7", "2e-7"), 2,
                 "'time.step' has no influence on the eigenvalues"},
        WrongUse{locus_of("contact.friction.coefficient", "-0.1", "0.3"), 2,
                 "--from: contact.friction.coefficient must be >= 0, got '-0.1'"},
        WrongUse{locus_of("substructures.oblique.mesh.along", "10.5", "12"), 2,
                 "--from: '10.5' must be a whole number"},
        WrongUse{locus_of("substructures.oblique.mesh.along", "10", "13", "3"), 2,
                 "3 points from 10 to 13 are not whole numbers"},
        WrongUse{
            locus_of("contact.start", "0.05", "0.06", "1"), 2,
            "1 point is enough only where both ends of the range of contact.start are the same"},
        WrongUse{{"map", trailing, "--x", "contact.start", "0.04", "0.05", "3", "--y",
                  "contact.friction.coefficient", "0", "0.3", "3", "--scale", "log"},
                 2,
                 "a logarithmic scale needs positive values of contact.friction.coefficient"},
        WrongUse{{"map", trailing, "--x", "contact.start", "0.05", "0.04", "3", "--y",
                  "contact.friction.coefficient", "0", "0.3", "3"},
                 2,
                 "--x: '0.05' must be less than '0.04'"},
        WrongUse{{"map", trailing, "--x", "contact.start", "0.04", "0.05", "3", "--y",
                  "contact.start", "0.04", "0.05", "3"},
                 2,
                 "--y: 'contact.start' is the key of --x already"}));

TEST(LocusProgram, FilesAreWrittenOnceAndKeptWithoutForce) {
  const TemporaryFolder folder;
  const std::vector<std::string> arguments{"locus",     trailing,
                                           "--from",    "0.0475",
                                           "--to",      "0.0485",
                                           "--points",  "3",
                                           "-o",        (folder / "locus.h5").string(),
                                           "--figure",  (folder / "locus.svg").string(),
                                           "--history", (folder / "history.svg").string()};
  const ProgramResult result = Program(arguments).run();
  ASSERT_EQ(result.exit_code, 0) << result.err;
  for (const char* name : {"locus.h5", "locus.svg", "history.svg"})
    EXPECT_GT(std::filesystem::file_size(folder / name), 1000u) << name;
  const ProgramResult refused = Program(arguments).run();
  EXPECT_EQ(refused.exit_code, 4);
  EXPECT_THAT(refused.err, HasSubstr("exists; use --force to overwrite it"));
}

TEST(LocusProgram, AFrequencyAloneAsksForAllBelowIt) {
  const std::vector<std::string> below{"--below", "200 kHz"};
  std::vector<std::string> eig{"eig", trailing, "--set", "contact.start=50 mm"};
  std::vector<std::string> locus{"locus", trailing, "--from",   "50 mm",
                                 "--to",  "51 mm",  "--points", "2"};
  eig.insert(eig.end(), below.begin(), below.end());
  locus.insert(locus.end(), below.begin(), below.end());
  const Json all = run_json(eig)["eigenvalues"];
  EXPECT_GT(all.size(), 60U);
  const Json along = run_json(locus)["eigenvalues"][0];
  ASSERT_EQ(along.size(), all.size());
  for (std::size_t i = 0; i < all.size(); ++i)
    EXPECT_NEAR(along[i][1].get<double>(), all[i][1].get<double>(),
                1e-9 * all.back()[1].get<double>());
  locus.insert(locus.end(), {"--count", "7"});
  int num_pairs = 0;
  const Json lowest = run_json(locus)["eigenvalues"][0];
  for (const Json& s : lowest) num_pairs += s[1].get<double>() > 0.0;
  EXPECT_EQ(num_pairs, 7);
}

}  // namespace
}  // namespace stridor
