// The transients of the main scene with each assumption, against an independent computation of
// them.
//
// The reference values come from a prototype written apart from this program in another language
// with the same equations and step (docs/theory.md, 5). Contact forces agree to 1e-4; bursts are
// amplified noise, so 5 % are allowed in their r.m.s. and 10 % in peaks, which the low-pass of the
// channels touches.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "analysis/band_pass.hpp"
#include "analysis/bursts.hpp"
#include "analysis/statistics.hpp"
#include "io/run_file/recorder.hpp"
#include "io/scene/scene.hpp"
#include "solvers/transient/march.hpp"
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

/// A scene marched to its end and recorded.
struct Transient {
  MarchResult result;
  std::string failure;
  double end = 0.0;                  ///< time reached, s
  std::vector<double> acceleration;  ///< of the free end, recorded, m/s²
  double interval = 0.0;             ///< of the record, s
  ViolationCount violations;

  double peak_in(double from, double to) const { return peak(window(from, to).of(acceleration)); }
  /// r.m.s. between 2.5 and 15 kHz.
  double rms_in(double from, double to) const {
    return rms(window(from, to).of(band_pass(acceleration, interval, {2500.0, 15000.0})));
  }
  const ContactStatistics& statistics() const { return result.statistics.at(0).value(); }

 private:
  IndexRange window(double from, double to) const {
    return samples_in({from, to}, 0.0, interval, acceleration.size());
  }
};

/// @param measure_from start of the contact statistics, s
Transient run_scene(const char* name, const std::vector<std::string>& overrides,
                    double measure_from = 0.25) {
  const TemporaryFolder folder;
  const std::string path = (folder / "run.h5").string();
  const LoadedScene loaded = load_scene(scene_path(name), overrides);
  const Scene& scene = loaded.scene;
  const Model model = build_model(loaded);
  Simulation simulation(model.system, *scene.time);
  const auto channels = parse_channels(*scene.record, scene.model);
  const double interval = scene.record->interval;
  RunFileWriter writer(path, Overwrite::no, {},
                       Recorder::series(model, channels, scene.time->step, interval));
  Recorder recorder(model, channels, scene.time->step, interval, writer);
  const auto step_at = [&](double time) {
    return static_cast<std::int64_t>(std::llround(time / scene.time->step));
  };
  MarchPlan plan;
  plan.last_step = step_at(scene.time->end) + recorder.latency();
  plan.measure_from = step_at(measure_from);
  plan.measure_to = plan.last_step;
  Transient transient;
  transient.result = march(simulation, &recorder, plan);
  transient.failure = simulation.failure();
  transient.end = simulation.time();
  transient.interval = interval;
  transient.violations = simulation.violations(0);
  writer.close();
  transient.acceleration =
      RunFileReader(path).series("/channels/cantilever.free_end.y.acceleration");
  return transient;
}

class TransientTableTest : public ::testing::TestWithParam<Row> {};

TEST_P(TransientTableTest, AgreesWithTheReference) {
  const Row& row = GetParam();
  const Transient run = run_scene(row.scene, {std::string("contact.assumption=") + row.assumption});
  ASSERT_EQ(run.result.end, MarchEnd::finished) << run.failure;

  EXPECT_NEAR(run.statistics().force_min, row.force_min, 1e-4 * row.force_min);
  EXPECT_NEAR(run.statistics().force_max, row.force_max, 1e-4 * row.force_max);
  EXPECT_NEAR(run.peak_in(0.4, 2.25), row.peak, 0.10 * row.peak);
  EXPECT_NEAR(run.rms_in(0.6, 1.3), row.quiet, 0.05 * row.quiet);
  EXPECT_NEAR(run.rms_in(1.45, 1.6), row.b1, 0.05 * row.b1);
  EXPECT_NEAR(run.rms_in(1.75, 1.95), row.b2, 0.05 * row.b2);
  EXPECT_NEAR(run.rms_in(2.05, 2.15), row.b3, 0.05 * row.b3);
  EXPECT_NEAR(run.rms_in(2.15, 2.24), row.b4, 0.05 * row.b4);

  // Three bursts near 3.5 kHz with the assumptions that let the contact point vibrate, and during
  // the third one of 10.6 kHz; none without.
  BurstParameters parameters;
  parameters.band = {2500.0, 15000.0};
  parameters.measured = {0.4, 2.25};
  const std::vector<Burst> bursts = find_bursts(run.acceleration, run.interval, parameters);
  const bool has_bursts = std::string(row.assumption) != "subs_a";
  ASSERT_EQ(bursts.size(), has_bursts ? 4u : 0u);
  for (const Burst& burst : bursts) {
    const double wanted = &burst == &bursts.back() ? 10570.0 : 3520.0;
    EXPECT_NEAR(burst.frequency, wanted, 0.02 * wanted);
    EXPECT_GT(burst.gain, 2.5);
  }
  if (has_bursts) {
    EXPECT_NEAR(bursts[0].start, 1.52, 0.05);
    EXPECT_NEAR(bursts[1].start, 1.78, 0.05);
    EXPECT_NEAR(bursts[2].start, 2.08, 0.05);
  }

  // Violations of persistent sliding end with the start-up.
  EXPECT_LT(run.violations.last_time, 7e-3);
}

constexpr const char* trailing = "beam_on_beam.yaml";
constexpr const char* leading = "beam_on_beam_leading.yaml";

INSTANTIATE_TEST_SUITE_P(
    Rows, TransientTableTest,
    ::testing::Values(
        Row{trailing, "subs_a", 0.048, 0.19997, 0.20002, 4.0e-3, 4.5e-3, 3.6e-3, 5.8e-3, 5.4e-3},
        Row{trailing, "subs_b", 3.247, 0.19751, 0.19976, 4.3e-3, 5.17e-2, 0.407, 0.851, 0.786},
        Row{trailing, "film", 3.246, 0.19751, 0.19976, 4.3e-3, 5.17e-2, 0.407, 0.851, 0.785},
        Row{trailing, "subs_c", 17.99, 0.19469, 0.20530, 4.2e-3, 6.5e-2, 0.947, 4.32, 4.62},
        Row{leading, "subs_a", 0.063, 0.19998, 0.20002, 4.6e-3, 5.4e-3, 4.1e-3, 7.1e-3, 6.3e-3},
        Row{leading, "subs_b", 2.934, 0.19774, 0.19977, 4.9e-3, 4.7e-2, 4.8e-2, 0.974, 0.305},
        Row{leading, "film", 2.933, 0.19774, 0.19977, 4.9e-3, 4.7e-2, 4.8e-2, 0.974, 0.305},
        Row{leading, "subs_c", 1.501, 0.19962, 0.20038, 4.8e-3, 5.7e-2, 9.6e-2, 0.493, 0.260}));

TEST(ExactTransient, GivesTheBurstsWithASixteenthOfTheStepsAndModes) {
  // 40 of 243 modes move. The step is 17 times that of the table; the reference has an envelope
  // error of 1.2 % itself.
  for (const char* scene : {trailing, leading}) {
    const std::vector<std::string> fast{"time.integrator=exact", "time.step=3.3333333333e-6",
                                        "time.retain.frequency=50 kHz"};
    const Transient published = run_scene(scene, {});
    const Transient run = run_scene(scene, fast);
    ASSERT_EQ(run.result.end, MarchEnd::finished) << run.failure;
    EXPECT_NEAR(run.statistics().force_min, published.statistics().force_min, 2e-5);
    EXPECT_NEAR(run.statistics().force_max, published.statistics().force_max, 2e-5);
    const double windows[][2] = {{0.6, 1.3}, {1.45, 1.6}, {1.75, 1.95}, {2.05, 2.15}, {2.15, 2.24}};
    for (const auto& [from, to] : windows) {
      EXPECT_NEAR(run.rms_in(from, to), published.rms_in(from, to),
                  0.03 * published.rms_in(from, to))
          << scene << " from " << from;
    }
  }
}

class FilmTest : public ::testing::TestWithParam<const char*> {};

TEST_P(FilmTest, AgreesWithSubsBWhereSlidingPersists) {
  // After the start-up both compute the same; what differs is the seed of the bursts that the
  // start-up has left.
  const Transient subs_b = run_scene(GetParam(), {"contact.assumption=subs_b"});
  const Transient film = run_scene(GetParam(), {"contact.assumption=film"});
  ASSERT_EQ(subs_b.result.end, MarchEnd::finished) << subs_b.failure;
  ASSERT_EQ(film.result.end, MarchEnd::finished) << film.failure;
  EXPECT_NEAR(film.peak_in(0.4, 2.25), subs_b.peak_in(0.4, 2.25), 1e-3 * subs_b.peak_in(0.4, 2.25));
  const double windows[][2] = {{1.45, 1.6}, {1.75, 1.95}, {2.05, 2.15}, {2.15, 2.24}};
  for (const auto& [from, to] : windows) {
    EXPECT_NEAR(film.rms_in(from, to), subs_b.rms_in(from, to), 1e-3 * subs_b.rms_in(from, to))
        << from;
  }
  EXPECT_NEAR(film.statistics().force_min, subs_b.statistics().force_min, 2e-6);
  EXPECT_NEAR(film.statistics().force_max, subs_b.statistics().force_max, 2e-6);
  EXPECT_EQ(film.statistics().sticking, 0);
  EXPECT_EQ(film.statistics().open, 0);
}

INSTANTIATE_TEST_SUITE_P(Scenes, FilmTest, ::testing::Values(trailing, leading));

// With μ = 0.5 the leading beam loses persistent sliding at 2.06 s.

const std::string strong_friction = "contact.friction.coefficient=0.5";

TEST(StrongFriction, SubsBStopsWhereTheSlidingVelocityReverses) {
  const Transient run = run_scene(leading, {strong_friction});
  EXPECT_EQ(run.result.end, MarchEnd::failed);
  EXPECT_NEAR(run.end, 2.059, 1.5e-3);  // 2.060 s by the independent calculation
  EXPECT_THAT(run.failure, ::testing::HasSubstr("against the drive: real bodies would stick"));
  EXPECT_THAT(run.failure, ::testing::HasSubstr("contact.on_violation: unilateral"));
}

TEST(StrongFriction, StickAndLiftOffBoundTheMotion) {
  // FiLM from the start, and Subs-b that turns unilateral where it would have stopped.
  double peaks[2] = {};
  int k = 0;
  for (const char* choice : {"contact.assumption=film", "contact.on_violation=unilateral"}) {
    const Transient run = run_scene(leading, {strong_friction, choice}, 2.06);
    ASSERT_EQ(run.result.end, MarchEnd::finished) << run.failure;
    const ContactStatistics& statistics = run.statistics();
    EXPECT_GT(statistics.sticking, 0);
    EXPECT_GT(statistics.open, 0);
    EXPECT_LT(statistics.sticking + statistics.open, statistics.steps);
    EXPECT_EQ(statistics.force_min, 0.0);
    EXPECT_LT(statistics.force_max, 20.0);  // landings of a tip pressed with 0.2 N
    peaks[k++] = run.peak_in(2.06, 2.25);
  }
  // The details of a motion with impacts differ, its size does not.
  EXPECT_LT(std::abs(std::log2(peaks[0] / peaks[1])), 1.0);
}

}  // namespace
}  // namespace stridor
