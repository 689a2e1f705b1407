#include "app/stability/axis_units.hpp"

#include <gtest/gtest.h>

#include "io/scene/scene_tree.hpp"

namespace stridor {
namespace {

TEST(AxisUnits, AreThoseOfTheCommandLineThenOfTheSceneThenOfTheSi) {
  const NumericKey start{"contact.start", "m", Range::any(), false};
  SceneNode scene;
  scene.kind = SceneNode::Kind::map;
  scene.entries.push_back({"contact", {}, {}});
  SceneNode& contact = scene.entries.back().value;
  contact.kind = SceneNode::Kind::map;
  contact.entries.push_back({"start", {}, {}});
  contact.entries.back().value.kind = SceneNode::Kind::scalar;
  contact.entries.back().value.text = "3 cm";

  const AxisUnit written = axis_unit(start, {"30mm", "98 mm"}, &scene);
  EXPECT_EQ(written.name, "mm");
  EXPECT_NEAR(written.number(0.03), 30.0, 1e-12);
  EXPECT_EQ(axis_unit(start, {"0.03", ""}, &scene).name, "cm");
  EXPECT_EQ(axis_unit(start, {"0.03", "0.04"}, nullptr).name, "m");
  const NumericKey angle{"angle", "rad", Range::any(), false};
  EXPECT_EQ(axis_unit(angle, {"150 deg"}, nullptr).name, "deg");
  const NumericKey friction{"contact.friction.coefficient", "", Range::any(), false};
  EXPECT_EQ(axis_unit(friction, {"0.1"}, &scene).name, "1");
}

}  // namespace
}  // namespace stridor
