// How far a fast setting is from the finest one, over both beam scenes to their end.
#include <gtest/gtest.h>

#include <cmath>

#include "analysis/band_pass.hpp"
#include "io/scene/scene.hpp"
#include "solvers/transient/simulation.hpp"
#include "tests/support/program.hpp"
#include "tests/support/relative_difference.hpp"

namespace stridor {
namespace {

using namespace test;

constexpr double interval = 1e-5;

/// Acceleration of the free end between 1 and 15 kHz, by differences of the displacement.
std::vector<double> banded_acceleration(const char* scene, const std::vector<std::string>& sets) {
  const LoadedScene loaded = load_scene(scene_path(scene), sets);
  const Model model = build_model(loaded);
  const Model::Point tip = model.points.at({"cantilever", "free_end"});
  Simulation simulation(model.system, *loaded.scene.time);
  const std::int64_t stride = std::llround(interval / loaded.scene.time->step);
  const std::int64_t samples = std::llround(loaded.scene.time->end / interval);
  std::vector<double> u{0.0};
  for (std::int64_t n = 1; n <= samples; ++n) {
    if (simulation.step_until(n * stride) != StepOutcome::done) {
      ADD_FAILURE() << simulation.failure();
      break;
    }
    u.push_back(simulation.displacement(tip.body, tip.rows.y));
  }
  std::vector<double> acceleration(u.size(), 0.0);
  for (std::size_t i = 1; i + 1 < u.size(); ++i)
    acceleration[i] = (u[i + 1] - 2.0 * u[i] + u[i - 1]) / (interval * interval);
  return band_pass(acceleration, interval, {1000.0, 15000.0});
}

/// r.m.s. over 10 ms each, from 0.3 s on.
std::vector<double> envelope(const std::vector<double>& signal) {
  constexpr std::size_t window = 1000;
  std::vector<double> result;
  for (std::size_t first = 30'000; first + window <= signal.size(); first += window) {
    double sum = 0.0;
    for (std::size_t i = first; i < first + window; ++i) sum += signal[i] * signal[i];
    result.push_back(std::sqrt(sum / window));
  }
  return result;
}

class EnvelopeErrorTest : public ::testing::TestWithParam<const char*> {};

TEST_P(EnvelopeErrorTest, OfExactPropagationIsBelowHalfAPercent) {
  const std::vector<double> reference =
      envelope(banded_acceleration(GetParam(), {"time.integrator=exact", "time.step=5e-8"}));
  const auto error_of = [&](const std::string& step, const std::string& retained) {
    return relative_difference(
        envelope(banded_acceleration(GetParam(), {"time.integrator=exact", "time.step=" + step,
                                                  "time.retain.frequency=" + retained})),
        reference);
  };
  EXPECT_LT(error_of("5e-6", "30 kHz"), 0.005);
  EXPECT_LT(error_of("5e-6", "40 kHz"), 0.0035);
  EXPECT_LT(error_of("3.3333333333e-6", "50 kHz"), 0.0025);
  // All modes that the step resolves.
  EXPECT_LT(error_of("2e-6", "1 MHz"), 0.005);
  EXPECT_LT(error_of("1e-6", "1 MHz"), 0.002);
}

INSTANTIATE_TEST_SUITE_P(Scenes, EnvelopeErrorTest,
                         ::testing::Values("beam_on_beam.yaml", "beam_on_beam_leading.yaml"));

}  // namespace
}  // namespace stridor
