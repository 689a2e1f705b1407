#include "solvers/transient/march.hpp"

#include <gtest/gtest.h>

#include "core/stop_token.hpp"
#include "tests/support/paper_model.hpp"

namespace stridor {
namespace {

using namespace test;

/// Notes the steps at which it was called.
class NotingSink : public SampleSink {
 public:
  explicit NotingSink(std::int64_t every) : every_(every) {}
  std::int64_t next_step() const override { return next_; }
  void sample(const Simulation& simulation) override {
    steps.push_back(simulation.step_index());
    next_ += every_;
  }
  std::vector<std::int64_t> steps;

 private:
  std::int64_t every_;
  std::int64_t next_ = 0;
};

TEST(March, SamplesAtTheStepsThatTheSinkAsksForFromTheStart) {
  const Model model = make_paper_model(paper_model());
  Simulation simulation(model.system, paper_time());
  NotingSink sink(7);
  MarchPlan plan;
  plan.last_step = 30;
  EXPECT_EQ(march(simulation, &sink, plan).end, MarchEnd::finished);
  EXPECT_EQ(sink.steps, (std::vector<std::int64_t>{0, 7, 14, 21, 28}));
  EXPECT_EQ(simulation.step_index(), 30);
}

TEST(March, DoesNotChangeTheMotion) {
  const Model model = make_paper_model(paper_model());
  Simulation marched(model.system, paper_time());
  Simulation stepped(model.system, paper_time());
  NotingSink sink(3);
  MarchPlan plan;
  plan.last_step = 1000;
  ASSERT_EQ(march(marched, &sink, plan).end, MarchEnd::finished);
  ASSERT_EQ(stepped.step_until(1000), StepOutcome::done);
  EXPECT_EQ(marched.displacement(0, 0), stepped.displacement(0, 0));
  EXPECT_EQ(marched.contact_force(0), stepped.contact_force(0));
}

TEST(March, ForceExtremesAreThoseOfTheWindow) {
  const Model model = make_paper_model(paper_model());
  Simulation simulation(model.system, paper_time());
  Simulation reference(model.system, paper_time());
  MarchPlan plan;
  plan.last_step = 2500;
  plan.measure_from = 1500;
  plan.measure_to = 2000;
  const MarchResult result = march(simulation, nullptr, plan);
  ASSERT_EQ(reference.step_until(1500), StepOutcome::done);
  double low = reference.contact_force(0);
  double high = low;
  while (reference.step_index() < 2000) {
    ASSERT_EQ(reference.step(), StepOutcome::done);
    low = std::min(low, reference.contact_force(0));
    high = std::max(high, reference.contact_force(0));
  }
  ASSERT_TRUE(result.statistics.at(0).has_value());
  EXPECT_EQ(result.statistics[0]->force_min, low);
  EXPECT_EQ(result.statistics[0]->force_max, high);
}

TEST(March, AWindowThatIsNotReachedIsEmpty) {
  const Model model = make_paper_model(paper_model());
  Simulation simulation(model.system, paper_time());
  MarchPlan plan;
  plan.last_step = 100;
  plan.measure_from = 200;
  plan.measure_to = 300;
  EXPECT_FALSE(march(simulation, nullptr, plan).statistics.at(0).has_value());
}

TEST(March, StopsOnRequest) {
  const Model model = make_paper_model(paper_model());
  Simulation simulation(model.system, paper_time());
  MarchPlan plan;
  plan.last_step = 1'000'000;
  request_stop(true);
  EXPECT_EQ(march(simulation, nullptr, plan).end, MarchEnd::stopped);
  request_stop(false);
  EXPECT_LT(simulation.step_index(), 1000);
}

TEST(March, FailureOfAStepEndsTheRun) {
  ModelParameters parameters = paper_model();
  parameters.drive->load = TimeCurve(+0.2);
  parameters.contact->armed_from = 0.0;
  parameters.drive->ramp = 1e-3;
  const Model model = make_paper_model(parameters);
  Simulation simulation(model.system, paper_time());
  MarchPlan plan;
  plan.last_step = 100'000;
  EXPECT_EQ(march(simulation, nullptr, plan).end, MarchEnd::failed);
  EXPECT_FALSE(simulation.failure().empty());
}

}  // namespace
}  // namespace stridor
