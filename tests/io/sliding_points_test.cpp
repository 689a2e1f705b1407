#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "io/scene/scene.hpp"
#include "io/scene/scene_reader.hpp"
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
      message_of<ConfigError>([] { (void)read_as<Scene>(read_scene_text("format: 2", "a")); });
  EXPECT_THAT(says, HasSubstr("substructures: is missing: there is nothing to move"));
}

TEST(SlidingPoints, AreEitherLoadsOrIndentations) {
  const std::string says = message_of<ConfigError>(
      [] { (void)load_scene(scene_path("viscoelastic_contact.yaml"), {"sliding.loads=[1]"}); });
  EXPECT_THAT(says, HasSubstr("sliding.loads: cannot stand beside `indentations`"));
}

}  // namespace
}  // namespace stridor
