// Simulations stepped together in lanes.
#include "solvers/transient/batch.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <memory>
#include <stdexcept>
#include <string>
#include <vector>

#include "substructures/bodies/beam.hpp"
#include "tests/support/paper_model.hpp"

namespace stridor {
namespace {

using namespace test;

/// Outcome of one simulation: its whole state, and the position of the free end.
struct Fate {
  std::map<std::string, std::vector<double>> state;
  StepOutcome outcome;
  double tip;
};

/// The trailing scene with a short start-up; every kind has another friction, load and speed.
Model model_of_kind(int kind, ContactAssumption assumption = ContactAssumption::subs_b) {
  ModelParameters parameters = paper_model(trailing_angle, assumption);
  parameters.contact->friction->numbers["coefficient"] = 0.05 + 0.04 * kind;
  parameters.contact->armed_from = 1.0;
  parameters.contact->start = 0.0302 + 1e-4 * kind;
  parameters.drive->load = TimeCurve(-0.2 - 0.01 * kind);
  parameters.drive->velocity = TimeCurve(0.3 + 0.02 * kind);
  parameters.drive->ramp = 1e-3;
  auto& oblique = parameters.substructures["oblique"].get<BeamParameters>();
  oblique.damping.hold = 3e-3;
  oblique.damping.fade = 1e-3;
  return make_paper_model(parameters);
}

enum class Scheme { exact_with_residual, exact, central_difference, central_with_residual };

TimeParameters time_of_scheme(Scheme scheme) {
  TimeParameters time = paper_time(2e-7);
  if (scheme == Scheme::exact_with_residual || scheme == Scheme::exact) {
    time.integrator = Integrator::exact;
    time.step = 2e-6;
  }
  if (scheme == Scheme::exact_with_residual || scheme == Scheme::central_with_residual)
    time.retain = RetainParameters{50e3, {}};
  return time;
}

constexpr double run_end = 8e-3;  ///< s; start-up, 2 mm and the damping schedule

/// Steps these kinds in one batch, looking in between.
std::vector<Fate> fates(const std::vector<int>& kinds, const TimeParameters& time,
                        ContactAssumption assumption = ContactAssumption::subs_b) {
  std::vector<Model> models;
  std::vector<std::unique_ptr<Simulation>> simulations;
  std::vector<Simulation*> runs;
  for (const int kind : kinds) {
    models.push_back(model_of_kind(kind, assumption));
    simulations.push_back(std::make_unique<Simulation>(models.back().system, time));
    runs.push_back(simulations.back().get());
  }
  Batch batch(runs);
  const auto num_steps = static_cast<std::int64_t>(std::llround(run_end / time.step));
  for (int part = 1; part <= 7; ++part) batch.step_until(num_steps * part / 7);
  batch.synchronise();
  std::vector<Fate> fates;
  for (std::size_t i = 0; i < runs.size(); ++i) {
    const Model::Point tip = models[i].points.at(free_end);
    fates.push_back(
        {runs[i]->save().arrays(), batch.outcome(i), runs[i]->displacement(tip.body, tip.rows.y)});
  }
  return fates;
}

class BatchTest : public ::testing::TestWithParam<Scheme> {};

TEST_P(BatchTest, EndsAsWithoutABatchButForRounding) {
  const TimeParameters time = time_of_scheme(GetParam());
  const std::vector<Fate> together = fates({0, 1, 2, 3, 4, 5, 6, 7}, time);
  for (int kind = 0; kind < 8; ++kind) {
    const Model model = model_of_kind(kind);
    Simulation alone(model.system, time);
    ASSERT_EQ(alone.step_until(std::llround(run_end / time.step)), StepOutcome::done);
    const Fate& fate = together[static_cast<std::size_t>(kind)];
    EXPECT_EQ(fate.outcome, StepOutcome::done);
    const Model::Point tip = model.points.at(free_end);
    const double place = alone.displacement(tip.body, tip.rows.y);
    EXPECT_NEAR(fate.tip, place, 1e-11 * std::abs(place));
    const State saved = alone.save();
    const std::vector<double>& contact = saved.arrays().at("contacts/0");
    const std::vector<double>& of_lane = fate.state.at("contacts/0");
    ASSERT_EQ(of_lane.size(), contact.size());
    EXPECT_EQ(of_lane[0], contact[0]);  // segment
    for (std::size_t k = 1; k < contact.size(); ++k) {
      if (k == 8) continue;  // nothing is anchored where all slide
      EXPECT_NEAR(of_lane[k], contact[k], 1e-6 * std::abs(contact[k])) << k;
    }
  }
}

TEST_P(BatchTest, DependsNeitherOnTheOthersNorOnItsLane) {
  const TimeParameters time = time_of_scheme(GetParam());
  const std::vector<Fate> one = fates({3}, time);
  const std::vector<Fate> many = fates({7, 0, 5, 3, 1, 2, 3, 6, 4, 3}, time);
  for (const std::size_t place : {3u, 6u, 9u}) {
    EXPECT_EQ(many[place].state, one[0].state) << place;
    EXPECT_EQ(many[place].tip, one[0].tip) << place;
  }
  EXPECT_NE(many[0].state, one[0].state);
}

/// Takes the displacement of the free end after every third step.
class TipSink : public DisplacementSink {
 public:
  explicit TipSink(const Model& model) : tip_(model.points.at(free_end)) {}
  std::int64_t next_step() const override {
    return 3 * static_cast<std::int64_t>(displacements.size());
  }
  std::optional<Row> sole_row() const override { return Row{tip_.body, tip_.rows.y}; }
  void sample(const Simulation& simulation) override {
    sample_displacement(simulation.displacement(tip_.body, tip_.rows.y));
  }
  void sample_displacement(double displacement) override { displacements.push_back(displacement); }
  std::vector<double> displacements;

 private:
  Model::Point tip_;
};

/// Displacements recorded of these kinds on the way, in one batch.
std::vector<std::vector<double>> tips(const std::vector<int>& kinds, const TimeParameters& time,
                                      int num_parts) {
  std::vector<Model> models;
  std::vector<std::unique_ptr<Simulation>> simulations;
  std::vector<TipSink> sinks;
  std::vector<Simulation*> runs;
  for (const int kind : kinds) {
    models.push_back(model_of_kind(kind));
    sinks.emplace_back(models.back());
    simulations.push_back(std::make_unique<Simulation>(models.back().system, time));
    sinks.back().sample(*simulations.back());
    runs.push_back(simulations.back().get());
  }
  Batch batch(runs);
  for (std::size_t i = 0; i < runs.size(); ++i) batch.watch(i, sinks[i]);
  const auto num_steps = static_cast<std::int64_t>(std::llround(run_end / time.step));
  for (int part = 1; part <= num_parts; ++part) batch.step_until(num_steps * part / num_parts);
  std::vector<std::vector<double>> all;
  for (TipSink& sink : sinks) all.push_back(std::move(sink.displacements));
  return all;
}

TEST_P(BatchTest, ShowsARowOnTheWayAsTheSimulationWould) {
  const TimeParameters time = time_of_scheme(GetParam());
  const std::vector<std::vector<double>> together = tips({0, 1, 2, 3, 4}, time, 3);
  for (const int kind : {0, 3}) {
    const Model model = model_of_kind(kind);
    Simulation alone(model.system, time);
    TipSink sink(model);
    const auto num_steps = static_cast<std::int64_t>(std::llround(run_end / time.step));
    sink.sample(alone);
    while (sink.next_step() <= num_steps) {
      ASSERT_EQ(alone.step_until(sink.next_step()), StepOutcome::done);
      sink.sample(alone);
    }
    const std::vector<double>& seen = together[static_cast<std::size_t>(kind)];
    ASSERT_EQ(seen.size(), sink.displacements.size());
    double largest = 0.0;
    for (const double one : sink.displacements) largest = std::max(largest, std::abs(one));
    for (std::size_t i = 0; i < seen.size(); ++i)
      ASSERT_NEAR(seen[i], sink.displacements[i], 1e-11 * largest) << i;
  }
}

TEST_P(BatchTest, WhatItShowsDependsNeitherOnTheOthersNorOnWhereItStops) {
  const TimeParameters time = time_of_scheme(GetParam());
  const std::vector<std::vector<double>> one = tips({3}, time, 1);
  const std::vector<std::vector<double>> many = tips({7, 0, 5, 3, 1, 2, 3, 6, 4, 3}, time, 17);
  for (const std::size_t place : {3u, 6u, 9u}) EXPECT_EQ(many[place], one[0]) << place;
  EXPECT_NE(many[0], one[0]);
}

INSTANTIATE_TEST_SUITE_P(Schemes, BatchTest,
                         ::testing::Values(Scheme::exact_with_residual, Scheme::exact,
                                           Scheme::central_difference,
                                           Scheme::central_with_residual));

TEST(Batch, TakesEveryAssumptionOfPersistentSliding) {
  const TimeParameters time = time_of_scheme(Scheme::exact_with_residual);
  for (const ContactAssumption assumption :
       {ContactAssumption::subs_a, ContactAssumption::subs_b, ContactAssumption::subs_c}) {
    const std::vector<Fate> pair = fates({1, 2}, time, assumption);
    for (int kind = 1; kind <= 2; ++kind) {
      const Model model = model_of_kind(kind, assumption);
      Simulation alone(model.system, time);
      Batch lanes({&alone});
      EXPECT_TRUE(lanes.steps_in_lanes(0));
      ASSERT_EQ(alone.step_until(std::llround(run_end / time.step)), StepOutcome::done);
      const Model::Point tip = model.points.at(free_end);
      const double place = alone.displacement(tip.body, tip.rows.y);
      EXPECT_NEAR(pair[static_cast<std::size_t>(kind - 1)].tip, place, 1e-11 * std::abs(place));
    }
  }
}

TEST(Batch, WhatCannotBeInALaneStepsByItself) {
  const TimeParameters time = time_of_scheme(Scheme::exact_with_residual);
  const Model sliding = model_of_kind(0);
  const Model sticking = model_of_kind(1, ContactAssumption::film);
  Simulation in_lane(sliding.system, time);
  Simulation by_itself(sticking.system, time);
  Simulation same(sticking.system, time);
  Batch batch({&in_lane, &by_itself});
  EXPECT_TRUE(batch.steps_in_lanes(0));
  EXPECT_FALSE(batch.steps_in_lanes(1));
  batch.step_until(3000);
  ASSERT_EQ(same.step_until(3000), StepOutcome::done);
  EXPECT_EQ(by_itself.save().arrays(), same.save().arrays());
  EXPECT_EQ(in_lane.step_index(), 3000);
  TipSink sink(sticking);
  EXPECT_THROW(batch.watch(1, sink), std::invalid_argument);
}

TEST(Batch, ARunThatFailsStopsWhereItFailsAndTheOthersGoOn) {
  ModelParameters parameters = paper_model();
  parameters.drive->ramp = 0.0;
  parameters.contact->start = 0.0995;
  parameters.contact->armed_from = 1.0;
  const Model leaving = make_paper_model(parameters);
  const Model staying = model_of_kind(0);
  const TimeParameters time = time_of_scheme(Scheme::exact_with_residual);
  Simulation first(leaving.system, time);
  Simulation second(staying.system, time);
  Simulation alone(leaving.system, time);
  Batch batch({&first, &second});
  batch.step_until(12'000);
  EXPECT_EQ(batch.outcome(0), StepOutcome::master_lost);
  EXPECT_EQ(batch.outcome(1), StepOutcome::done);
  EXPECT_EQ(second.step_index(), 12'000);
  EXPECT_EQ(alone.step_until(12'000), StepOutcome::master_lost);
  EXPECT_EQ(first.step_index(), alone.step_index());
  EXPECT_EQ(first.failure(), alone.failure());
}

}  // namespace
}  // namespace stridor
