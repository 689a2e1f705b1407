#include "io/run_file/recorder.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "solvers/transient/march.hpp"
#include "substructures/bodies/beam.hpp"
#include "tests/support/message_of.hpp"
#include "tests/support/paper_model.hpp"
#include "tests/support/program.hpp"

namespace stridor {
namespace {

using namespace test;

/// Channels of the main scene, all motions of the free end and all quantities of the contact.
std::vector<Channel> all_channels(const ModelParameters& parameters) {
  RecordParameters record;
  record.channels = {"cantilever.free_end.y.displacement",
                     "cantilever.free_end.y.velocity",
                     "cantilever.free_end.y.acceleration",
                     "contact.force",
                     "contact.gap",
                     "contact.slip_velocity",
                     "contact.position",
                     "contact.friction_force",
                     "contact.state"};
  record.energy = true;
  return parse_channels(record, parameters);
}

/// Full load within 1 ms, so that there is something to record.
ModelParameters lively_model() {
  ModelParameters parameters = paper_model(leading_angle);
  parameters.drive->ramp = 1e-3;
  parameters.contact->armed_from = 1.0;
  return parameters;
}

RunFileReader record_run(const Model& model, const std::vector<Channel>& channels, double interval,
                         std::int64_t steps, const std::string& path) {
  Simulation simulation(model.system, paper_time(), Accounts::energy);
  RunFileWriter writer(path, Overwrite::yes, {}, Recorder::series(model, channels, 2e-7, interval));
  Recorder recorder(model, channels, 2e-7, interval, writer);
  MarchPlan plan;
  plan.last_step = steps + recorder.latency();
  EXPECT_EQ(march(simulation, &recorder, plan).end, MarchEnd::finished) << simulation.failure();
  writer.close();
  return RunFileReader(path);
}

TEST(Recorder, WithOneStepPerSampleWritesWhatTheSimulationHolds) {
  const TemporaryFolder folder;
  const ModelParameters parameters = lively_model();
  const Model model = make_paper_model(parameters);
  const auto channels = all_channels(parameters);
  const RunFileReader file = record_run(model, channels, 2e-7, 500, (folder / "a.h5").string());
  const Model::Point point = model.points.at(free_end);
  Simulation simulation(model.system, paper_time(), Accounts::energy);
  const auto displacement = file.series("/channels/cantilever.free_end.y.displacement");
  const auto force = file.series("/contact/contact/force");
  const auto slip = file.series("/contact/contact/slip_velocity");
  const auto position = file.series("/contact/contact/position");
  const auto friction = file.series("/contact/contact/friction_force");
  const auto state = file.series("/contact/contact/state");
  const auto kinetic = file.series("/energy/kinetic");
  const auto error = file.series("/energy/balance_error");
  for (std::size_t n = 0; n <= 500; ++n) {
    EXPECT_EQ(displacement[n], simulation.displacement(point.body, point.rows.y));
    EXPECT_EQ(force[n], simulation.contact_force(0));
    EXPECT_EQ(slip[n], simulation.slip_velocity(0));
    EXPECT_EQ(position[n], simulation.contact_place(0).position);
    EXPECT_EQ(friction[n], simulation.friction_force(0));
    EXPECT_EQ(state[n], static_cast<double>(simulation.contact_state(0)));
    EXPECT_EQ(kinetic[n], simulation.energy()->balance().kinetic);
    EXPECT_EQ(error[n], simulation.energy()->balance().balance_error);
    simulation.step();
  }
}

TEST(Recorder, LooksOftenEnoughThatNothingFoldsIntoTheRecord) {
  // The same record made from every step and from every tenth differ only by the ripple of the two
  // filters (1e-4 of the signal each) and by what a coarser look folds back.
  const TemporaryFolder folder;
  const ModelParameters parameters = lively_model();
  const Model model = make_paper_model(parameters);
  const auto channels = all_channels(parameters);
  EXPECT_EQ(sampling_stride(model.system, 2e-7, 50), 10);
  const RunFileReader thinned =
      record_run(model, channels, 1e-5, 25'000, (folder / "a.h5").string());
  const RunFileReader full = record_run(model, channels, 2e-7, 25'000, (folder / "b.h5").string());
  for (const std::string name :
       {"/channels/cantilever.free_end.y.displacement", "/channels/cantilever.free_end.y.velocity",
        "/contact/contact/force_low_passed", "/contact/contact/slip_velocity",
        "/contact/contact/friction_force_low_passed"}) {
    const auto from_some = thinned.series(name);
    const auto all = full.series(name);
    Decimator decimator(std::make_shared<const DecimationFilter>(2e-7, 50));
    std::vector<double> from_all;
    for (const double value : all) {
      if (decimator.push(value)) from_all.push_back(decimator.value(Derivative::none));
    }
    double largest = 0.0;
    double difference = 0.0;
    for (std::size_t k = 0; k < std::min(from_all.size(), from_some.size()); ++k) {
      largest = std::max(largest, std::abs(from_all[k]));
      difference = std::max(difference, std::abs(from_all[k] - from_some[k]));
    }
    EXPECT_LT(difference, 2e-4 * largest) << name;
  }
}

TEST(Recorder, ForcesStatesAndEnergiesStandUnfilteredBesideFilteredRows) {
  // FiLM sticks, slips and lifts off here. Every row of a state or an energy is what the simulation
  // holds at the time of that row, whatever the low-pass of the other columns has seen before.
  const TemporaryFolder folder;
  ModelParameters parameters = paper_model(trailing_angle, ContactAssumption::film);
  parameters.drive->ramp = 1e-3;
  const Model model = make_paper_model(parameters);
  const auto channels = all_channels(parameters);
  const RunFileReader file =
      record_run(model, channels, 1e-5, 25'000, (folder / "film.h5").string());
  ASSERT_GE(file.times().size(), 501u);
  const auto state = file.series("/contact/contact/state");
  const auto force = file.series("/contact/contact/force");
  const auto friction = file.series("/contact/contact/friction_force");
  const auto friction_loss = file.series("/energy/friction_loss");
  const auto strain = file.series("/energy/strain");
  Simulation simulation(model.system, paper_time(), Accounts::energy);
  std::array<int, 3> seen{};
  for (std::size_t k = 0; k <= 500; ++k) {
    ASSERT_EQ(simulation.step_until(static_cast<std::int64_t>(50 * k)), StepOutcome::done);
    ASSERT_EQ(state[k], static_cast<double>(simulation.contact_state(0))) << k;
    ASSERT_EQ(force[k], simulation.contact_force(0)) << k;
    ASSERT_EQ(friction[k], simulation.friction_force(0)) << k;
    ASSERT_EQ(friction_loss[k], simulation.energy()->balance().friction_loss) << k;
    ASSERT_EQ(strain[k], simulation.energy()->balance().strain) << k;
    ++seen[static_cast<std::size_t>(state[k])];
  }
  for (const int count : seen) EXPECT_GT(count, 0);

  const auto text = [&](const std::string& path, const std::string& name) {
    return std::get<std::string>(file.attributes(path).at(name));
  };
  EXPECT_EQ(text("/contact/contact/state", "meaning"), "0 open, 1 stick, 2 slip");
  EXPECT_EQ(text("/contact/contact/state", "filter"), "none");
  EXPECT_EQ(text("/energy/strain", "filter"), "none");
  EXPECT_EQ(text("/energy/strain", "definition"), "strain energy, half a time step before the row");
  EXPECT_EQ(file.units("/energy/strain"), "J");
  EXPECT_EQ(text("/contact/contact/force", "filter"), "none");
  EXPECT_EQ(text("/contact/contact/friction_force", "filter"), "none");
  EXPECT_NE(text("/contact/contact/force_low_passed", "filter"), "none");
  EXPECT_NE(text("/contact/contact/friction_force_low_passed", "filter"), "none");
  EXPECT_EQ(text("/contact/contact/force_max", "long_name"),
            "largest contact force of all steps since the row before");
  EXPECT_EQ(text("/contact/contact/friction_force_min", "long_name"),
            "least friction force of all steps since the row before");
  EXPECT_EQ(text("/contact/contact/friction_force", "acts_at"),
            "the time of the same row of /time");
}

TEST(Recorder, IntervalsHoldEveryStepBetweenTheRows) {
  // A FiLM contact that lifts off and lands between rows, recorded every 50 steps.
  const TemporaryFolder folder;
  ModelParameters parameters = paper_model(trailing_angle, ContactAssumption::film);
  parameters.drive->ramp = 1e-3;
  const Model model = make_paper_model(parameters);
  const auto channels = all_channels(parameters);
  const RunFileReader file =
      record_run(model, channels, 1e-5, 25'000, (folder / "film.h5").string());
  const auto least = file.series("/contact/contact/force_min");
  const auto largest = file.series("/contact/contact/force_max");
  const auto least_friction = file.series("/contact/contact/friction_force_min");
  const auto largest_friction = file.series("/contact/contact/friction_force_max");
  const auto sticking = file.series("/contact/contact/stick_fraction");
  const auto open = file.series("/contact/contact/open_fraction");
  Simulation simulation(model.system, paper_time(), Accounts::energy);
  int num_hidden_peaks = 0;
  for (std::size_t k = 0; k <= 500; ++k) {
    ContactStatistics expected;
    do {
      if (k > 0) {
        ASSERT_EQ(simulation.step(), StepOutcome::done);
      }
      const double force = simulation.contact_force(0);
      const double friction = simulation.friction_force(0);
      const ContactState state = simulation.contact_state(0);
      expected.add({force, force, friction, friction, 1, state == ContactState::stick ? 1 : 0,
                    state == ContactState::open ? 1 : 0});
    } while (simulation.step_index() % 50 != 0);
    ASSERT_EQ(least[k], expected.force_min) << k;
    ASSERT_EQ(largest[k], expected.force_max) << k;
    ASSERT_EQ(least_friction[k], expected.friction_min) << k;
    ASSERT_EQ(largest_friction[k], expected.friction_max) << k;
    const auto steps = static_cast<double>(expected.steps);
    ASSERT_EQ(sticking[k], static_cast<double>(expected.sticking) / steps) << k;
    ASSERT_EQ(open[k], static_cast<double>(expected.open) / steps) << k;
    if (expected.force_min == 0.0 && simulation.contact_force(0) > 0.0) ++num_hidden_peaks;
  }
  EXPECT_GT(num_hidden_peaks, 0) << "the test needs openings that no row shows";
}

TEST(Recorder, UnilateralForcesAreNeverNegativeInAnySeriesButTheLowPassedOne) {
  const TemporaryFolder folder;
  ModelParameters parameters = paper_model(trailing_angle, ContactAssumption::film);
  parameters.drive->ramp = 1e-3;
  const Model model = make_paper_model(parameters);
  const auto channels = all_channels(parameters);
  const RunFileReader file =
      record_run(model, channels, 1e-5, 25'000, (folder / "film.h5").string());
  const auto least_of = [&](const char* name) {
    const auto values = file.series(name);
    return *std::min_element(values.begin(), values.end());
  };
  EXPECT_EQ(least_of("/contact/contact/force"), 0.0);
  EXPECT_EQ(least_of("/contact/contact/force_min"), 0.0);
  EXPECT_LT(least_of("/contact/contact/force_low_passed"), 0.0);
}

TEST(Recorder, RefusesEnergiesThatTheSimulationDoesNotKeep) {
  const TemporaryFolder folder;
  const ModelParameters parameters = lively_model();
  const Model model = make_paper_model(parameters);
  const auto channels = all_channels(parameters);
  RunFileWriter writer((folder / "a.h5").string(), Overwrite::no, {},
                       Recorder::series(model, channels, 2e-7, 1e-5));
  Recorder recorder(model, channels, 2e-7, 1e-5, writer);
  const Simulation simulation(model.system, paper_time());
  EXPECT_EQ(message_of<std::invalid_argument>([&] { recorder.sample(simulation); }),
            "Recorder: the simulation keeps no account of its energy");
}

TEST(Recorder, StrideFollowsTheRingingModesAndTheRatio) {
  const Model model = make_paper_model(paper_model());
  EXPECT_EQ(sampling_stride(model.system, 2e-7, 1), 1);
  EXPECT_EQ(sampling_stride(model.system, 2e-7, 7), 1);
  // At least five looks per sample.
  EXPECT_EQ(sampling_stride(model.system, 2e-7, 10), 2);
  ModelParameters undamped = paper_model();
  for (auto& [name, body] : undamped.substructures) body.get<BeamParameters>().damping.beta = 0.0;
  // 967 kHz ring on, so 967 + 60 kHz are needed: of the divisors 1, 2, 5, 10 of 50 only 2 gives it.
  EXPECT_EQ(sampling_stride(make_paper_model(undamped).system, 2e-7, 50), 2);
}

TEST(Recorder, GoesOnBitwiseAfterSaveAndLoad) {
  const TemporaryFolder folder;
  const ModelParameters parameters = lively_model();
  const Model model = make_paper_model(parameters);
  const auto channels = all_channels(parameters);
  const auto straight =
      record_run(model, channels, 1e-5, 10'000, (folder / "straight.h5").string());

  const std::string path = (folder / "resumed.h5").string();
  RunFileWriter writer(path, Overwrite::no, {}, Recorder::series(model, channels, 2e-7, 1e-5));
  State state;
  {
    Simulation simulation(model.system, paper_time(), Accounts::energy);
    Recorder recorder(model, channels, 2e-7, 1e-5, writer);
    MarchPlan plan;
    plan.last_step = 4321;
    ASSERT_EQ(march(simulation, &recorder, plan).end, MarchEnd::finished);
    state = simulation.save();
    recorder.save(state, "recorder/");
  }
  Simulation simulation(model.system, paper_time(), Accounts::energy);
  Recorder recorder(model, channels, 2e-7, 1e-5, writer);
  simulation.load(state);
  recorder.load(state, "recorder/");
  MarchPlan plan;
  plan.last_step = 10'000 + recorder.latency();
  ASSERT_EQ(march(simulation, &recorder, plan).end, MarchEnd::finished);
  writer.close();
  const RunFileReader resumed(path);
  EXPECT_EQ(resumed.times(), straight.times());
  for (const std::string& name : straight.series_names())
    EXPECT_EQ(resumed.series(name), straight.series(name)) << name;
}

TEST(Recorder, HorizontalMotionOfADrivenBodyIncludesTheDrive) {
  const TemporaryFolder folder;
  ModelParameters parameters = lively_model();
  RecordParameters record;
  record.channels = {"oblique.end_top.x.displacement"};
  const auto channels = parse_channels(record, parameters);
  const Model model = make_model(parameters, {{*channels[0].point, channels[0].key}});
  const RunFileReader file = record_run(model, channels, 2e-7, 10'000, (folder / "a.h5").string());
  // The guided end follows the drive exactly: v (t − ramp/2).
  EXPECT_NEAR(file.series("/channels/oblique.end_top.x.displacement").at(10'000),
              0.030 * (2e-3 - 0.5e-3), 1e-17);
}

}  // namespace
}  // namespace stridor
