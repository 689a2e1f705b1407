// Pictures of scenes before anything is run, and files for ParaView.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <nlohmann/json.hpp>

#include "tests/support/program.hpp"

namespace stridor::test {
namespace {

namespace fs = std::filesystem;
using ::testing::AllOf;
using ::testing::HasSubstr;

fs::path scenes() { return fs::path(STRIDOR_SOURCE_DIR) / "scenes"; }

TEST(Draw, EveryScene) {
  const TemporaryFolder folder;
  int number = 0;
  for (const char* below : {".", "examples"}) {
    for (const auto& entry : fs::directory_iterator(scenes() / below)) {
      if (entry.path().extension() != ".yaml") continue;
      const fs::path figure = folder / (std::to_string(++number) + ".svg");
      const ProgramResult result =
          Program({"draw", entry.path().string(), "-o", figure.string()}).run();
      if (entry.path().filename() == "viscoelastic_contact.yaml") {
        EXPECT_EQ(result.exit_code, 2);
        EXPECT_THAT(result.err, HasSubstr("without bodies there is nothing to draw"));
        continue;
      }
      // It begins with a run file that another scene makes.
      if (entry.path().filename() == "continued.yaml") continue;
      ASSERT_EQ(result.exit_code, 0) << entry.path() << result.err;
      EXPECT_THAT(contents_of(figure), HasSubstr("scene")) << entry.path();
      EXPECT_THAT(contents_of(figure), HasSubstr("at rest, where"))
          << entry.path();
    }
  }
  EXPECT_GT(number, 25);
}

TEST(Draw, SpringsAreSeen) {
  const TemporaryFolder folder;
  const fs::path figure = folder / "a.svg";
  const auto names_spring = [&](const char* scene) {
    const ProgramResult result =
        Program({"draw", (scenes() / scene).string(), "-o", figure.string(), "--force"}).run();
    EXPECT_EQ(result.exit_code, 0) << result.err;
    return contents_of(figure).find("spring") != std::string::npos;
  };
  EXPECT_TRUE(names_spring("examples/mass_on_belt.yaml"));
  EXPECT_FALSE(names_spring("beam_on_beam.yaml"));
}

TEST(Draw, TellsPlacesInTheUnitOfTheScene) {
  const TemporaryFolder folder;
  for (const char* name : {"a.png", "a.pdf"}) {
    const fs::path figure = folder / name;
    const ProgramResult result = Program({"draw", (scenes() / "examples/bracket.yaml").string(),
                                          "-o", figure.string(), "--json"})
                                     .run();
    ASSERT_EQ(result.exit_code, 0) << result.err;
    const auto told = nlohmann::json::parse(result.out);
    EXPECT_EQ(told["unit"], "mm");
    EXPECT_EQ(told["view"], "plane");
    bool names_toe = false;
    for (const auto& one : told["names"])
      names_toe = names_toe || one["name"].get<std::string>().find("bracket.toe") != std::string::npos;
    EXPECT_TRUE(names_toe) << told;
    EXPECT_GT(fs::file_size(figure), 5000u);
  }
  const ProgramResult again = Program({"draw", (scenes() / "examples/bracket.yaml").string(), "-o",
                                       (folder / "a.png").string()})
                                  .run();
  EXPECT_EQ(again.exit_code, 4);
}

TEST(Draw, SpinningPlatesAreSeenFromAbove) {
  const TemporaryFolder folder;
  const ProgramResult result = Program({"draw", (scenes() / "disc_and_pads.yaml").string(), "-o",
                                        (folder / "a.svg").string(), "--json"})
                                   .run();
  ASSERT_EQ(result.exit_code, 0) << result.err;
  EXPECT_EQ(nlohmann::json::parse(result.out)["view"], "isometric");
  EXPECT_THAT(contents_of(folder / "a.svg"), HasSubstr("slave point"));
}

/// A scene with points of its own.
std::string with_points(const std::string& points) {
  std::string text = contents_of(scenes() / "beam_on_beam.yaml");
  return text + "\npoints:\n" + points;
}

TEST(ScenePoints, WithinAnElementOnANodeOrRefusedWithTheDistance) {
  const TemporaryFolder folder;
  const fs::path scene = folder / "scene.yaml";
  const auto draw = [&](const std::string& points) {
    write_file(scene, with_points(points));
    return Program({"draw", scene.string(), "-o", (folder / "a.svg").string(), "--force"}).run();
  };
  ProgramResult result = draw("  probe: {at: [60.4 mm, -0.3 mm], of: cantilever}\n");
  ASSERT_EQ(result.exit_code, 0) << result.err;
  EXPECT_THAT(contents_of(folder / "a.svg"), HasSubstr("probe"));
  result = draw("  probe: {at: [31.4 mm, 40 mm], of: cantilever}\n");
  EXPECT_EQ(result.exit_code, 2);
  EXPECT_THAT(result.err, AllOf(HasSubstr("points.probe.at"), HasSubstr("is not on 'cantilever'"),
                                HasSubstr("m away")));
  result = draw("  probe: {at: [31.4 mm, 40 mm], of: cantilever, tolerance: 50 mm}\n");
  EXPECT_EQ(result.exit_code, 0) << result.err;
  result = draw("  probe: {at: [31.4 mm, 40 mm], of: cantilver}\n");
  EXPECT_THAT(result.err, HasSubstr("did you mean 'cantilever'"));
  result = draw("  free_end: {at: [31.4 mm, -1 mm], of: cantilever}\n");
  EXPECT_THAT(result.err, HasSubstr("has a point or surface of this name"));
  result = draw("  probe: {at: [31.4 mm], of: cantilever}\n");
  EXPECT_THAT(result.err, HasSubstr("must have two or three numbers"));
}

TEST(RunFrames, HoldTheShapesOverTimeAndGoOnWithAResumedRun) {
  const TemporaryFolder folder;
  const std::string scene = (scenes() / "examples/ruler.yaml").string();
  const fs::path shapes = folder / "shapes";
  const auto run = [&](std::vector<std::string> more) {
    std::vector<std::string> all{"run", scene, "-o", (folder / "a.h5").string(), "--force"};
    all.insert(all.end(), more.begin(), more.end());
    return Program(all).run();
  };
  ProgramResult result = run({"--vtu-interval", "1 ms"});
  EXPECT_EQ(result.exit_code, 2);
  EXPECT_THAT(result.err, HasSubstr("--vtu FOLDER"));
  result = run({"--vtu", shapes.string(), "--vtu-interval", "1 ns"});
  EXPECT_EQ(result.exit_code, 2);
  result = run({"--vtu", shapes.string()});
  ASSERT_EQ(result.exit_code, 0) << result.err;
  EXPECT_THAT(contents_of(shapes / "run.pvd"),
              AllOf(HasSubstr("frame_00000.vtu"), HasSubstr("frame_00100.vtu")));
  EXPECT_THAT(contents_of(shapes / "frame_00050.vtu"), HasSubstr("Name=\"displacement\""));
  EXPECT_NE(contents_of(shapes / "frame_00050.vtu"), contents_of(shapes / "frame_00051.vtu"));
  // Frames change nothing of the run.
  const std::string with = Program({"info", (folder / "a.h5").string(), "--json"}).run().out;
  ASSERT_EQ(run({}).exit_code, 0);
  const std::string without = Program({"info", (folder / "a.h5").string(), "--json"}).run().out;
  const auto force = [](const std::string& text) { return nlohmann::json::parse(text)["results"]; };
  EXPECT_EQ(force(with)["contact_force"], force(without)["contact_force"]);
}

}  // namespace
}  // namespace stridor::test
