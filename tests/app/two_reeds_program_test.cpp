// Contacts that leave sliding on their own, as the verbs about small vibrations see them.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <fstream>
#include <string>
#include <vector>

#include "tests/support/eigenvalue_program.hpp"
#include "tests/support/program.hpp"
#include "tests/support/temporary_folder.hpp"

namespace stridor {
namespace {

using namespace test;
using ::testing::HasSubstr;

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
  const Json object = json_of({"eig", reeds.path(), "--set", "time.integrator=central_difference",
                               "--set", "time.step=1e-7", "--set", "time.retain=all"});
  EXPECT_EQ(object["method"], "dense");
  EXPECT_THAT(object["remark"].get<std::string>(), HasSubstr("did not converge: all 728"));
  EXPECT_GE(object["eigenvalues"].size(), 20u);
  EXPECT_TRUE(object["doubtful"].empty());
  const Json kept = json_of({"eig", reeds.path()});
  EXPECT_EQ(kept["method"], "secular");
  EXPECT_FALSE(kept.contains("remark"));
}

TEST(LocusProgram, GrowthWithoutOscillationIsCalledThat) {
  // Under falling friction a contact leaves sliding on its own, faster than the modes kept resolve.
  const TwoReeds reeds;
  const std::vector<std::string> arguments{"locus", reeds.path(), "--from",   "0",
                                           "--to",  "1 mm",       "--points", "2"};
  int num_fast = 0, num_slow = 0;
  const Json locus = json_of(arguments);
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

}  // namespace
}  // namespace stridor
