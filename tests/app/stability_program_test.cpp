// The verbs that follow eigenvalues from outside: locus, threshold, map; wrong use, also of eig.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <string>
#include <vector>

#include "tests/support/eigenvalue_program.hpp"
#include "tests/support/program.hpp"
#include "tests/support/temporary_folder.hpp"

namespace stridor {
namespace {

using namespace test;
using ::testing::HasSubstr;

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
      json_of({"locus", trailing, "--from", "30 mm", "--to", "98 mm", "--points", "69"});
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
      json_of({"locus", leading, "--from", "0.03", "--to", "0.098", "--points", "35"});
  expect_windows(object["unstable"],
                 {{0.04775, 10557}, {0.048, 10557}, {0.05175, 10570}, {0.052, 10570}});
  for (const Json& window : object["unstable"])
    EXPECT_NEAR(window["frequency"].get<double>(), 10565.0, 60.0);
}

TEST(LocusProgram, DeformedLocusHoldsTheBursts) {
  const Json object = json_of({"locus", leading, "--from", "0.06", "--to", "0.095", "--points",
                               "36", "--about", "deformed"});
  expect_windows(object["unstable"],
                 {{0.0635, 3520}, {0.074, 3520}, {0.083, 3520}, {0.091, 3520}, {0.0935, 10570}});
}

TEST(LocusProgram, OnePointEqualsEig) {
  const Json locus =
      json_of({"locus", trailing, "--from", "0.048", "--to", "0.048", "--points", "1"});
  const Json eig = json_of({"eig", trailing, "--at", "0.048"});
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
      json_of({"locus", trailing, "--parameter", "contact.friction.coefficient", "--from", "0",
               "--to", "0.3", "--points", "4", "--set", "contact.start=48 mm"});
  const std::vector<Mode> with = modes_of(friction["eigenvalues"][3]);
  EXPECT_NEAR(with[0].growth, -15.28, 0.01);
  EXPECT_NEAR(with[15].growth, 20.40, 0.01);
  ASSERT_EQ(friction["unstable"].size(), 1u);
  EXPECT_EQ(friction["unstable"][0]["to"], 0.3);
  EXPECT_TRUE(friction["unstable"][0]["from_time"].is_null());

  const Json modes = json_of({"locus", trailing, "--parameter",
                              "substructures.oblique.reduction.fixed_interface_modes", "--from",
                              "18", "--to", "20", "--points", "3", "--set", "contact.start=48 mm"});
  EXPECT_NEAR(mode_of(modes["eigenvalues"][2][0]).growth, -15.28, 0.01);
  EXPECT_EQ(modes["values"], Json({18.0, 19.0, 20.0}));
}

TEST(ThresholdProgram, StandsWhereTheLocusCrosses) {
  const Json object = json_of({"threshold", trailing, "--parameter", "contact.friction.coefficient",
                               "--from", "0.05", "--to", "0.3", "--set", "contact.start=48 mm"});
  ASSERT_EQ(object["roots"].size(), 1u);
  const double critical = object["roots"][0]["value"].get<double>();
  EXPECT_NEAR(object["roots"][0]["frequency"].get<double>(), 10572.0, 5.0);
  EXPECT_EQ(object["roots"][0]["beyond"], "unstable");
  const auto growth_at = [&](double friction) {
    const Json eig = json_of({"eig", trailing, "--at", "48 mm", "--set",
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
      json_of({"threshold", trailing, "--from", "0.05", "--to", "0.098", "--points", "20"});
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
  const Json all = json_of(eig)["eigenvalues"];
  EXPECT_GT(all.size(), 60U);
  const Json along = json_of(locus)["eigenvalues"][0];
  ASSERT_EQ(along.size(), all.size());
  for (std::size_t i = 0; i < all.size(); ++i)
    EXPECT_NEAR(along[i][1].get<double>(), all[i][1].get<double>(),
                1e-9 * all.back()[1].get<double>());
  locus.insert(locus.end(), {"--count", "7"});
  int num_pairs = 0;
  const Json lowest = json_of(locus)["eigenvalues"][0];
  for (const Json& s : lowest) num_pairs += s[1].get<double>() > 0.0;
  EXPECT_EQ(num_pairs, 7);
}

}  // namespace
}  // namespace stridor
