#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "io/all_scenes.hpp"
#include "io/scene.hpp"
#include "io/scene_reader.hpp"
#include "tests/support/message_of.hpp"
#include "tests/support/program.hpp"

namespace stridor {
namespace {

using namespace test;
using ::testing::ElementsAre;
using ::testing::HasSubstr;

TEST(SceneWithoutBodies, IsReadWithTheContactThatItHas) {
  const LoadedScene loaded =
      load_scene(scene_path("viscoelastic_contact.yaml"), {"contacts.tip.normal.solver.grid=64"});
  const NormalParameters& normal = loaded.scene.model.contacts.at("tip").normal;
  EXPECT_TRUE(normal.is_solved());
  EXPECT_EQ(normal.solver->grid, 64);
  EXPECT_DOUBLE_EQ(normal.material->modulus_ratio(), 0.1);
  EXPECT_THAT(normal.material->creep_times, ElementsAre(0.01));
  EXPECT_DOUBLE_EQ(normal.tip_radius(), 0.01);
  // It reads back from its resolved form.
  const Scene again = read_as<Scene>(read_scene_text(loaded.resolved(), "again"));
  EXPECT_EQ(again.sliding->speeds, loaded.scene.sliding->speeds);
  EXPECT_EQ(loaded.hash().size(), 16u);
}

TEST(SceneWithoutBodies, HasAContact) {
  const std::string says =
      message_of<ConfigError>([] { (void)read_as<Scene>(read_scene_text("format: 1", "a")); });
  EXPECT_THAT(says, HasSubstr("substructures: is missing: there is nothing to move"));
}

TEST(SlidingPoints, AreEitherLoadsOrIndentations) {
  const std::string says = message_of<ConfigError>(
      [] { (void)load_scene(scene_path("viscoelastic_contact.yaml"), {"sliding.loads=[1]"}); });
  EXPECT_THAT(says, HasSubstr("sliding.loads: cannot stand beside `indentations`"));
}

TEST(AllScenes, JsonSchemaChoosesByTheSections) {
  const auto schema = nlohmann::json::parse(all_scenes_json_schema());
  EXPECT_EQ(schema["then"]["$ref"], "#/$defs/disc_and_pads");
  EXPECT_EQ(schema["else"]["$ref"], "#/$defs/scene");
  EXPECT_EQ(schema["if"]["anyOf"][0]["required"][0], "disc");
  const auto& keys = schema["$defs"]["scene"];
  EXPECT_EQ(keys["additionalProperties"], false);
  EXPECT_TRUE(keys["properties"].contains("substructures"));
  EXPECT_TRUE(keys["properties"].contains("sliding"));
  EXPECT_TRUE(schema["$defs"]["normal"]["properties"].contains("material"));
  EXPECT_THAT(all_scenes_reference(), HasSubstr("## disc_and_pads"));
}

}  // namespace
}  // namespace stridor
