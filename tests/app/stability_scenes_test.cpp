// The verbs about small vibrations on scenes of every kind: several pairs, friction laws, surfaces,
// open contacts. Eigenvalues against transients and against the dense method.
#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <complex>
#include <numbers>
#include <ostream>
#include <string>
#include <vector>

#include "tests/support/dataset.hpp"
#include "tests/support/eigenvalue_program.hpp"
#include "tests/support/program.hpp"
#include "tests/support/temporary_folder.hpp"

namespace stridor {
namespace {

using namespace test;
using ::testing::IsEmpty;
using Complex = std::complex<double>;
using Strings = std::vector<std::string>;

struct Transient {
  const char* name;
  std::string scene;
  Strings sets;
  std::string channel;  ///< an acceleration
  double from, to;      ///< s; growth is measured from the first half to the second
  bool has_one_contact = true;
};

void PrintTo(const Transient& transient, std::ostream* stream) {
  *stream << transient.name;
}

class FrozenGrowth : public ::testing::TestWithParam<Transient> {};

/// Component at the frequency of s of a stretch of a signal, by a Hann window.
Complex component(const std::vector<double>& time, const std::vector<double>& signal, double from,
                  double length, double omega) {
  Complex sum = 0.0;
  for (std::size_t i = 0; i < time.size(); ++i) {
    const double phase = (time[i] - from) / length;
    if (phase < 0.0 || phase > 1.0) continue;
    const double window = 1.0 - std::cos(2.0 * std::numbers::pi * phase);
    sum += window * signal[i] * std::exp(Complex(0.0, -omega * time[i]));
  }
  return sum;
}

TEST_P(FrozenGrowth, IsTheRealPartOfTheEigenvalue) {
  const Transient& of = GetParam();
  const std::string scene = scene_path(of.scene);
  const TemporaryFolder folder;
  const std::string file = (folder / "run.h5").string();
  const auto run = [&](const Strings& more) {
    Strings sets = of.sets;
    sets.insert(sets.end(), {"drive.ramp=0", "initial.state=equilibrium", "measure={from: 0}"});
    sets.insert(sets.end(), more.begin(), more.end());
    scene_json({"run", scene, "-o", file, "--force"}, sets);
  };
  Strings eig{"eig", scene, "--about", "deformed", "--count", "16"};
  if (of.has_one_contact) {
    // A run starts with the drive at 0; friction and load have bent the tip away from there.
    run({"time.end=1e-5", "record.channels=[contact.position]"});
    const double position = dataset(file, "/contact/contact/position").front();
    eig.insert(eig.end(), {"--at", fmt::format("{:.12g}", position)});
  }
  const std::vector<Complex> modes = vibrations(scene_json(eig, of.sets)["eigenvalues"]);
  const auto fastest = std::max_element(modes.begin(), modes.end(),
                                        [](Complex a, Complex b) { return a.real() < b.real(); });
  ASSERT_NE(fastest, modes.end());
  const Complex s = *fastest;

  run({fmt::format("time.end={}", of.to), fmt::format("record.channels=[{}]", of.channel),
       fmt::format("initial.perturbation={{eigenvalue: {}, amplitude: 1e-10}}",
                   fastest - modes.begin() + 1)});
  const std::vector<double> time = dataset(file, "/time");
  const std::vector<double> signal = dataset(file, "/channels/" + of.channel);
  const double half = 0.5 * (of.to - of.from);
  const Complex early = component(time, signal, of.from, half, s.imag());
  const Complex late = component(time, signal, of.from + half, half, s.imag());
  const Complex rate = std::log(late / early) / half;
  RecordProperty("growth_of_run", fmt::format("{:.6g}", rate.real()));
  RecordProperty("real_part", fmt::format("{:.6g}", s.real()));
  EXPECT_NEAR(rate.real(), s.real(), 0.01 * std::abs(s.real()));
  EXPECT_NEAR(rate.imag(), 0.0, 1e-3 * s.imag());
}

const Strings two_frozen{"contacts.front.sliding=frozen", "contacts.rear.sliding=frozen"};
Strings with(Strings sets, const Strings& more) {
  sets.insert(sets.end(), more.begin(), more.end());
  return sets;
}
const Strings main_frozen{"contact.sliding=frozen", "contact.start=75.2 mm",
                          "substructures.oblique.damping={alpha: 0.2, beta: 4e-8}"};
const std::string tip = "cantilever.free_end.y.acceleration";
const std::string edge = "examples/slave_edge.yaml";
const std::string foot = "post.end_top.y.acceleration";

INSTANTIATE_TEST_SUITE_P(
    Scenes, FrozenGrowth,
    ::testing::Values(
        Transient{"TwoPairs", "examples/two_pairs.yaml",
                  with(two_frozen, {"contacts.front.start=75.2 mm"}), tip, 0.01, 0.05, false},
        Transient{"SubsB", "beam_on_beam.yaml", main_frozen, tip, 0.01, 0.05},
        Transient{"SubsC", "beam_on_beam.yaml", with(main_frozen, {"contact.assumption=subs_c"}),
                  tip, 0.01, 0.05},
        Transient{"Stribeck", "beam_on_beam.yaml",
                  with(main_frozen, {"contact.friction={law: stribeck, static: 0.45, dynamic: "
                                     "0.25, decay_velocity: 0.03}"}),
                  tip, 0.01, 0.05},
        Transient{"SmoothAndRough", "beam_on_beam.yaml",
                  with(main_frozen, {"contact.surface=smooth",
                                     "contact.roughness={rms: 2e-7, correlation_length: 1e-4, "
                                     "seed: 1}"}),
                  tip, 0.01, 0.05},
        Transient{"OneOfThreeOpen", edge, {"contact.sliding=frozen"}, foot, 0.0002, 0.0022, false},
        Transient{"TwoOfThreeOpen",
                  edge,
                  {"contact.sliding=frozen", "contact.friction.coefficient=0.5"},
                  foot,
                  0.0,
                  0.0004,
                  false}),
    [](const auto& one) { return one.param.name; });

TEST(UndeformedGeometry, DoesNotKnowTheGrowthOfTheSagged) {
  // Where runs under Subs-b and Subs-c grow by 90 and 94 1/s, above.
  for (const char* assumption : {"subs_b", "subs_c"}) {
    const Json eig =
        scene_json({"eig", scene_path("beam_on_beam.yaml"), "--about", "undeformed"},
                   with(main_frozen, {std::string("contact.assumption=") + assumption}));
    EXPECT_TRUE(eig["stable"].get<bool>());
    for (const Complex s : vibrations(eig["eigenvalues"])) EXPECT_LT(s.real(), 0.0);
  }
}

/// Windows that both methods must have in common: those wider and higher than rounding.
std::vector<std::array<double, 4>> windows_of(const Json& unstable) {
  std::vector<std::array<double, 4>> windows;
  for (const Json& one : unstable) {
    windows.push_back({one["from"], one["to"], one["growth_max"], one["growth_integral"]});
  }
  return windows;
}

struct Range {
  const char* name;
  std::string scene;
  std::string parameter, from, to;
  Strings sets;
  bool has_windows = true;
};

void PrintTo(const Range& range, std::ostream* stream) {
  *stream << range.name;
}

class BothMethods : public ::testing::TestWithParam<Range> {};

TEST_P(BothMethods, FindTheSameLocus) {
  const Range& of = GetParam();
  const auto locus = [&](const char* method) {
    return scene_json(
        {"locus", scene_path(of.scene), "--parameter", of.parameter, "--from", of.from, "--to",
         of.to, "--points", "5", "--count", "16", "--about", "deformed", "--method", method},
        of.sets);
  };
  const Json secular = locus("secular");
  const Json dense = locus("dense");
  EXPECT_THAT(secular["unverified"], IsEmpty());
  ASSERT_EQ(secular["eigenvalues"].size(), 5u);
  for (std::size_t i = 0; i < 5; ++i) {
    const std::vector<Complex> a = vibrations(secular["eigenvalues"][i]);
    const std::vector<Complex> b = vibrations(dense["eigenvalues"][i]);
    EXPECT_EQ(secular["eigenvalues"][i].size(), dense["eigenvalues"][i].size());
    ASSERT_EQ(a.size(), b.size());
    for (std::size_t k = 0; k < a.size(); ++k)
      EXPECT_LT(std::abs(a[k] - b[k]), 1e-8 * std::abs(a[k])) << i << ' ' << k;
  }
  const auto a = windows_of(secular["unstable"]);
  const auto b = windows_of(dense["unstable"]);
  ASSERT_EQ(a.size(), b.size()) << secular["unstable"].dump(1) << dense["unstable"].dump(1);
  EXPECT_EQ(!a.empty(), of.has_windows);
  for (std::size_t k = 0; k < a.size(); ++k) {
    for (std::size_t i = 0; i < 4; ++i) EXPECT_NEAR(a[k][i], b[k][i], 1e-5 * std::abs(a[k][i]));
  }
}

/// So that the dense method takes milliseconds.
const Strings few_modes{"time.integrator=exact", "time.retain={frequency: 20 kHz}"};

INSTANTIATE_TEST_SUITE_P(
    Scenes, BothMethods,
    ::testing::Values(
        Range{"PositionOfOneOfTwoPairs", "examples/two_pairs.yaml", "contacts.front.start", "74 mm",
              "76.5 mm", few_modes},
        // Two of three contacts open on the way; at the end an eigenvalue has become real.
        Range{"FrictionUnderAnEdge",
              "examples/slave_edge.yaml",
              "contact.friction.coefficient",
              "0.05",
              "1.5",
              {}},
        Range{"VelocityUnderStribecksLaw", "beam_on_beam.yaml", "drive.velocity", "0.01", "0.2",
              with(few_modes, {"contact.friction={law: stribeck, static: 0.45, dynamic: 0.25, "
                               "decay_velocity: 0.03}"})},
        Range{"LoadOnASmoothSurface", "beam_on_beam.yaml", "drive.load", "-0.4", "-0.05",
              with(few_modes, {"contact.surface=smooth", "contact.start=75.2 mm"})},
        Range{"ARigidMaster",
              "examples/stick_slip.yaml",
              "drive.velocity",
              "0.002",
              "0.02",
              {},
              false}),
    [](const auto& one) { return one.param.name; });

}  // namespace
}  // namespace stridor
