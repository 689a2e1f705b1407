#include "io/contact_scene.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "io/scene_reader.hpp"
#include "tests/support/message_of.hpp"
#include "tests/support/program.hpp"

namespace stridor {
namespace {

using namespace test;
using ::testing::ElementsAre;
using ::testing::HasSubstr;

TEST(ContactScene, ReadsTheShippedScene) {
  const LoadedContactScene loaded =
      load_contact_scene(scene_path("viscoelastic_contact.yaml"), {"contact_solver.grid=64"});
  EXPECT_EQ(loaded.scene.contact_solver.grid, 64);
  EXPECT_DOUBLE_EQ(loaded.scene.material.modulus_ratio(), 0.1);
  EXPECT_THAT(loaded.scene.material.creep_times, ElementsAre(0.01));
  EXPECT_DOUBLE_EQ(loaded.scene.profile.radius, 0.01);
  // It reads back from its resolved form.
  const ContactScene again = read_as<ContactScene>(read_scene_text(loaded.resolved(), "again"));
  EXPECT_EQ(again.sliding.speeds, loaded.scene.sliding.speeds);
  EXPECT_EQ(loaded.hash().size(), 16u);
}

TEST(ContactScene, SpeedsAreInRadiiPerFirstCreepTime) {
  ContactScene scene;
  scene.material.rubbery_modulus = 1.0;
  scene.material.glassy_modulus = 5.0;
  scene.material.creep_times = {0.1, 1.0};
  scene.material.creep_shares = {0.25, 0.75};
  scene.profile.radius = 2.0;
  const CreepLengths lengths = creep_lengths(scene, 3.0);
  ASSERT_EQ(lengths.size(), 2u);
  EXPECT_DOUBLE_EQ(lengths[0].share, 0.2);
  EXPECT_DOUBLE_EQ(lengths[0].length, 6.0);
  EXPECT_DOUBLE_EQ(lengths[1].share, 0.6);
  EXPECT_DOUBLE_EQ(lengths[1].length, 60.0);
}

TEST(ContactScene, IsToldFromAScenesOfBodies) {
  EXPECT_TRUE(is_contact_scene(read_scene_text("profile: {}", "a")));
  EXPECT_TRUE(is_contact_scene(read_scene_text("contact_solver: {}", "a")));
  EXPECT_FALSE(is_contact_scene(read_scene_text("time: {}", "a")));
  EXPECT_FALSE(is_contact_scene(read_scene_text("profile: {}\nsubstructures: {}", "a")));
}

TEST(ContactScene, EitherLoadsOrIndentations) {
  const std::string says = message_of<ConfigError>([] {
    (void)load_contact_scene(scene_path("viscoelastic_contact.yaml"), {"sliding.loads=[1]"});
  });
  EXPECT_THAT(says, HasSubstr("sliding.loads: cannot stand beside `indentations`"));
}

TEST(ContactScene, JsonSchemaChoosesByTheSections) {
  const auto schema = nlohmann::json::parse(all_scenes_json_schema());
  EXPECT_EQ(schema["then"]["$ref"], "#/$defs/viscoelastic_contact");
  const auto& others = schema["else"];
  EXPECT_EQ(others["then"]["$ref"], "#/$defs/disc_and_pads");
  EXPECT_EQ(others["else"]["$ref"], "#/$defs/scene");
  EXPECT_EQ(schema["if"]["anyOf"][0]["required"][0], "profile");
  const auto& keys = schema["$defs"]["viscoelastic_contact"];
  EXPECT_EQ(keys["additionalProperties"], false);
  EXPECT_TRUE(keys["properties"].contains("material"));
  EXPECT_TRUE(schema["$defs"]["scene"]["properties"].contains("substructures"));
  EXPECT_THAT(all_scenes_reference(), HasSubstr("## viscoelastic_contact"));
}

}  // namespace
}  // namespace stridor
