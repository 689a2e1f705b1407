#include "io/scene/oscillator_family.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <array>
#include <string>
#include <utility>
#include <vector>

#include "tests/support/message_of.hpp"
#include "tests/support/program.hpp"

namespace stridor {
namespace {

using namespace test;
using ::testing::HasSubstr;

LoadedScene mass_scene(const std::vector<std::string>& sets = {}) {
  return load_scene(scene_path("viscoelastic_sphere.yaml"), sets);
}

/// The oscillator of a scene that is read anew.
SlidingOscillator read_anew(const LoadedScene& scene, const std::vector<NumericKey>& keys,
                            const std::vector<double>& values) {
  Settings settings;
  for (std::size_t i = 0; i < keys.size(); ++i) settings.emplace_back(keys[i].path, values[i]);
  BodyCache cache;
  const LoadedScene changed = with_settings(scene, settings);
  return as_oscillator(build_model_with(changed, settings, cache).system).value();
}

void expect_same(const SlidingOscillator& a, const SlidingOscillator& b) {
  EXPECT_EQ(a.oscillator.stiffness, b.oscillator.stiffness);
  EXPECT_EQ(a.oscillator.damping, b.oscillator.damping);
  EXPECT_EQ(a.oscillator.load, b.oscillator.load);
  EXPECT_EQ(a.oscillator.substrate_speed, b.oscillator.substrate_speed);
  EXPECT_EQ(a.time, b.time);
  EXPECT_EQ(a.length, b.length);
  EXPECT_EQ(a.force, b.force);
  const SubstrateContact& of_a = a.oscillator.contact;
  const SubstrateContact& of_b = b.oscillator.contact;
  EXPECT_EQ(of_a.indentation_unit, of_b.indentation_unit);
  EXPECT_EQ(of_a.speed_unit, of_b.speed_unit);
  EXPECT_EQ(of_a.force_unit, of_b.force_unit);
  EXPECT_EQ(of_a.shear, of_b.shear);
  EXPECT_EQ(of_a.load, of_b.load);
  EXPECT_EQ(of_a.sign.speed, of_b.sign.speed);
  EXPECT_EQ(of_a.interface_friction.dynamic_coefficient,
            of_b.interface_friction.dynamic_coefficient);
}

struct Case {
  const char* name;
  std::vector<std::string> paths;
  std::array<std::vector<double>, 2> values;  ///< two members, and back to the first
  bool keeps_body;
  std::vector<std::string> sets = {};
};

void PrintTo(const Case& one, std::ostream* stream) {
  *stream << one.name;
}

class OscillatorFamilyOf : public ::testing::TestWithParam<Case> {};

TEST_P(OscillatorFamilyOf, KeysIsTheSceneReadAnewToTheLastBit) {
  const LoadedScene scene = mass_scene(GetParam().sets);
  std::vector<NumericKey> keys;
  for (const std::string& path : GetParam().paths)
    keys.push_back(find_numeric_key(scene.scene, path, "--x"));
  const auto family = OscillatorFamily::make(scene, keys);
  ASSERT_NE(family, nullptr);
  EXPECT_EQ(family->keeps_body(), GetParam().keeps_body);
  for (const int i : {0, 1, 0}) {
    const std::vector<double>& values = GetParam().values[static_cast<std::size_t>(i)];
    const SlidingOscillator* found = family->at(values);
    ASSERT_NE(found, nullptr);
    expect_same(*found, read_anew(scene, keys, values));
  }
}

TEST(OscillatorFamily, TakesDrivesByName) {
  const TemporaryFolder folder;
  std::string text = contents_of(scene_path("viscoelastic_sphere.yaml"));
  const std::size_t at = text.find("drive: {");
  const std::size_t end = text.find('\n', at);
  text.replace(at, end - at,
               "drives:\n  belt: {velocity: =v*R/tau, ramp: 0, moves: contact.master}\n  weight: "
               "{load: =-F*E*R^2, ramp: 0, load_on: sphere.center}");
  write_file(folder / "named.yaml", text);
  const LoadedScene named = load_scene((folder / "named.yaml").string(), {});
  const LoadedScene single = mass_scene();
  std::vector<NumericKey> keys;
  for (const char* path : {"drives.belt.velocity", "drives.weight.load"})
    keys.push_back(find_numeric_key(named.scene, path, "--x"));
  std::vector<NumericKey> of_single;
  for (const char* path : {"drive.velocity", "drive.load"})
    of_single.push_back(find_numeric_key(single.scene, path, "--x"));
  const auto family = OscillatorFamily::make(named, keys);
  const auto expected = OscillatorFamily::make(single, of_single);
  ASSERT_NE(family, nullptr);
  EXPECT_TRUE(family->keeps_body());
  for (const std::vector<double>& values :
       {std::vector<double>{0.01, -0.1}, std::vector<double>{0.3, -0.02}}) {
    expect_same(*family->at(values), *expected->at(values));
    expect_same(*family->at(values), read_anew(named, keys, values));
  }
}

INSTANTIATE_TEST_SUITE_P(
    Scenes, OscillatorFamilyOf,
    ::testing::Values(
        Case{"SpeedAndStrength",
             {"parameters.v", "parameters.tau0"},
             {{{1e-4, 1e-3}, {1.0, 0.3}}},
             true},
        Case{"StrengthAlone",
             {"parameters.v", "parameters.tau0"},
             {{{1e-4, 1e-3}, {1e-4, 0.3}}},
             true},
        Case{"SpeedAlone", {"parameters.v", "parameters.tau0"}, {{{1e-4, 1e-3}, {1.0, 1e-3}}}, true},
        Case{
            "LoadAndModulus", {"parameters.F", "parameters.E"}, {{{1e-3, 1e6}, {1e-5, 2e5}}}, true},
        Case{"RadiusAndCreepTime",
             {"parameters.R", "parameters.tau"},
             {{{1e-3, 1e-3}, {0.1, 1.0}}},
             true},
        Case{"KeysThemselves",
             {"contact.friction.strength", "drive.velocity"},
             {{{1e4, 0.01}, {1e3, 1.0}}},
             true},
        Case{"AKeyAndAParameterOfOthers",
             {"drive.load", "parameters.tau0"},
             {{{-0.1, 0.01}, {-1.0, 0.1}}},
             true},
        Case{"StiffnessAndAngle",
             {"parameters.Omega", "parameters.alpha"},
             {{{1.3, 0.2}, {0.7, -0.4}}},
             false},
        Case{"DampingAndLoad",
             {"parameters.xi_x", "parameters.F"},
             {{{0.03, 1e-3}, {0.0, 1e-4}}},
             false},
        Case{"AParameterOfAParameter",
             {"parameters.part"},
             {{{0.5}, {2.0}}},
             true,
             {"parameters.part=1", "parameters.tau0==0.01*twice", "parameters.twice==2*part"}},
        Case{"SpeedOfRegularisation",
             {"contact.friction.regularisation.speed", "parameters.v"},
             {{{1e-3, 1e-3}, {1e-4, 1e-2}}},
             true,
             {"contact.friction.regularisation={law: tanh, speed: 1e-3}"}},
        Case{"CoefficientOfTheInterface",
             {"contact.friction.coefficient"},
             {{{0.2}, {0.4}}},
             true,
             {"contact.friction={coefficient: 0.3}"}}),
    [](const auto& tested) { return std::string(tested.param.name); });

TEST(OscillatorFamily, RefusesAValueAsTheReaderDoes) {
  const LoadedScene scene = mass_scene();
  const auto refusal = [&](const char* path, double value) {
    const std::vector<NumericKey> keys{find_numeric_key(scene.scene, path, "--x")};
    const auto family = OscillatorFamily::make(scene, keys);
    return message_of<ConfigError>([&] { (void)family->at(std::array{value}); });
  };
  EXPECT_THAT(refusal("parameters.R", -1.0), HasSubstr("contact.normal.radius"));
  EXPECT_THAT(refusal("parameters.R", -1.0), HasSubstr("must be > 0, got -1 m"));
  EXPECT_THAT(refusal("parameters.omega_x", 0.0), HasSubstr("divided by 0"));
}

TEST(OscillatorFamily, ForgetsAValueThatItHasRefused) {
  const LoadedScene scene = mass_scene();
  const std::vector<NumericKey> keys{find_numeric_key(scene.scene, "parameters.R", "--x"),
                                     find_numeric_key(scene.scene, "parameters.tau0", "--y")};
  const auto family = OscillatorFamily::make(scene, keys);
  const std::vector<double> values{0.02, 1e-3};
  expect_same(*family->at(values), read_anew(scene, keys, values));
  EXPECT_THROW((void)family->at(std::array{-1.0, 0.1}), ConfigError);
  EXPECT_THROW((void)family->at(std::array{0.03, -1.0}), ConfigError);
  expect_same(*family->at(values), read_anew(scene, keys, values));
}

TEST(OscillatorFamily, IsNoneOfOtherSystemsAndPlaces) {
  const LoadedScene scene = mass_scene();
  const auto family_of = [](const LoadedScene& loaded, const char* path) {
    return OscillatorFamily::make(loaded, {find_numeric_key(loaded.scene, path, "--x")});
  };
  EXPECT_EQ(family_of(scene, "contact.start"), nullptr);
  EXPECT_EQ(OscillatorFamily::make(scene, {{drive_displacement_name, "m", Range::any()}}), nullptr);
  EXPECT_EQ(
      family_of(load_scene(scene_path("beam_on_beam.yaml"), {}), "contact.friction.coefficient"),
      nullptr);
  EXPECT_EQ(family_of(load_scene(scene_path("examples/beam_on_substrate.yaml"), {}),
                      "contact.friction.strength"),
            nullptr);
}

TEST(OscillatorFamily, StandsStillWhereTheHalfSpaceDoes) {
  const LoadedScene scene = mass_scene();
  const auto family =
      OscillatorFamily::make(scene, {find_numeric_key(scene.scene, "parameters.v", "--x")});
  EXPECT_EQ(family->at(std::array{0.0}), nullptr);
  EXPECT_NE(family->at(std::array{1e-3}), nullptr);
}

}  // namespace
}  // namespace stridor
