#include "io/scene/scene_mechanics.hpp"

#include <gtest/gtest.h>

#include "io/scene/scene.hpp"

namespace stridor {
namespace {

SceneInFile beams_with(const std::vector<std::string>& sets) {
  const LoadedScene loaded = load_scene(std::string(STRIDOR_SOURCE_DIR) + "/scenes/beam_on_beam.yaml", sets);
  return {loaded.hash(), loaded.resolved()};
}

TEST(SceneMechanics, DoNotDependOnWhatIsRecordedMeasuredOrStepped) {
  const SceneInFile given = beams_with({});
  for (const std::vector<std::string>& sets :
       std::vector<std::vector<std::string>>{{},
                                             {"record.interval=20us"},
                                             {"time.end=1", "time.integrator=exact"},
                                             {"measure.band=[1kHz, 5kHz]", "measure.from=0.2"},
                                             {"initial.state=equilibrium"},
                                             {"checkpoint.every=10s"}})
    EXPECT_TRUE(has_same_mechanics(given, beams_with(sets))) << ::testing::PrintToString(sets);
}

TEST(SceneMechanics, DependOnBodiesContactsAndDrives) {
  const SceneInFile given = beams_with({});
  for (const char* set : {"contact.friction.coefficient=0.2", "drive.load=-0.3",
                          "substructures.cantilever.thickness=2.1mm", "contact.start=31mm"})
    EXPECT_FALSE(has_same_mechanics(given, beams_with({set}))) << set;
}

TEST(SceneMechanics, OfEqualTextAndOtherHashHaveOtherFiles) {
  SceneInFile given = beams_with({});
  const SceneInFile same = given;
  given.hash = "0";
  EXPECT_FALSE(has_same_mechanics(given, same));
}

}  // namespace
}  // namespace stridor
