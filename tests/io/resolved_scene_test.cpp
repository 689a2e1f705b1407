#include "io/scene/resolved_scene.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <bit>
#include <cmath>
#include <limits>
#include <random>
#include <string>

#include "io/scene/scene_reader.hpp"
#include "io/scene/scene_tree.hpp"
#include "tests/io/example_scene.hpp"

namespace stridor {
namespace {

using test::Example;

Example example() {
  return read_as<Example>(read_scene_text(test::kExampleText, "s.yaml"));
}

Example read_back(const Example& scene) {
  return read_as<Example>(read_scene_text(resolved_yaml(scene), "resolved"));
}

TEST(ResolvedScene, IsWrittenInTheOrderOfDeclaration) {
  EXPECT_EQ(resolved_yaml(example()), R"(format: 2
title: squeal
scheme: exact
band: [2500, 15000]
velocity: 0.03
load: {times: [0, 0.1], values: [0, -0.2]}
bodies:
  oblique:
    type: beam
    length: 0.075
    angle: 0.5235987755982988
    elements: 37
    modes: 20
    material:
      youngs_modulus: 71000000000
      poissons_ratio: 0.33
  tip:
    type: lumped
    mass: 0.002
materials:
  steel:
    youngs_modulus: 210000000000
    poissons_ratio: 0.3
friction:
  coefficient: 0.3
  decay_velocity: 0.01
expect:
  - result: force.min
    value: 0.19751
  - result: force.max
    value: 0.21
energy: false
channels: [force, tip.y]
)");
}

TEST(ResolvedScene, HoldsDefaultsAndLeavesOutAbsentOptionals) {
  const auto scene =
      read_as<Example>(read_scene_text("format: 2\nvelocity: 1\nbodies: {}\n", "s.yaml"));
  EXPECT_EQ(resolved_yaml(scene), R"(format: 2
title: ""
scheme: central
band: []
velocity: 1
bodies: {}
materials: {}
expect: []
energy: true
channels: [force]
)");
  EXPECT_EQ(read_back(scene), scene);
}

TEST(ResolvedScene, ReadsBackIntoTheSameStruct) {
  EXPECT_EQ(read_back(example()), example());
}

TEST(ResolvedScene, ResolvingTwiceChangesNothing) {
  const std::string once = resolved_yaml(example());
  EXPECT_EQ(resolved_yaml(read_as<Example>(read_scene_text(once, "resolved"))), once);
}

TEST(ResolvedScene, NumbersReadBackToTheLastBit) {
  std::mt19937_64 generator(3);
  Example scene = example();
  scene.expect.clear();
  while (scene.expect.size() < 1000) {
    const double value = std::bit_cast<double>(generator());
    if (std::abs(value) <= 1e100) scene.expect.push_back({"x", value});
  }
  scene.expect.push_back({"smallest", std::numeric_limits<double>::denorm_min()});
  scene.expect.push_back({"largest", 1e100});
  scene.expect.push_back({"minus zero", -0.0});
  scene.expect.push_back({"third", 1.0 / 3.0});
  const Example again = read_back(scene);
  EXPECT_EQ(again, scene);
  EXPECT_TRUE(std::signbit(again.expect[again.expect.size() - 2].value));
}

TEST(ResolvedScene, TextsReadBackWhateverTheyHold) {
  Example scene = example();
  scene.recording.channels = {
      "",       "null",    "~",     "true", "yes",          "1e5",    " lead",
      "trail ", "a: b",    "a #b",  "- x",  "[1]",          "{a: b}", "it's",
      "\"q\"",  "back\\s", "a\nb",  "a\tb", "\r",           "µ°é漢",  "&a",
      "*a",     "!t",      "%x",    "@x",   "`x",           "a,b",    "|",
      ">",      "...",     "---",   "<<",   "\x01\x1f\x7f", ".5",     "0x1",
      "\u2028", "\u0085",  "a/b.c", "=",    "null ",        "NULL",   std::string("a\0b", 3)};
  EXPECT_EQ(read_back(scene).recording.channels, scene.recording.channels);
}

TEST(ResolvedScene, RandomTextsReadBack) {
  std::mt19937 generator(5);
  const std::vector<std::string> pieces{"a", " ", "\n", "'", "\"", "\\", ":", "#",
                                        "-", "é", ",",  "[", "}",  "\t", "0", "\x02"};
  Example scene = example();
  scene.recording.channels.clear();
  for (int i = 0; i < 500; ++i) {
    std::string text;
    for (int k = std::uniform_int_distribution<int>(0, 12)(generator); k > 0; --k) {
      text += pieces[std::uniform_int_distribution<std::size_t>(0, pieces.size() - 1)(generator)];
    }
    scene.recording.channels.push_back(text);
  }
  EXPECT_EQ(read_back(scene).recording.channels, scene.recording.channels);
}

TEST(ResolvedScene, NamesThatLookLikeNothingAreQuoted) {
  Example scene = example();
  scene.materials["null"] = scene.materials.at("steel");
  scene.materials["_"] = scene.materials.at("steel");
  scene.materials["yes"] = scene.materials.at("steel");
  EXPECT_EQ(read_back(scene), scene);
}

/// An optional number whose default means "not given".
struct Unlimited {
  double until = std::numeric_limits<double>::infinity();
  static const Schema& schema() {
    static const Schema keys =
        SchemaOf<Unlimited>("unlimited")
            .real("until", &Unlimited::until, {.doc = "End.", .unit = "s", .optional = true});
    return keys;
  }
};

TEST(ResolvedScene, NumberThatIsNotFiniteIsLeftOut) {
  EXPECT_EQ(resolved_yaml(Unlimited{}), "{}\n");
  EXPECT_EQ(resolved_yaml(Unlimited{2.0}), "until: 2\n");
  const auto again = read_as<Unlimited>(read_scene_text(resolved_yaml(Unlimited{}), "resolved"));
  EXPECT_TRUE(std::isinf(again.until));
}

/// Empty maps where sections are expected.
struct Switches {
  bool on = false;
  std::optional<double> level;
  struct Inner {
    std::optional<double> level;
    static const Schema& schema() {
      static const Schema keys = SchemaOf<Inner>("inner").real("level", &Inner::level,
                                                               {.doc = "Level.", .optional = true});
      return keys;
    }
  };
  std::optional<Inner> inner;
  std::vector<Inner> list;
  static const Schema& schema() {
    static const Schema keys =
        SchemaOf<Switches>("switches")
            .section("inner", &Switches::inner, {.doc = "Inner.", .optional = true})
            .section_list("list", &Switches::list, {.doc = "List.", .optional = true});
    return keys;
  }
};

TEST(ResolvedScene, EmptySectionsStayPresent) {
  Switches scene;
  EXPECT_EQ(resolved_yaml(scene), "list: []\n");
  scene.inner.emplace();
  scene.list.resize(2);
  const std::string text = resolved_yaml(scene);
  EXPECT_EQ(text, "inner: {}\nlist:\n  - {}\n  - {}\n");
  const auto again = read_as<Switches>(read_scene_text(text, "resolved"));
  EXPECT_TRUE(again.inner);
  EXPECT_EQ(again.list.size(), 2u);
}

}  // namespace
}  // namespace stridor
