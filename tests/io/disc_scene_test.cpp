#include "io/disc_scene.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "core/errors.hpp"
#include "io/scene.hpp"
#include "tests/support/message_of.hpp"
#include "tests/support/program.hpp"

namespace stridor {
namespace {

using test::message_of;
using test::scene_path;
using ::testing::HasSubstr;

TEST(DiscScene, ReadsTheReferenceBrake) {
  const LoadedDiscScene loaded = load_disc_scene(scene_path("disc_and_pads.yaml"), {});
  const DiscModel model = loaded.model();
  EXPECT_EQ(model.system.size(), 19);
  EXPECT_EQ(model.system.gaps.rows(), 2);
  EXPECT_NEAR(model.highest_frequency, 7494.83, 0.01);
  // A resolved scene reads back as the same.
  const LoadedDiscScene again = load_resolved_disc_scene(loaded.resolved(), "resolved");
  EXPECT_EQ(again.model().system.position, model.system.position);
}

TEST(DiscScene, SaysWhatDoesNotFit) {
  const auto failure = [](const std::vector<std::string>& sets) {
    return message_of<ConfigError>(
        [&] { load_disc_scene(scene_path("disc_and_pads.yaml"), sets); });
  };
  EXPECT_THAT(failure({"terms=[gyro]"}),
              HasSubstr("there is no term 'gyro', did you mean 'gyroscopic'?"));
  EXPECT_THAT(failure({"disc.speed=0"}),
              HasSubstr("disc.speed: must be positive with the term friction_damping"));
  EXPECT_THAT(failure({"pads.radius=0.2"}), HasSubstr("pads.radius: must lie between"));
  EXPECT_THAT(failure({"disc.outer_radius=0.05"}),
              HasSubstr("disc.outer_radius: must be larger than inner_radius"));
  EXPECT_THAT(failure({"disc.radial_modes=9"}),
              HasSubstr("disc.radial_modes: must not exceed radial_terms = 8"));
  EXPECT_THAT(failure({"pads.stiffness.coupling=1e8"}),
              HasSubstr("must be smaller than the geometric mean"));
  EXPECT_THAT(message_of<ConfigError>([] { load_scene(scene_path("disc_and_pads.yaml"), {}); }),
              HasSubstr("disc: belongs to a scene of a disc and pads"));
}

}  // namespace
}  // namespace stridor
