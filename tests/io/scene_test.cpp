#include "io/scene/scene.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "core/errors.hpp"
#include "io/scene/scene_reader.hpp"
#include "substructures/bodies/beam.hpp"
#include "tests/support/program.hpp"

namespace stridor {
namespace {

using namespace test;
using ::testing::HasSubstr;

TEST(Scene, MainSceneHoldsThePublishedModel) {
  const Scene scene = load_scene(scene_path("beam_on_beam.yaml"), {}).scene;
  const auto& oblique = scene.model.substructures.at("oblique").get<BeamParameters>();
  EXPECT_DOUBLE_EQ(oblique.length, 0.075);
  EXPECT_NEAR(oblique.angle, 0.52359877559829887, 1e-15);
  EXPECT_DOUBLE_EQ(oblique.material.youngs_modulus, 71e9);
  EXPECT_EQ(oblique.supports.end, Support::guided);
  EXPECT_EQ(*oblique.damping.alpha_start, 40.0);
  EXPECT_EQ(scene.model.contact->assumption, ContactAssumption::subs_b);
  EXPECT_DOUBLE_EQ(scene.model.contact->start.along.value(), 0.030);
  EXPECT_DOUBLE_EQ(scene.measure.band.at(0), 2500.0);
  EXPECT_EQ(scene.time->step, 2e-7);
}

TEST(Scene, ResolvedSceneReadsBackToTheSameSceneAndHash) {
  const LoadedScene loaded = load_scene(scene_path("beam_on_beam_leading.yaml"), {});
  const TemporaryFolder folder;
  write_file(folder / "resolved.yaml", loaded.resolved());
  const LoadedScene again = load_scene((folder / "resolved.yaml").string(), {});
  EXPECT_EQ(again.resolved(), loaded.resolved());
  EXPECT_EQ(again.hash(), loaded.hash());
  EXPECT_EQ(loaded.hash().size(), 16u);
}

TEST(Scene, HashChangesWithAnyKey) {
  const std::string hash = load_scene(scene_path("beam_on_beam.yaml"), {}).hash();
  EXPECT_NE(
      load_scene(scene_path("beam_on_beam.yaml"), {"contact.friction.coefficient=0.31"}).hash(),
      hash);
  EXPECT_EQ(
      load_scene(scene_path("beam_on_beam.yaml"), {"contact.friction.coefficient=0.3"}).hash(),
      hash);
}

TEST(Scene, ErrorsOfTheModelAreGivenTheirPlaceInTheFile) {
  const TemporaryFolder folder;
  std::string text = contents_of(scene_path("beam_on_beam.yaml"));
  text.replace(text.find("start: 30 mm"), 12, "start: 300 mm");
  write_file(folder / "off.yaml", text);
  try {
    build_model(load_scene((folder / "off.yaml").string(), {}));
    FAIL() << "not refused";
  } catch (const ConfigError& error) {
    EXPECT_THAT(error.what(), HasSubstr("off.yaml:38:10: contact.start: 0.3 m is off the master"));
  }
}

std::string refusal_of_drives(const std::vector<std::string>& sets) {
  try {
    build_model(load_scene(scene_path("examples/opposite_drives.yaml"), sets));
  } catch (const ConfigError& error) {
    return error.what();
  }
  return "not refused";
}

TEST(Scene, DrivesAreReadByName) {
  const LoadedScene loaded = load_scene(scene_path("examples/opposite_drives.yaml"), {});
  const std::vector<SceneDrive> drives = loaded.scene.model.scene_drives();
  ASSERT_EQ(drives.size(), 3);
  EXPECT_EQ(drives[0].key, "drives.belt");
  EXPECT_EQ(drives[0].parameters.velocity.value(0.0), -0.2);
  EXPECT_EQ(drives[1].parameters.moves, std::vector<std::string>{"slider"});
  EXPECT_EQ(drives[2].parameters.displacement.value(0.0), -0.05);
  const Model model = build_model(loaded);
  ASSERT_EQ(model.system.drives.size(), 3);
  EXPECT_EQ(model.system.bodies[0].drive, 1);
  EXPECT_EQ(model.system.bodies[1].drive, 0);
  EXPECT_EQ(model.system.bodies[1].name, "moving rigid of belt");
  ASSERT_EQ(model.system.bodies[0].loads.size(), 1);
  EXPECT_EQ(model.system.bodies[0].loads[0].drive, 2);
}

TEST(Scene, DrivesAreRefusedWithTheirKeys) {
  EXPECT_THAT(refusal_of_drives({"drive={velocity: 1, load: 0, ramp: 0}"}),
              HasSubstr("drives: give either `drive` (one) or `drives` (several), not both"));
  EXPECT_THAT(refusal_of_drives({"drives.idle={ramp: 0}"}),
              HasSubstr("drives.idle: does nothing: give velocity, load or displacement"));
  EXPECT_THAT(refusal_of_drives({"drives.lift={displacement: 1 mm, ramp: 0}"}),
              HasSubstr("drives.lift.displaces: is missing: name the springs"));
  EXPECT_THAT(refusal_of_drives({"drives.belt.velocty=1"}), HasSubstr("did you mean 'velocity'?"));
  EXPECT_THAT(refusal_of_drives({"drives.belt.moves=slidr"}),
              HasSubstr("drives.belt.moves.0: there is no 'slidr' to move, did you mean 'slider'?"));
  EXPECT_THAT(refusal_of_drives({"drives.piston.displaces=slider.puling"}),
              HasSubstr("drives.piston.displaces.0: 'slider' has no spring to ground 'puling', did "
                        "you mean 'pulling'?"));
  EXPECT_THAT(refusal_of_drives({"drives.piston.displaces=slider.pulling"}),
              HasSubstr("'slider.pulling' exerts nothing when its ground end moves in y"));
}

TEST(Scene, EnergyIsRecordedWhereAskedFor) {
  EXPECT_FALSE(load_scene(scene_path("beam_on_beam.yaml"), {}).scene.record->energy);
  EXPECT_TRUE(
      load_scene(scene_path("beam_on_beam.yaml"), {"record.energy=true"}).scene.record->energy);
}

TEST(Scene, RecordsAtMostEveryHundredThousandthStepHoweverTheQuotientRounds) {
  ASSERT_GT(0.2 / 2e-6, 1e5);
  const std::vector<std::string> sets{"time.step=2e-6", "measure.from=0", "measure.band=[]"};
  const auto with_interval = [&](const char* interval) {
    std::vector<std::string> all = sets;
    all.push_back(std::string("record.interval=") + interval);
    return load_scene(scene_path("beam_on_beam.yaml"), all).scene.record->interval;
  };
  EXPECT_EQ(with_interval("0.2"), 0.2);
  try {
    with_interval("0.200002");
    FAIL() << "not refused";
  } catch (const ConfigError& error) {
    EXPECT_THAT(error.what(), HasSubstr("is 100001 of it; the nearest is 0.2 s"));
  }
}

TEST(Scene, SceneWithoutRecordIsAllowed) {
  const TemporaryFolder folder;
  std::string text = contents_of(scene_path("beam_on_beam.yaml"));
  const std::size_t record = text.find("record:");
  text.erase(record, text.find("measure:") - record);
  write_file(folder / "quiet.yaml", text);
  EXPECT_FALSE(load_scene((folder / "quiet.yaml").string(), {}).scene.record.has_value());
}

}  // namespace
}  // namespace stridor
