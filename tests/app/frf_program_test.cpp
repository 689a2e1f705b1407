// Frequency responses that the program computes, and its messages where it cannot.
#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <hdf5.h>
#include <hdf5_hl.h>

#include <Eigen/Core>
#include <Eigen/Eigenvalues>
#include <algorithm>
#include <array>
#include <cmath>
#include <complex>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "app/stability/response_picture.hpp"
#include "io/imports/uff_functions.hpp"
#include "io/results/result_file.hpp"
#include "tests/support/constants.hpp"
#include "tests/support/program.hpp"

namespace stridor {
namespace {

using namespace test;
using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::Not;
using ::testing::StartsWith;
using Json = nlohmann::json;
using Complex = std::complex<double>;

// 2 kg on 8000 N/m with 6 N s/m: 10.066 Hz.
constexpr const char* one_mass = R"(format: 2
substructures:
  slider:
    type: lumped
    masses: {mass: {mass: 2}}
    springs:
      along: {at: mass, stiffness: 8000, damping: 6}
      up: {at: mass, stiffness: 32000, direction: [0, 1]}
)";

class FrfProgram : public ::testing::Test {
 protected:
  std::string path(const std::string& name) const { return (folder_ / name).string(); }
  std::string write(const std::string& name, const std::string& text) const {
    std::ofstream(folder_ / name) << text;
    return path(name);
  }
  static ProgramResult frf(std::vector<std::string> arguments) {
    arguments.insert(arguments.begin(), "frf");
    return Program(arguments).run();
  }
  static Json json_of(std::vector<std::string> arguments) {
    arguments.emplace_back("--json");
    const ProgramResult result = frf(arguments);
    EXPECT_EQ(result.exit_code, 0) << result.err;
    return Json::parse(result.out, nullptr, false);
  }
  static Complex value(const Json& response, std::size_t i) {
    return {response["real"][i].get<double>(), response["imaginary"][i].get<double>()};
  }

  TemporaryFolder folder_;
};

TEST_F(FrfProgram, OneMassAnswersAsItsClosedForm) {
  const std::string scene = write("mass.yaml", one_mass);
  const Json object =
      json_of({scene, "--input", "slider.mass.x", "--output", "slider.mass.x.displacement",
               "--output", "slider.mass.x.velocity", "--output", "slider.mass.x.acceleration",
               "--from", "1", "--to", "30", "--points", "59"});
  ASSERT_EQ(object["frequencies"].size(), 59u);
  ASSERT_EQ(object["responses"].size(), 3u);
  const char* units[] = {"m/N", "m/s/N", "m/s^2/N"};
  for (std::size_t order = 0; order < 3; ++order) {
    const Json& response = object["responses"][order];
    EXPECT_EQ(response["units"], units[order]);
    EXPECT_EQ(response["input"], "slider.mass.x");
    EXPECT_EQ(response["truncation"], nullptr);
    for (std::size_t i = 0; i < 59; ++i) {
      const Complex s(0.0, two_pi * object["frequencies"][i].get<double>());
      const Complex expected =
          std::pow(s, static_cast<int>(order)) / (2.0 * s * s + 6.0 * s + 8000.0);
      EXPECT_LT(std::abs(value(response, i) - expected), 1e-12 * std::abs(expected));
    }
  }
  EXPECT_NEAR(object["responses"][0]["peak"]["frequency"].get<double>(), 10.0, 0.26);
}

TEST_F(FrfProgram, BeamsInSlidingContactAreAskedAboutTheirEquilibrium) {
  const std::string scene = scene_path("beam_on_beam.yaml");
  const auto responses = [&](const std::string& friction, const std::string& from) {
    return json_of({scene, "--input", "cantilever.free_end.y", "--input", "oblique.tip.y",
                    "--output", "cantilever.free_end.y.displacement", "--output",
                    "oblique.tip.y.displacement", "--from", from, "--to", "9kHz", "--points", "40",
                    "--about", "deformed", "--set", "contact.start=0.075", "--set",
                    "contact.friction.coefficient=" + friction});
  };
  // Without friction Betti holds; with it the response across is another one.
  const auto asymmetry = [&](const Json& object) {
    double difference = 0.0, size = 0.0;
    for (std::size_t i = 0; i < 40; ++i) {
      difference += std::norm(value(object["responses"][1], i) - value(object["responses"][2], i));
      size += std::norm(value(object["responses"][1], i));
    }
    return std::sqrt(difference / size);
  };
  EXPECT_LT(asymmetry(responses("0", "20")), 1e-7);
  EXPECT_GT(asymmetry(responses("0.3", "20")), 1e-2);
  // Near an eigenvalue that no other one is close to, the response is a pole and a constant:
  // three values of it tell the eigenvalue that `eig` finds.
  const ProgramResult eig = Program({"eig", scene, "--json", "--about", "deformed", "--set",
                                     "contact.start=0.075", "--set",
                                     "contact.friction.coefficient=0.3"})
                                .run();
  const Json found = Json::parse(eig.out);
  std::vector<Complex> spectrum;
  for (const Json& pair : found["eigenvalues"])
    spectrum.emplace_back(pair[0].get<double>(), pair[1].get<double>());
  int checked = 0;
  for (const Complex& s : spectrum) {
    const auto is_close = [&](const Complex& other) {
      return other != s && std::abs(other - s) < 600.0;
    };
    // Above 9.5 kHz there are modes of the oblique beam alone, which the point hardly sees.
    if (s.imag() < 2000.0 || s.imag() > 6e4) continue;
    if (std::any_of(spectrum.begin(), spectrum.end(), is_close)) continue;
    const double f = s.imag() / two_pi;
    const Json near = json_of({scene, "--input", "cantilever.free_end.y", "--output",
                               "cantilever.free_end.y.displacement", "--from",
                               std::to_string(f - 0.5), "--to", std::to_string(f + 0.5),
                               "--points", "3", "--about", "deformed", "--set",
                               "contact.start=0.075", "--set",
                               "contact.friction.coefficient=0.3"});
    std::array<Complex, 3> at, h;
    for (std::size_t i = 0; i < 3; ++i) {
      at[i] = Complex(0.0, two_pi * near["frequencies"][i].get<double>());
      h[i] = value(near["responses"][0], i);
    }
    const Complex ratio = (h[0] - h[1]) / (h[1] - h[2]) * (at[2] - at[1]) / (at[1] - at[0]);
    const Complex pole = (ratio * at[0] - at[2]) / (ratio - 1.0);
    EXPECT_LT(std::abs(pole - s), 1e-2 * std::abs(s.real())) << f << " Hz";
    ++checked;
  }
  EXPECT_GE(checked, 8);
}

TEST_F(FrfProgram, TellsWhatTheModesOfARunLeaveOut) {
  const std::string scene = scene_path("beam_on_beam.yaml");
  const auto truncation = [&](const std::string& kept) {
    const Json object =
        json_of({scene, "--input", "cantilever.free_end.y", "--from", "20", "--to", "5kHz",
                 "--points", "50", "--set", "time.integrator=exact", "--set", "time.step=5e-6",
                 "--set", "time.retain.frequency=" + kept, "-o", path(kept + ".h5")});
    const double printed = object["responses"][0]["truncation"].get<double>();
    const ResultFile file(path(kept + ".h5"));
    EXPECT_EQ(file.number(
                  "/responses/cantilever.free_end.y.acceleration/cantilever.free_end.y/truncation"),
              printed);
    return printed;
  };
  const double few = truncation("12kHz");
  const double many = truncation("40kHz");
  EXPECT_LT(few, 0.1);
  EXPECT_LT(many, 0.2 * few);
  EXPECT_GT(many, 0.0);
  // A run that keeps all modes leaves nothing out.
  json_of({scene, "--input", "cantilever.free_end.y", "--from", "20", "--to", "5kHz", "--points",
           "5", "-o", path("all.h5")});
  EXPECT_EQ(
      ResultFile(path("all.h5"))
          .number("/responses/cantilever.free_end.y.acceleration/cantilever.free_end.y/truncation"),
      std::nullopt);
}

// Of a chain of three masses a run keeps one mode. At a single port the others act as one with
// their flexibility g = Σ φ²/ω² and inertia Σ φ²/ω⁴ there: h = g²/(g − Ω² Σ φ²/ω⁴).
TEST_F(FrfProgram, TruncationOverFrequencyIsThatOfTheClosedForm) {
  const std::string scene = write("chain.yaml", R"(format: 2
substructures:
  chain:
    type: lumped
    directions: x
    masses: {a: {mass: 1}, b: {mass: 2, at: [0.1, 0]}, c: {mass: 1.5, at: [0.2, 0]}}
    springs:
      ground: {at: a, stiffness: 4e4}
      ab: {at: [a, b], stiffness: 3e4}
      bc: {at: [b, c], stiffness: 2e4}
time: {integrator: exact, step: 0.1 ms, end: 0.1, retain: {frequency: 15 Hz}}
)");
  const Json object =
      json_of({scene, "--input", "chain.c.x", "--output", "chain.c.x.displacement", "--from", "1",
               "--to", "60", "--points", "60", "-o", path("chain.h5"), "--figure", path("a.svg")});
  const Eigen::Vector3d mass(1.0, 2.0, 1.5);
  Eigen::Matrix3d stiffness;
  stiffness << 7e4, -3e4, 0.0, -3e4, 5e4, -2e4, 0.0, -2e4, 2e4;
  const Eigen::Vector3d scale = mass.cwiseSqrt().cwiseInverse();
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> modes(scale.asDiagonal() * stiffness *
                                                             scale.asDiagonal());
  const Eigen::Array3d squares = modes.eigenvalues();
  ASSERT_LT(std::sqrt(squares(0)) / two_pi, 15.0);
  ASSERT_GT(std::sqrt(squares(1)) / two_pi, 15.0);
  const Eigen::Array3d shape = scale(2) * modes.eigenvectors().row(2).transpose();
  const double g = (shape.square() / squares).tail(2).sum();
  const double inertia = (shape.square() / squares.square()).tail(2).sum();
  const Json& response = object["responses"][0];
  double of_errors = 0.0, of_responses = 0.0;
  const ResultFile file(path("chain.h5"));
  const std::string dataset = "/responses/chain.c.x.displacement/chain.c.x/truncation_error";
  const std::vector<double> kept = file.read(dataset);
  EXPECT_EQ(file.array(dataset).units, "m/N");
  ASSERT_EQ(kept.size(), 60u);
  for (std::size_t i = 0; i < 60; ++i) {
    const double square = std::pow(two_pi * object["frequencies"][i].get<double>(), 2);
    const Eigen::Array3d parts = shape.square() / (squares - square);
    const double error = std::abs(g * g / (g - square * inertia) - parts.tail(2).sum());
    EXPECT_NEAR(kept[i], error, 1e-9 * parts.abs().sum()) << i;
    EXPECT_EQ(response["truncation_error"][i].get<double>(), kept[i]);
    of_errors += error * error;
    of_responses += parts.sum() * parts.sum();
  }
  EXPECT_GT(of_errors, 1e-8 * of_responses);
  EXPECT_NEAR(response["truncation"].get<double>(), std::sqrt(of_errors / of_responses), 1e-7);
  EXPECT_THAT(contents_of(path("a.svg")), HasSubstr("Dashed: how far they are off"));
  const std::size_t worst =
      static_cast<std::size_t>(std::max_element(kept.begin(), kept.end()) - kept.begin());
  const ProgramResult printed =
      frf({scene, "--input", "chain.c.x", "--output", "chain.c.x.displacement", "--from", "1",
           "--to", "60", "--points", "60"});
  EXPECT_THAT(printed.out,
              HasSubstr(fmt::format("most at {} Hz, by {:.2g} m/N", worst + 1, kept[worst])));
}

TEST_F(FrfProgram, KeepsTheComparisonInItsFile) {
  const std::string scene = write("mass.yaml", one_mass);
  const std::vector<std::string> arguments{scene,
                                           "--input",
                                           "slider.mass.x",
                                           "--input",
                                           "slider.mass.y",
                                           "--output",
                                           "slider.mass.x.velocity",
                                           "--output",
                                           "slider.mass.y.velocity",
                                           "--from",
                                           "1",
                                           "--to",
                                           "30",
                                           "--points",
                                           "30"};
  const auto with = [&](std::vector<std::string> more) {
    more.insert(more.begin(), arguments.begin(), arguments.end());
    return more;
  };
  json_of(with({"-o", path("measured.uff")}));
  EXPECT_FALSE(ResultFile([&] {
                 json_of(with({"-o", path("alone.h5")}));
                 return path("alone.h5");
               }())
                   .has("/compared/number"));
  // Twice the mass along both; the first measured response is that of x per force at x.
  const Json object =
      json_of(with({"--compare", path("measured.uff"), "--node", "1=slider.mass", "--set",
                    "substructures.slider.masses.mass.mass=4", "-o", path("compared.h5")}));
  const ResultFile file(path("compared.h5"));
  EXPECT_EQ(file.text("measured"), path("measured.uff"));
  const Json& compared = object["compared"];
  ASSERT_EQ(compared.size(), 4u);
  EXPECT_EQ(file.read("/compared/number"), (std::vector<double>{1, 2, 3, 4}));
  const std::vector<std::string> outputs = file.texts("/compared/output");
  const std::vector<std::string> inputs = file.texts("/compared/input");
  const std::vector<std::string> sources = file.texts("/compared/source");
  ASSERT_EQ(outputs.size(), 4u);
  for (std::size_t k = 0; k < 4; ++k) {
    EXPECT_EQ(outputs[k], compared[k]["output"]);
    EXPECT_EQ(inputs[k], compared[k]["input"]);
    EXPECT_EQ(sources[k], compared[k]["source"]);
    EXPECT_EQ(file.read("/compared/frac")[k], compared[k]["frac"].get<double>());
    // Nothing moves across: neither the measured nor the computed response has a size there.
    const bool has_ratio = outputs[k].substr(0, 13) == inputs[k];
    EXPECT_EQ(compared[k]["ratio"].is_number(), has_ratio);
    if (has_ratio)
      EXPECT_EQ(file.read("/compared/ratio")[k], compared[k]["ratio"].get<double>());
    else
      EXPECT_TRUE(std::isnan(file.read("/compared/ratio")[k]));
  }
  const std::vector<double> frequencies = file.read("/compared/1/frequency");
  ASSERT_EQ(frequencies.size(), 30u);
  EXPECT_EQ(file.array("/compared/1/measured_real").units, "m/s/N");
  for (const auto& [which, mass] : {std::pair("measured", 2.0), std::pair("computed", 4.0)}) {
    const std::vector<double> real = file.read(std::string("/compared/1/") + which + "_real");
    const std::vector<double> imaginary =
        file.read(std::string("/compared/1/") + which + "_imaginary");
    for (std::size_t i = 0; i < 30; ++i) {
      const Complex s(0.0, two_pi * frequencies[i]);
      const Complex expected = s / (mass * s * s + 6.0 * s + 8000.0);
      EXPECT_LT(std::abs(Complex(real[i], imaginary[i]) - expected), 1e-10 * std::abs(expected));
    }
  }
}

// Two masses on three springs: modes in phase and against each other. A measurement of a chain
// whose masses are alike stands beside one whose second mass is a third heavier.
TEST_F(FrfProgram, ShapesOfSeveralPointsHaveTheirMac) {
  const std::string scene = write("chain.yaml", R"(format: 2
parameters: {mass: 2}
substructures:
  chain:
    type: lumped
    directions: x
    masses: {a: {mass: 2}, b: {mass: =mass, at: [0.1, 0]}}
    springs:
      left: {at: a, stiffness: 4e4, damping: 4}
      between: {at: [a, b], stiffness: 3e4, damping: 3}
      right: {at: b, stiffness: 4e4, damping: 4}
)");
  const auto arguments = [&](std::vector<std::string> more) {
    more.insert(more.begin(), {scene, "--input", "chain.a.x", "--from", "5", "--to", "80",
                               "--points", "751", "--output", "chain.a.x.acceleration"});
    return more;
  };
  json_of(arguments({"--output", "chain.b.x.velocity", "-o", path("measured.uff")}));
  const std::vector<std::string> compare{"--output",  "chain.b.x.displacement",
                                         "--compare", path("measured.uff"),
                                         "--node",    "1=chain.a",
                                         "--node",    "2=chain.b"};
  const Json same = json_of(arguments(compare));
  ASSERT_EQ(same["shapes"].size(), 1u);
  EXPECT_EQ(same["shapes"][0]["input"], "chain.a.x");
  EXPECT_EQ(same["shapes"][0]["outputs"], Json({"chain.a.x", "chain.b.x"}));
  for (const Json& mac : same["shapes"][0]["mac"]) EXPECT_NEAR(mac.get<double>(), 1.0, 1e-10);

  std::vector<std::string> other = compare;
  other.insert(other.end(), {"--set", "parameters.mass=2.7", "-o", path("shapes.h5"), "--figure",
                             path("shapes.svg")});
  const Json object = json_of(arguments(other));
  const Json& shapes = object["shapes"][0];
  const auto response = [&](double mass, double frequency) {
    const Complex s(0.0, two_pi * frequency);
    const Complex between = 3e4 + 3.0 * s;
    Eigen::Matrix2cd z;
    z << 2.0 * s * s + 4e4 + 4.0 * s + between, -between, -between,
        mass * s * s + 4e4 + 4.0 * s + between;
    return Eigen::Vector2cd(z.inverse().col(0));
  };
  const auto mac = [](const Eigen::Vector2cd& a, const Eigen::Vector2cd& b) {
    return std::norm(a.dot(b)) / (a.squaredNorm() * b.squaredNorm());
  };
  ASSERT_EQ(shapes["mac"].size(), 751u);
  for (std::size_t i = 0; i < 751; i += 25) {
    const double f = shapes["frequencies"][i].get<double>();
    EXPECT_NEAR(shapes["mac"][i].get<double>(), mac(response(2.7, f), response(2.0, f)), 1e-9) << f;
  }
  // Of equal masses √(k/m) and √((k + 2 c)/m); lines lie 0.1 Hz apart.
  ASSERT_EQ(shapes["peaks"].size(), 2u);
  EXPECT_EQ(shapes["measured_peaks"].size(), 2u);
  const double measured[] = {std::sqrt(4e4 / 2.0) / two_pi, std::sqrt(1e5 / 2.0) / two_pi};
  for (std::size_t k = 0; k < 2; ++k) {
    const Json& peak = shapes["peaks"][k];
    EXPECT_NEAR(peak["measured"].get<double>(), measured[k], 0.1);
    EXPECT_EQ(peak["computed"], shapes["computed_peaks"][k]);
    const double there = peak["computed"].get<double>();
    EXPECT_LT(there, peak["measured"].get<double>() - 1.0);
    EXPECT_NEAR(peak["mac"].get<double>(),
                mac(response(2.7, there), response(2.0, peak["measured"].get<double>())), 1e-9);
    EXPECT_GT(peak["mac"].get<double>(), 0.9);
    EXPECT_EQ(peak["macs"][k], peak["mac"]);
    EXPECT_LT(peak["macs"][1 - k].get<double>(), 0.2);
  }
  const ResultFile file(path("shapes.h5"));
  EXPECT_EQ(file.texts("/shapes/input"), std::vector<std::string>{"chain.a.x"});
  EXPECT_EQ(Json(file.read("/shapes/1/mac")), shapes["mac"]);
  EXPECT_EQ(file.array("/shapes/1/peak_mac").shape, (std::vector<std::size_t>{2, 2}));
  EXPECT_EQ(file.read("/shapes/1/peak_mac", 2)[1], shapes["peaks"][1]["macs"][0].get<double>());
  EXPECT_THAT(contents_of(path("shapes.svg")), HasSubstr("MAC, force at chain.a.x"));
  other.resize(other.size() - 4);
  const ProgramResult printed = frf(arguments(other));
  EXPECT_THAT(printed.out, AllOf(HasSubstr("2 directions move by a force at chain.a.x"),
                                 HasSubstr("difference     MAC\n        22.5")));
  // One point has no shape.
  const Json alone = json_of(arguments({"--compare", path("measured.uff"), "--node", "1=chain.a"}));
  EXPECT_EQ(alone["compared"].size(), 1u);
  EXPECT_TRUE(alone["shapes"].empty());
}

TEST_F(FrfProgram, WritesFilesThatItComparesWithItselfAndAPicture) {
  const std::string scene = write("mass.yaml", one_mass);
  const std::vector<std::string> range{"--from", "1", "--to", "30", "--points", "59"};
  const auto with_range = [&](std::vector<std::string> arguments) {
    arguments.insert(arguments.begin(), scene);
    arguments.insert(arguments.end(), range.begin(), range.end());
    return arguments;
  };
  json_of(with_range({"--input", "slider.mass.x", "--output", "slider.mass.x.velocity", "-o",
                      path("frf.h5"), "-o", path("frf.uff"), "--figure", path("frf.svg")}));
  EXPECT_THAT(contents_of(path("frf.svg")),
              AllOf(HasSubstr("mobility (m/s/N)"), HasSubstr("phase (deg)"),
                    HasSubstr("slider.mass.x.velocity per slider.mass.x")));
  const UffFunctions written = read_uff_functions_file(path("frf.uff"));
  ASSERT_EQ(written.functions.size(), 1u);
  EXPECT_EQ(written.functions[0].response, (UffDof{1, 1}));

  const hid_t file = H5Fopen(path("frf.h5").c_str(), H5F_ACC_RDONLY, H5P_DEFAULT);
  ASSERT_GE(file, 0);
  std::vector<double> real(59);
  EXPECT_GE(H5LTread_dataset_double(
                file, "/responses/slider.mass.x.velocity/slider.mass.x/real", real.data()),
            0);
  H5Fclose(file);
  EXPECT_NEAR(real[10], written.functions[0].values[10].real(), 1e-12 * std::abs(real[10]));

  // As accelerance of the same point; the only response of the file needs no name.
  const Json same = json_of(with_range({"--input", "slider.mass.x", "--compare", path("frf.uff")}));
  EXPECT_NEAR(same["compared"][0]["frac"].get<double>(), 1.0, 1e-12);
  EXPECT_NEAR(same["compared"][0]["ratio"].get<double>(), 1.0, 1e-11);
  EXPECT_EQ(same["compared"][0]["output"], "slider.mass.x.velocity");
  // Half the mass: another response.
  const Json other = json_of(with_range({"--input", "slider.mass.x", "--compare", path("frf.uff"),
                                         "--node", "1=slider.mass", "--set",
                                         "substructures.slider.masses.mass.mass=1"}));
  EXPECT_LT(other["compared"][0]["frac"].get<double>(), 0.9);
}

// Receptance and accelerance have axes of their own.
TEST_F(FrfProgram, APictureHasARowOfDiagramsForEachUnit) {
  const std::string scene = write("mass.yaml", one_mass);
  json_of({scene, "--input", "slider.mass.x", "--output", "slider.mass.x.displacement", "--output",
           "slider.mass.x.acceleration", "--from", "1", "--to", "30", "--points", "30", "--figure",
           path("frf.svg")});
  EXPECT_THAT(contents_of(path("frf.svg")),
              AllOf(HasSubstr("receptance ("), HasSubstr("accelerance ("), Not(HasSubstr("SI"))));
}

// One mass with 1/s² = 1 - x² + 2 i D x: its circle is as wide as 1/2D, which six points do not
// show.
TEST(ResolvedCurves, LeaveNoChordsOfAResonance) {
  const auto at = [](const std::vector<double>& frequencies) {
    std::vector<ResponseCurve> curves{{"a.b.x.displacement", "a.b.x", "m/N", {}}};
    for (const double x : frequencies)
      curves[0].values.push_back(1.0 / std::complex<double>(1.0 - x * x, 2e-3 * x));
    return curves;
  };
  const std::vector<double> few{0.5, 0.7, 0.9, 1.1, 1.3, 1.5};
  const auto [frequencies, curves] = resolved_curves(few, at(few), at);
  ASSERT_EQ(frequencies.size(), curves[0].values.size());
  EXPECT_TRUE(std::is_sorted(frequencies.begin(), frequencies.end()));
  for (const double one : few)
    EXPECT_TRUE(std::binary_search(frequencies.begin(), frequencies.end(), one));
  double most = 0.0, longest = 0.0;
  for (std::size_t i = 0; i < frequencies.size(); ++i) {
    EXPECT_EQ(curves[0].values[i], at({frequencies[i]})[0].values[0]);
    most = std::max(most, std::abs(curves[0].values[i]));
    if (i > 0) longest = std::max(longest, std::abs(curves[0].values[i] - curves[0].values[i - 1]));
  }
  EXPECT_NEAR(most, 500.0, 5.0);
  EXPECT_LT(longest, 0.03 * most);
  EXPECT_LT(frequencies.size(), 400U);
}

TEST_F(FrfProgram, MeasuredDirectionsMayBeNegativeAndTheRestIsNamed) {
  const std::string scene = write("mass.yaml", one_mass);
  const std::vector<std::string> asked{scene,    "--input", "slider.mass.x", "--input",
                                       "slider.mass.y", "--from",  "1",     "--to",
                                       "30",     "--points", "59"};
  std::vector<std::string> writing = asked;
  writing.insert(writing.end(), {"-o", path("frf.uff")});
  json_of(writing);
  std::string text = contents_of(path("frf.uff"));
  // The first function, x per x, as if measured along −x and hit along +x.
  const std::string dofs = "NONE               1   1 NONE               1   1";
  ASSERT_NE(text.find(dofs), std::string::npos);
  text.replace(text.find(dofs), dofs.size(), "NONE               1  -1 NONE               1   1");
  std::vector<std::string> comparing = asked;
  comparing.insert(comparing.end(),
                   {"--compare", write("turned.uff", text), "--node", "1=slider.mass"});
  const Json object = json_of(comparing);
  ASSERT_EQ(object["compared"].size(), 4u);
  EXPECT_NEAR(object["compared"][0]["frac"].get<double>(), 1.0, 1e-12);  // blind to the sign
  EXPECT_NEAR(object["compared"][3]["ratio"].get<double>(), 1.0, 1e-11);
  comparing.back() = "2=slider.mass";
  const ProgramResult unnamed = frf(comparing);
  EXPECT_EQ(unnamed.exit_code, 2);
  EXPECT_THAT(unnamed.err, AllOf(HasSubstr("nothing of the file can be compared"),
                                 HasSubstr("is of node 1, which no --node names")));
}

TEST_F(FrfProgram, RefusalsSayWhatToDo) {
  const std::string scene = write("mass.yaml", one_mass);
  const auto refused = [&](std::vector<std::string> arguments, const char* text) {
    arguments.insert(arguments.begin(), scene);
    arguments.insert(arguments.end(), {"--from", "1", "--to", "30"});
    const ProgramResult result = frf(arguments);
    EXPECT_EQ(result.exit_code, 2) << result.out;
    EXPECT_THAT(result.err, HasSubstr(text));
  };
  refused({"--input", "slider.mas.x"}, "has no point 'mas'");
  refused({"--input", "slide.mass.x"}, "did you mean 'slider'");
  refused({"--input", "slider.mass.z"}, "does not move");
  refused({"--input", "slider.mass.x", "--input", "slider.mass.x"}, "is given twice");
  refused({"--input", "slider.mass.x", "--output", "slider.mass.x"}, "--output");
  refused({"--input", "slider.mass.x", "-o", path("a.txt")}, "ends neither in .h5");
  refused({"--input", "slider.mass.x", "--node", "1=slider.mass"}, "give it with --compare");
  refused({"--input", "slider.mass.x", "--scale", "log", "--points", "1"}, "--points");
  const ProgramResult backwards =
      frf({scene, "--input", "slider.mass.x", "--from", "30", "--to", "1"});
  EXPECT_EQ(backwards.exit_code, 2);
  EXPECT_THAT(backwards.err, HasSubstr("lies below --from"));
  // Text holds six digits, in which these are the same.
  const ProgramResult close =
      frf({scene, "--input", "slider.mass.x", "--from", "10", "--to", "10.1", "--points", "2000",
           "--scale", "log", "-o", path("a.uff")});
  EXPECT_EQ(close.exit_code, 2);
  EXPECT_THAT(close.err, AllOf(HasSubstr("six digits"), HasSubstr("choose --binary")));
  EXPECT_FALSE(std::filesystem::exists(path("a.uff")));
  refused({"--input", "slider.mass.x", "--binary", "-o", path("a.h5")},
          "name one with -o FILE.uff");
  // Shapes are no responses.
  refused({"--input", "slider.mass.x", "--compare", scene_path("examples/reed.uff")},
          "which `stridor eig SCENE --compare FILE` sets beside those of a scene");
}

TEST_F(FrfProgram, UniversalFilesTakeAnyFrequenciesAndBinaryNumbers) {
  const std::string scene = write("mass.yaml", one_mass);
  const std::vector<std::string> asked{scene, "--input", "slider.mass.x", "--from",   "1", "--to",
                                       "30",  "--scale", "log",           "--points", "50"};
  const auto with = [&](const std::vector<std::string>& more) {
    std::vector<std::string> all = asked;
    all.insert(all.end(), more.begin(), more.end());
    return json_of(all);
  };
  const Json text = with({"-o", path("text.uff")});
  with({"-o", path("binary.uff"), "--binary"});
  const UffFunction whole = read_uff_functions_file(path("binary.uff")).functions.at(0);
  ASSERT_EQ(whole.abscissa.size(), 50u);
  for (std::size_t i = 0; i < 50; ++i) {
    EXPECT_EQ(whole.abscissa[i], text["frequencies"][i].get<double>());
    EXPECT_EQ(whole.values[i], value(text["responses"][0], i));
  }
  for (const char* file : {"text.uff", "binary.uff"}) {
    const Json compared = with({"--compare", path(file)})["compared"][0];
    // Frequencies of six digits move the response by less than its slope times 5e-6 of them; at the
    // resonance with a damping ratio of 0.024 that is 2e-4.
    EXPECT_NEAR(compared["frac"].get<double>(), 1.0, 1e-6) << file;
    EXPECT_NEAR(compared["ratio"].get<double>(), 1.0, 2e-4) << file;
    EXPECT_EQ(compared["points"], 50) << file;
  }
}

}  // namespace
}  // namespace stridor
