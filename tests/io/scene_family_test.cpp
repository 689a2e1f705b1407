#include "io/scene/scene_family.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <numeric>

#include "io/scene/assignment.hpp"
#include "solvers/equilibrium/linearise.hpp"
#include "tests/support/message_of.hpp"
#include "tests/support/program.hpp"

namespace stridor {
namespace {

using namespace test;
using ::testing::HasSubstr;

/// The main scene on coarser meshes.
LoadedScene small_scene() {
  return load_scene(scene_path("beam_on_beam.yaml"),
                    {"substructures.oblique.mesh.along=6", "substructures.cantilever.mesh.along=10",
                     "substructures.cantilever.interface.spacing=0.005",
                     "substructures.oblique.reduction.fixed_interface_modes=4",
                     "substructures.cantilever.reduction.fixed_interface_modes=4"});
}

NumericKey key_at(const std::string& path) {
  return find_numeric_key(small_scene().scene, path, "--parameter");
}

/// Eigenvalue problem about the undeformed geometry.
Pencil pencil_of(const SceneFamily::Member& member) {
  const System& system = member.model->system;
  return linearise(system, find_equilibrium(system, sliding_state(system, member.drive_displacement,
                                                                  ContactGeometry::undeformed)));
}

TEST(NumericKey, IsFoundWithItsUnitAndRange) {
  const NumericKey start = key_at("contact.start");
  EXPECT_EQ(start.unit, "m");
  EXPECT_FALSE(start.is_integer);
  EXPECT_FALSE(start.range.contains(-1.0));
  EXPECT_TRUE(key_at("substructures.oblique.mesh.along").is_integer);
  EXPECT_EQ(key_at("drive.load").unit, "N");  // a curve
  EXPECT_EQ(key_at("contact.armed_from").unit, "s");
  // Not written in the scene.
  EXPECT_EQ(key_at("contact.friction.decay_velocity").unit, "m s-1");
}

TEST(NumericKey, WhatIsNoNumberIsRefused) {
  const auto message = [](const std::string& path) {
    return message_of<ConfigError>([&] { key_at(path); });
  };
  EXPECT_THAT(message("contact.stat"), HasSubstr("--parameter: 'contact.stat': there is no key "
                                                 "'stat' in 'contact', did you mean 'start'?"));
  EXPECT_THAT(message("cntact.start"), HasSubstr("there is no key 'cntact', did you mean"));
  EXPECT_THAT(message("substructures.beam.length"),
              HasSubstr("there is no key 'beam' in 'substructures'; known there: cantilever, "
                        "oblique"));
  EXPECT_THAT(message("substructures"), HasSubstr("there is no key '' in 'substructures'"));
  EXPECT_THAT(message("substructures.oblique"),
              HasSubstr("'substructures.oblique' is a section; name one of its numbers (length"));
  EXPECT_THAT(message("contact"), HasSubstr("'contact' is a section"));
  EXPECT_THAT(message("contact.master"), HasSubstr("no number that could be varied, but a text"));
  EXPECT_THAT(message("contact.start.x"), HasSubstr("there is no key 'x' in 'contact.start'"));
  EXPECT_THAT(message("measure.band"), HasSubstr("no number that could be varied"));
  EXPECT_THAT(message(""), HasSubstr("there is no key ''"));
}

TEST(NumericKey, ValuesMayCarryAUnit) {
  const NumericKey start = key_at("contact.start");
  EXPECT_DOUBLE_EQ(parse_value(start, "30 mm", "--from"), 0.03);
  EXPECT_DOUBLE_EQ(parse_value(start, "0.03", "--from"), 0.03);
  EXPECT_THAT(message_of<ConfigError>([&] { parse_value(start, "30 kg", "--from"); }),
              HasSubstr("--from: "));
  EXPECT_THAT(message_of<ConfigError>([&] { parse_value(start, "-1", "--to"); }),
              HasSubstr("--to: contact.start must be >= 0 m, got '-1'"));
  EXPECT_THAT(message_of<ConfigError>(
                  [] { parse_value(key_at("substructures.oblique.mesh.along"), "2.5", "--to"); }),
              HasSubstr("--to: '2.5' must be a whole number, as substructures.oblique.mesh.along"));
}

TEST(SpacedValues, HoldBothEndsExactly) {
  const NumericKey start = key_at("contact.start");
  const auto linear = spaced_values(start, 0.03, 0.098, 4, Spacing::linear);
  ASSERT_EQ(linear.size(), 4u);
  EXPECT_EQ(linear.front(), 0.03);
  EXPECT_EQ(linear.back(), 0.098);
  EXPECT_DOUBLE_EQ(linear[1] - linear[0], linear[3] - linear[2]);
  const auto logarithmic = spaced_values(start, 1e-3, 0.1, 3, Spacing::logarithmic);
  EXPECT_NEAR(logarithmic[1], 1e-2, 1e-16);
  EXPECT_EQ(spaced_values(start, 0.05, 0.05, 1, Spacing::linear), std::vector<double>{0.05});
  EXPECT_EQ(spaced_values(key_at("substructures.oblique.mesh.along"), 2, 6, 3, Spacing::linear),
            (std::vector<double>{2, 4, 6}));
}

TEST(SpacedValues, WholeNumbersAreWholeWhateverTheRoundingOfTheirSpacing) {
  const NumericKey along = key_at("substructures.oblique.mesh.along");
  for (int last = 3; last <= 60; ++last) {
    std::vector<double> all(static_cast<std::size_t>(last));
    std::iota(all.begin(), all.end(), 1.0);
    EXPECT_EQ(spaced_values(along, 1, last, last, Spacing::linear), all);
  }
  EXPECT_EQ(spaced_values(along, 1, 1000, 4, Spacing::logarithmic),
            (std::vector<double>{1, 10, 100, 1000}));
}

TEST(SpacedValues, WhatDoesNotFitIsRefused) {
  const NumericKey start = key_at("contact.start");
  EXPECT_THAT(message_of<ConfigError>([&] { spaced_values(start, 0, 1, 0, Spacing::linear); }),
              HasSubstr("--points: must be at least 1"));
  EXPECT_THAT(message_of<ConfigError>([&] { spaced_values(start, 0, 1, 1, Spacing::linear); }),
              HasSubstr("1 point is enough only where both ends"));
  EXPECT_THAT(message_of<ConfigError>([&] { spaced_values(start, 0, 1, 3, Spacing::logarithmic); }),
              HasSubstr("--scale: a logarithmic scale needs positive values of contact.start"));
  EXPECT_THAT(message_of<ConfigError>([] {
                spaced_values(key_at("substructures.oblique.mesh.along"), 2, 5, 3, Spacing::linear);
              }),
              HasSubstr("not whole numbers, as substructures.oblique.mesh.along is; 4 points"));
}

TEST(SceneFamily, PositionIsReachedByTheDriveAsByTheScene) {
  SceneFamily family(small_scene(), {key_at("contact.start")});
  for (const double start : {0.03, 0.0431, 0.0999}) {
    const SceneFamily::Member member = family.at(std::array{start});
    EXPECT_NEAR(member.drive_displacement, start - 0.03, 1e-15);
    const Pencil moved = pencil_of(member);
    LoadedScene scene = small_scene();
    set_value(scene.tree, "contact.start=" + std::to_string(start));
    scene.scene.model.contact->start = start;
    const Model built = build_model(scene);
    const Pencil expected = pencil_of({&built, 0.0, std::nullopt});
    EXPECT_EQ(member.position, start);
    EXPECT_LT((moved.ports - expected.ports).cwiseAbs().maxCoeff(), 1e-12);
    EXPECT_LT((moved.equilibrium - expected.equilibrium).cwiseAbs().maxCoeff(), 1e-10) << start;
  }
  EXPECT_EQ(family.cache().num_reductions(), 2);
}

TEST(SceneFamily, OtherKeysAreSetInTheScene) {
  SceneFamily family(small_scene(), {key_at("contact.friction.coefficient"),
                                     key_at("substructures.oblique.thickness")});
  const Model* model = family.at(std::array{0.4, 0.002}).model;
  EXPECT_EQ(model->system.contacts[0].friction.dynamic_coefficient, 0.4);
  EXPECT_EQ(family.cache().num_reductions(), 2);
  family.at(std::array{0.1, 0.002});
  EXPECT_EQ(family.cache().num_reductions(), 2);
  family.at(std::array{0.1, 0.0021});
  EXPECT_EQ(family.cache().num_reductions(), 3);
}

TEST(SceneFamily, WhatDoesNotFitIsRefusedWithTheValue) {
  SceneFamily family(small_scene(), {key_at("contact.start")});
  EXPECT_THAT(message_of<ConfigError>([&] { family.at(std::array{0.2}); }),
              HasSubstr("contact.start=0.2: contact.start: 0.2 m is off the master"));
  EXPECT_THAT(message_of<std::invalid_argument>([&] {
                family.at(std::array{0.1, 0.2});
              }),
              HasSubstr("SceneFamily: 2 values for 1 keys"));
  // And goes on.
  EXPECT_NEAR(family.at(std::array{0.04}).drive_displacement, 0.01, 1e-15);
}

}  // namespace
}  // namespace stridor
