// `stridor cycle` on systems that are not one mass on a half-space.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <hdf5.h>
#include <hdf5_hl.h>

#include <cmath>
#include <nlohmann/json.hpp>

#include "tests/support/dataset.hpp"
#include "tests/support/program.hpp"

namespace stridor {
namespace {

using namespace test;
using ::testing::HasSubstr;

const std::string reed_scene = scene_path("examples/stick_slip_cycle.yaml");

nlohmann::json cycle_of(std::vector<std::string> arguments) {
  arguments.insert(arguments.begin(), "cycle");
  arguments.emplace_back("--json");
  const ProgramResult result = Program(arguments).run();
  EXPECT_EQ(result.exit_code, 0) << result.err;
  return nlohmann::json::parse(result.out, nullptr, false);
}

std::string cycle_error(std::vector<std::string> arguments) {
  arguments.insert(arguments.begin(), "cycle");
  const ProgramResult result = Program(arguments).run();
  EXPECT_EQ(result.exit_code, 2);
  return result.err;
}

TEST(CycleProgram, StickSlipOfABeamConvergesWithTheStep) {
  const TemporaryFolder folder;
  const std::string file = folder / "cycle.h5";
  const auto fine = cycle_of({reed_scene, "--verify", "-o", file});
  const auto coarse = cycle_of({reed_scene, "--set", "time.step=2e-6"});
  ASSERT_EQ(fine["status"], "periodic");
  EXPECT_EQ(fine["observed"], "x of the slave at contact");
  const double period = fine["period"].get<double>();
  // Steps of 0.5 µs give 9.97598 ms.
  EXPECT_NEAR(period, 9.97598e-3, 2e-7);
  EXPECT_NEAR(coarse["period"].get<double>(), period, 4e-7);
  EXPECT_NEAR(fine["step"].get<double>() * fine["steps"].get<double>(), period, 1e-15);
  const auto& largest = fine["multipliers"][0];
  EXPECT_NEAR(std::hypot(largest[0].get<double>(), largest[1].get<double>()), 0.4144, 1e-3);

  // One period, from a turn back to it.
  const std::vector<double> time = dataset(file, "/time");
  const std::vector<double> x = dataset(file, "/channels/observed.displacement");
  ASSERT_EQ(time.size(), x.size());
  EXPECT_NEAR(time.back(), period, 1e-12);
  EXPECT_NEAR(x.front(), x.back(), 1e-9);
  EXPECT_NEAR(*std::max_element(x.begin(), x.end()), fine["x"]["max"].get<double>(), 1e-8);
  const std::vector<double> state = dataset(file, "/contact/contact/state");
  const auto sticking = static_cast<double>(std::count(state.begin(), state.end(), 1.0));
  EXPECT_NEAR(sticking / static_cast<double>(state.size()), fine["stick_fraction"].get<double>(),
              3e-3);

  // The file says by itself what was printed.
  const std::vector<double> real = dataset(file, "/multipliers/real");
  ASSERT_EQ(real.size(), fine["multipliers"].size());
  EXPECT_EQ(real[0], largest[0].get<double>());
  EXPECT_EQ(dataset(file, "/multipliers/imaginary").at(0), largest[1].get<double>());
  const hid_t opened = H5Fopen(file.c_str(), H5F_ACC_RDONLY, H5P_DEFAULT);
  double stored = 0.0;
  EXPECT_GE(H5LTget_attribute_double(opened, "/", "period", &stored), 0);
  EXPECT_EQ(stored, period);
  EXPECT_GE(H5LTget_attribute_double(opened, "/", "x.rms", &stored), 0);
  EXPECT_EQ(stored, fine["x"]["rms"].get<double>());
  H5Fclose(opened);
}

TEST(CycleProgram, PrintsAndDraws) {
  const TemporaryFolder folder;
  const std::string picture = folder / "belt.png";
  const ProgramResult result =
      Program({"cycle", scene_path("examples/mass_on_belt.yaml"), "--figure", picture}).run();
  ASSERT_EQ(result.exit_code, 0) << result.err;
  for (const char* line :
       {"status                          periodic",
        "x is                    x of the slave at contact", "period                      0.671",
        "part of time sticking           0.29", "belt.png\n"})
    EXPECT_THAT(result.out, HasSubstr(line));
  EXPECT_GT(std::filesystem::file_size(picture), 10'000u);
  const ProgramResult many = Program({"cycle", reed_scene}).run();
  EXPECT_THAT(many.out, HasSubstr("smaller multipliers                   17"));
}

TEST(CycleProgram, MotionThatBreaksLooseUnevenlyIsIrregular) {
  const auto found = cycle_of({scene_path("examples/stick_slip.yaml"), "--set", "cycle.settle=0.3",
                               "--set", "time={integrator: exact, step: 1.0e-6, end: 0.4}"});
  EXPECT_EQ(found["status"], "irregular");
  EXPECT_TRUE(found["period"].is_null());
  EXPECT_TRUE(found["multipliers"].empty());
  EXPECT_GT(found["stick_fraction"].get<double>(), 0.8);
}

TEST(CycleProgram, RefusesWhatCannotRepeatItself) {
  const std::string beams = scene_path("beam_on_beam_limit_cycle.yaml");
  EXPECT_THAT(cycle_error({beams}), HasSubstr("cycle: missing: a limit cycle is sought after"));
  EXPECT_THAT(
      cycle_error({beams, "--set", "cycle.settle=0.1"}),
      HasSubstr("cycle: the motion cannot repeat itself: contact 'contact' moves along "
                "cantilever.top and comes to its end; hold its place by `sliding: frozen`"));
  EXPECT_THAT(cycle_error({scene_path("examples/gyroscopic.yaml"), "--set", "cycle.settle=0.1"}),
              HasSubstr("time: missing: `cycle` needs this section"));
  EXPECT_THAT(cycle_error({scene_path("examples/gyroscopic.yaml"), "--set", "cycle.settle=0.1",
                           "--set", "time={integrator: exact, step: 1 ms, end: 1}"}),
              HasSubstr("nothing touches its bodies"));
  EXPECT_THAT(cycle_error({reed_scene, "--set", "time={integrator: event_driven, end: 1}"}),
              HasSubstr("time.integrator"));
  EXPECT_THAT(cycle_error({reed_scene, "--set", "time.integrator=central_difference", "--set",
                           "time.step=1e-5"}),
              HasSubstr("time.step"));
}

TEST(CycleProgram, FailureOfTheRunIsOneOfNumbers) {
  const ProgramResult result =
      Program({"cycle", scene_path("examples/frozen_growth.yaml"), "--set", "cycle.settle=1"})
          .run();
  EXPECT_EQ(result.exit_code, 3);
  EXPECT_THAT(result.err, HasSubstr("persistent sliding"));
}

}  // namespace
}  // namespace stridor
