// The transients of the main scene with each assumption, against an independent computation of
// them.
//
// The reference values come from a prototype written apart from this program in another language
// with the same equations and step (docs/theory.md, 5.1). Contact forces agree to 1e-4; bursts are
// amplified noise, so 5 % are allowed in their r.m.s. and 10 % in peaks, which the low-pass of the
// channels touches.
#include <gtest/gtest.h>

#include <cmath>

#include "analysis/band_pass.hpp"
#include "analysis/bursts.hpp"
#include "analysis/statistics.hpp"
#include "io/recorder.hpp"
#include "io/scene.hpp"
#include "solvers/march.hpp"
#include "tests/support/program.hpp"

namespace stridor {
namespace {

using namespace test;

struct Row {
  const char* scene;
  const char* assumption;
  double peak;       ///< of the free end's acceleration after 0.4 s, m/s²
  double force_min;  ///< after 0.25 s, N
  double force_max;
  double quiet, b1, b2, b3, b4;  ///< r.m.s. between 2.5 and 15 kHz in windows, m/s²
};

void PrintTo(const Row& row, std::ostream* stream) {
  *stream << row.scene << ' ' << row.assumption;
}

class TransientTableTest : public ::testing::TestWithParam<Row> {};

TEST_P(TransientTableTest, AgreesWithTheReference) {
  const Row& row = GetParam();
  const TemporaryFolder folder;
  const std::string path = (folder / "run.h5").string();
  const LoadedScene loaded =
      load_scene(scene_path(row.scene), {std::string("contact.assumption=") + row.assumption});
  const Scene& scene = loaded.scene;
  const Model model = build_model(loaded);
  Simulation simulation(model.system, scene.time);
  const auto channels = parse_channels(*scene.record, scene.model);
  const double interval = scene.record->interval;
  RunFileWriter writer(path, Overwrite::no, {},
                       Recorder::series(model, channels, scene.time.step, interval));
  Recorder recorder(model, channels, scene.time.step, interval, writer);
  MarchPlan plan;
  plan.last_step = static_cast<std::int64_t>(std::llround(scene.time.end / scene.time.step)) +
                   recorder.latency();
  plan.measure_from = static_cast<std::int64_t>(std::llround(0.25 / scene.time.step));
  plan.measure_to = plan.last_step;
  const MarchResult result = march(simulation, &recorder, plan);
  ASSERT_EQ(result.end, MarchEnd::finished) << simulation.failure();
  writer.close();

  ASSERT_TRUE(result.force_extremes.at(0).has_value());
  EXPECT_NEAR(result.force_extremes[0]->first, row.force_min, 1e-4 * row.force_min);
  EXPECT_NEAR(result.force_extremes[0]->second, row.force_max, 1e-4 * row.force_max);

  const RunFileReader file(path);
  const std::vector<double> acceleration =
      file.series("/channels/cantilever.free_end.y.acceleration");
  const auto window = [&](double from, double to) {
    return samples_in({from, to}, 0.0, interval, acceleration.size());
  };
  EXPECT_NEAR(peak(window(0.4, 2.25).of(acceleration)), row.peak, 0.10 * row.peak);
  const std::vector<double> band = band_pass(acceleration, interval, {2500.0, 15000.0});
  EXPECT_NEAR(rms(window(0.6, 1.3).of(band)), row.quiet, 0.05 * row.quiet);
  EXPECT_NEAR(rms(window(1.45, 1.6).of(band)), row.b1, 0.05 * row.b1);
  EXPECT_NEAR(rms(window(1.75, 1.95).of(band)), row.b2, 0.05 * row.b2);
  EXPECT_NEAR(rms(window(2.05, 2.15).of(band)), row.b3, 0.05 * row.b3);
  EXPECT_NEAR(rms(window(2.15, 2.24).of(band)), row.b4, 0.05 * row.b4);

  // Three bursts near 3.5 kHz with the assumptions that let the contact point vibrate, none
  // without.
  BurstParameters parameters;
  parameters.band = {2500.0, 15000.0};
  parameters.measured = {0.4, 2.25};
  const std::vector<Burst> bursts = find_bursts(acceleration, interval, parameters);
  const bool has_bursts = std::string(row.assumption) != "subs_a";
  ASSERT_EQ(bursts.size(), has_bursts ? 3u : 0u);
  for (const Burst& burst : bursts) {
    EXPECT_NEAR(burst.frequency, 3520.0, 0.02 * 3520.0);
    EXPECT_GT(burst.gain, 2.5);
  }
  if (has_bursts) {
    EXPECT_NEAR(bursts[0].start, 1.52, 0.05);
    EXPECT_NEAR(bursts[1].start, 1.78, 0.05);
    EXPECT_NEAR(bursts[2].start, 2.08, 0.05);
  }

  // Violations of persistent sliding end with the start-up.
  EXPECT_LT(simulation.violations(0).last_time, 7e-3);
}

constexpr const char* trailing = "beam_on_beam.yaml";
constexpr const char* leading = "beam_on_beam_leading.yaml";

INSTANTIATE_TEST_SUITE_P(
    Rows, TransientTableTest,
    ::testing::Values(
        Row{trailing, "subs_a", 0.048, 0.19997, 0.20002, 4.0e-3, 4.5e-3, 3.6e-3, 5.8e-3, 5.4e-3},
        Row{trailing, "subs_b", 3.247, 0.19751, 0.19976, 4.3e-3, 5.17e-2, 0.407, 0.851, 0.786},
        Row{trailing, "subs_c", 17.99, 0.19469, 0.20530, 4.2e-3, 6.5e-2, 0.947, 4.32, 4.62},
        Row{leading, "subs_a", 0.063, 0.19998, 0.20002, 4.6e-3, 5.4e-3, 4.1e-3, 7.1e-3, 6.3e-3},
        Row{leading, "subs_b", 2.934, 0.19774, 0.19977, 4.9e-3, 4.7e-2, 4.8e-2, 0.974, 0.305},
        Row{leading, "subs_c", 1.501, 0.19962, 0.20038, 4.8e-3, 5.7e-2, 9.6e-2, 0.493, 0.260}));

}  // namespace
}  // namespace stridor
