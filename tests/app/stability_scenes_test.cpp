// The verbs about small vibrations on scenes of every kind: several pairs, friction laws, surfaces,
// open contacts, equal bodies, other scales. Eigenvalues against transients, against the dense
// method and against dimensional analysis.
#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <complex>
#include <fstream>
#include <nlohmann/json.hpp>
#include <numbers>

#include "tests/support/dataset.hpp"
#include "tests/support/program.hpp"

namespace stridor {
namespace {

using namespace test;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::SizeIs;
using Json = nlohmann::json;
using Complex = std::complex<double>;
using Strings = std::vector<std::string>;

/// The JSON object that the program prints; null, with a failure, where it does not end well.
Json run_json(Strings arguments, const Strings& sets = {}) {
  for (const std::string& set : sets) arguments.insert(arguments.end(), {"--set", set});
  arguments.push_back("--json");
  const ProgramResult result = Program(arguments).run();
  EXPECT_EQ(result.exit_code, 0) << result.err;
  return result.exit_code == 0 ? Json::parse(result.out) : Json();
}

Complex complex_of(const Json& eigenvalue) {
  return {eigenvalue[0].get<double>(), eigenvalue[1].get<double>()};
}

/// Those with positive imaginary part.
std::vector<Complex> vibrations(const Json& eigenvalues) {
  std::vector<Complex> found;
  for (const Json& one : eigenvalues)
    if (one[1] > 0.0) found.push_back(complex_of(one));
  return found;
}

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
    run_json({"run", scene, "-o", file, "--force"}, sets);
  };
  Strings eig{"eig", scene, "--about", "deformed", "--count", "16"};
  if (of.has_one_contact) {
    // A run starts with the drive at 0; friction and load have bent the tip away from there.
    run({"time.end=1e-5", "record.channels=[contact.position]"});
    const double position = dataset(file, "/contact/contact/position").front();
    eig.insert(eig.end(), {"--at", fmt::format("{:.12g}", position)});
  }
  const std::vector<Complex> modes = vibrations(run_json(eig, of.sets)["eigenvalues"]);
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

}  // namespace
}  // namespace stridor
