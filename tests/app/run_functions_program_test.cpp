// Histories and spectra that `plot --data` writes as universal files.
#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <cstddef>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "io/imports/uff_contents.hpp"
#include "tests/app/pictures_fixture.hpp"

namespace stridor {
namespace {

using namespace test;
using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::SizeIs;
using Json = nlohmann::json;

class RunFunctions : public Pictures {
 protected:
  static UffHoldings held(const std::string& file) { return read_uff_holdings_file(file); }
};

TEST_F(RunFunctions, HistoriesHaveTheSamplesOfTheRunAtEvenTimes) {
  const std::string run = make_run();
  const Json object = json_of({"plot", run, "--kind", "history", "--data", path("a.uff")});
  EXPECT_EQ(object["figure"], nullptr);
  EXPECT_EQ(object["data"], path("a.uff"));
  EXPECT_EQ(object["functions"], 4);
  const UffHoldings all = held(path("a.uff"));
  EXPECT_TRUE(all.units.is_given);
  ASSERT_THAT(all.functions, SizeIs(4));
  const RunFileReader file(run);
  for (const UffFunction& one : all.functions) {
    const bool is_force = one.id == "contact.force";
    const std::string series = is_force ? "/contact/contact/force" : "/channels/" + one.id;
    const std::vector<double> samples = file.series(series);
    EXPECT_EQ(one.type, 1);
    EXPECT_EQ(one.abscissa_quantity, 17);
    EXPECT_EQ(one.ordinate_quantity, is_force             ? 9
                                     : one.units == "m"   ? 8
                                     : one.units == "m/s" ? 11
                                                          : 12);
    EXPECT_EQ(one.units, units_of(series));
    EXPECT_EQ(one.response, is_force ? (UffDof{0, 0}) : (UffDof{1, 2}));
    EXPECT_FALSE(one.is_complex);
    ASSERT_THAT(one.values, SizeIs(num_rows));
    for (std::size_t i = 0; i < num_rows; ++i) {
      EXPECT_NEAR(one.abscissa[i], static_cast<double>(i) * interval, 1e-12);
      EXPECT_EQ(one.values[i].real(), std::stod(fmt::format("{:.12E}", samples[i])));
    }
  }
  // In binary they are the samples themselves; in a stretch alone, those within.
  json_of({"plot", run, "--kind", "history", "--data", path("b.unv"), "--binary", "--channel",
           "beam.tip.y.velocity", "--from", "0.2", "--to", "0.25"});
  const UffHoldings some = held(path("b.unv"));
  ASSERT_THAT(some.functions, SizeIs(1));
  ASSERT_THAT(some.functions[0].values, SizeIs(501));
  EXPECT_EQ(some.functions[0].abscissa.front(), 0.2);
  const std::vector<double> velocity = file.series("/channels/beam.tip.y.velocity");
  for (std::size_t i = 0; i < 501; ++i)
    EXPECT_EQ(some.functions[0].values[i].real(), velocity[2000 + i]);
}

TEST_F(RunFunctions, SpectraHaveTheAmplitudesOfTheirPicture) {
  const std::string run = make_run();
  const Json object =
      json_of({"plot", run, "--kind", "spectrum", "--channel", "beam.tip.y.acceleration", "--from",
               "0.2", "--to", "0.2999", "--window", "rectangular", "--length", "0.1 s", "--data",
               path("a.uff"), "--single", "-o", path("a.svg")});
  EXPECT_EQ(object["figure"], path("a.svg"));
  EXPECT_TRUE(exists("a.svg"));
  const UffHoldings all = held(path("a.uff"));
  ASSERT_THAT(all.functions, SizeIs(1));
  const UffFunction& one = all.functions[0];
  EXPECT_EQ(one.type, 12);
  EXPECT_EQ(one.abscissa_quantity, 18);
  EXPECT_EQ(one.ordinate_quantity, 12);
  EXPECT_THAT(one.note,
              HasSubstr("peak amplitudes, r.m.s. of 1 pieces of 1000 samples, rectangular"));
  ASSERT_THAT(one.values, SizeIs(501));
  // A hundred whole periods of amplitude 2: one line, 10 Hz from the next.
  for (std::size_t i = 0; i < 501; ++i) {
    EXPECT_NEAR(one.abscissa[i], 10.0 * static_cast<double>(i), 1e-9);
    EXPECT_NEAR(one.values[i].real(), i == 100 ? 2.0 : 0.0, 1e-5);
  }
}

TEST_F(RunFunctions, PointsAreNodesWhereTheSceneHasThem) {
  const std::string scene = path("mass.yaml");
  std::ofstream(scene) << R"(format: 2
substructures:
  slider:
    type: lumped
    masses: {mass: {mass: 2, at: [0.25, -0.5]}}
    springs: {along: {at: mass, stiffness: 8000}, up: {at: mass, stiffness: 32000, direction: [0, 1]}}
initial: {state: rest, displacement: [{at: slider.mass, x: 1 mm}]}
time: {integrator: exact, step: 1 ms, end: 0.1 s}
record: {interval: 1 ms, channels: [slider.mass.x.displacement, slider.mass.y.velocity]}
)";
  const ProgramResult made = Program({"run", scene, "-o", path("mass.h5")}).run();
  ASSERT_EQ(made.exit_code, 0) << made.err;
  json_of({"plot", path("mass.h5"), "--kind", "history", "--data", path("a.uff")});
  const UffHoldings all = held(path("a.uff"));
  ASSERT_THAT(all.shapes.nodes, SizeIs(1));
  EXPECT_EQ(all.shapes.nodes.at(1), Eigen::Vector3d(0.25, -0.5, 0.0));
  ASSERT_THAT(all.functions, SizeIs(2));
  for (const UffFunction& one : all.functions) {
    EXPECT_EQ(one.response, (UffDof{1, one.id == "slider.mass.x.displacement" ? 1 : 2}));
    if (one.id != "slider.mass.x.displacement") continue;
    // u = u0 cos(ω t), ω² = 8000/2.
    for (std::size_t i = 0; i < one.values.size(); ++i)
      EXPECT_NEAR(one.values[i].real(), 1e-3 * std::cos(std::sqrt(4000.0) * one.abscissa[i]),
                  1e-12);
  }
  // The scene of the run of these tests has no bodies: it says so, and the numbers stay.
  const ProgramResult without =
      Program({"plot", make_run(), "--kind", "history", "--data", path("b.uff")}).run();
  EXPECT_EQ(without.exit_code, 0) << without.err;
  EXPECT_THAT(without.out,
              AllOf(HasSubstr("b.uff"), HasSubstr("places of points are not in the file (2411)")));
  EXPECT_THAT(held(path("b.uff")).shapes.nodes, IsEmpty());
}

TEST_F(RunFunctions, ARunThatWasKilledIsWrittenAsFarAsItHasRows) {
  const std::string file = path("killed.h5");
  RunFileWriter writer(file, Overwrite::no,
                       {.version = "0.1.0",
                        .commit = "",
                        .command = "stridor run scene.yaml",
                        .scene_hash = "",
                        .date = "2024-05-17T08:30:00Z",
                        .scene_text = "format: 2\n",
                        .scene_resolved = "format: 2\n"},
                       {{"/channels/beam.tip.y.acceleration", "m/s^2", SeriesKind::real, {}}});
  for (int i = 0; i < 300; ++i) writer.append(1e-3 * i, std::vector<double>{0.5 * i});
  writer.flush();
  std::filesystem::copy_file(file, path("left.h5"));  // as a kill at this moment leaves it
  json_of({"plot", path("left.h5"), "--kind", "history", "--data", path("a.uff"), "--binary"});
  const UffHoldings all = held(path("a.uff"));
  ASSERT_THAT(all.functions, SizeIs(1));
  ASSERT_THAT(all.functions[0].values, SizeIs(300));
  EXPECT_EQ(all.functions[0].values[299].real(), 149.5);
}

TEST_F(RunFunctions, AValueThatIsNotFiniteLeavesNoFile) {
  const std::string file = path("wrong.h5");
  RunFileWriter writer(file, Overwrite::no,
                       {.version = "0.1.0",
                        .commit = "",
                        .command = "stridor run scene.yaml",
                        .scene_hash = "",
                        .date = "2024-05-17T08:30:00Z",
                        .scene_text = "format: 2\n",
                        .scene_resolved = "format: 2\n"},
                       {{"/channels/beam.tip.y.acceleration", "m/s^2", SeriesKind::real, {}}});
  for (int i = 0; i < 30; ++i)
    writer.append(1e-3 * i, std::vector<double>{i == 20 ? std::nan("") : 1.0});
  writer.close();
  const ProgramResult result =
      Program({"plot", file, "--kind", "history", "--data", path("a.uff")}).run();
  EXPECT_EQ(result.exit_code, 4);
  EXPECT_THAT(result.err, HasSubstr("is not finite at 0.02 s"));
  EXPECT_EQ(std::distance(std::filesystem::directory_iterator(folder_.path()), {}), 1);
}

TEST_F(RunFunctions, RefusalsSayWhatToDo) {
  const std::string run = make_run();
  const auto refused = [&](std::vector<std::string> arguments, const std::string& message) {
    arguments.insert(arguments.begin(), {"plot", run});
    const ProgramResult result = Program(arguments).run();
    EXPECT_EQ(result.exit_code, 2) << result.out;
    EXPECT_THAT(result.err, HasSubstr(message));
  };
  refused({"--kind", "history"},
          "--output: is missing: name a figure, .png, .svg or .pdf, or --data FILE.uff alone");
  refused({"--kind", "phase"}, "--output: is missing: name a figure, .png, .svg or .pdf");
  refused({"--kind", "spectrogram", "--data", path("a.h5")}, "--output: is missing");
  refused({"--kind", "phase", "--data", path("a.uff")}, "--data: means nothing for --kind phase");
  refused({"--kind", "history", "--data", path("a.h5")}, "ends neither in .uff nor in .unv");
  refused({"--kind", "spectrogram", "-o", path("a.png"), "--data", path("a.uff")},
          "holds no spectrograms");
  refused({"--kind", "history", "--single", "-o", path("a.png")},
          "--single: is the form of universal files");
  ASSERT_EQ(Program({"plot", run, "--kind", "history", "--data", path("a.uff")}).run().exit_code,
            0);
  const ProgramResult again =
      Program({"plot", run, "--kind", "history", "--data", path("a.uff")}).run();
  EXPECT_EQ(again.exit_code, 4);
  EXPECT_THAT(again.err, HasSubstr("exists; use --force"));
}

}  // namespace
}  // namespace stridor
