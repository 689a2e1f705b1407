// Order of accuracy in the step: every integrator under every contact assumption, in one suite.
#include <gtest/gtest.h>

#include <cmath>
#include <tuple>

#include "substructures/bodies/beam.hpp"
#include "tests/support/paper_model.hpp"
#include "tests/support/relative_difference.hpp"

namespace stridor {
namespace {

using namespace test;

constexpr double interval = 2e-5;
constexpr double end = 8e-3;

/// Displacements of the free end at every multiple of the interval.
std::vector<double> end_motion(const Model& model, const TimeParameters& time) {
  Simulation simulation(model.system, time);
  const Model::Point tip = model.points.at(free_end);
  std::vector<double> motion;
  for (std::int64_t n = 1; n <= std::llround(end / interval); ++n) {
    if (simulation.step_until(n * std::llround(interval / time.step)) != StepOutcome::done) {
      ADD_FAILURE() << simulation.failure();
      break;
    }
    motion.push_back(simulation.displacement(tip.body, tip.rows.y));
  }
  return motion;
}

/// The leading scene with a short ramp: it slides one way from the start, so that no event spoils
/// the order.
Model sliding_model(ContactAssumption assumption, SurfaceKind surface, bool is_damped) {
  ModelParameters parameters = paper_model(leading_angle, assumption);
  parameters.drive->ramp = 1e-2;
  parameters.contact->armed_from = 1.0;
  parameters.contact->surface = surface;
  if (!is_damped) {
    for (auto& [name, body] : parameters.substructures) body.get<BeamParameters>().damping = {};
  }
  return make_paper_model(parameters);
}

TimeParameters exact(double step, double frequency) {
  TimeParameters time = paper_time(step);
  time.integrator = Integrator::exact;
  time.retain = RetainParameters{frequency, {}};
  return time;
}

class OrderTest : public ::testing::TestWithParam<std::tuple<ContactAssumption, SurfaceKind>> {
 protected:
  Model model(bool is_damped) const {
    return sliding_model(std::get<0>(GetParam()), std::get<1>(GetParam()), is_damped);
  }
};

double order(double coarse, double fine) {
  return std::log2(coarse / fine);
}

TEST_P(OrderTest, OfExactPropagationIsTwo) {
  const Model damped = model(true);
  const std::vector<double> reference = end_motion(damped, exact(2.5e-7, 50e3));
  const auto error = [&](double step) {
    return relative_difference(end_motion(damped, exact(step, 50e3)), reference);
  };
  const double coarse = error(4e-6);
  const double fine = error(1e-6);
  EXPECT_LT(coarse, 1e-6);
  EXPECT_GT(0.5 * order(coarse, fine), 1.8);
  EXPECT_LT(0.5 * order(coarse, fine), 2.3);
}

/// By the velocity of its damping, and without damping by the friction of t_{n+1} on forces of t_n.
TEST_P(OrderTest, OfTheCentralDifferenceIsOne) {
  for (const bool is_damped : {true, false}) {
    const Model beams = model(is_damped);
    const std::vector<double> reference = end_motion(beams, paper_time(1.5625e-8));
    const auto error = [&](double step) {
      return relative_difference(end_motion(beams, paper_time(step)), reference);
    };
    const double found = order(error(2.5e-7), error(1.25e-7));
    EXPECT_NEAR(found, 1.05, 0.1) << is_damped;
  }
}

/// The trailing scene with coarse beams, under a load that comes all at once and a drive that turns
/// round: the contact opens and lands, slips both ways and sticks.
Model eventful_model(SurfaceKind surface) {
  ModelParameters parameters = paper_model(trailing_angle, ContactAssumption::film);
  parameters.contact->surface = surface;
  parameters.drive->ramp = 0.0;
  parameters.drive->velocity = TimeCurve(TimeTable{{0.0, 3e-3, 4e-3}, {0.03, 0.03, -0.03}});
  auto& oblique = parameters.substructures["oblique"].get<BeamParameters>();
  oblique.mesh = {15, 1};
  auto& cantilever = parameters.substructures["cantilever"].get<BeamParameters>();
  cantilever.mesh = {20, 1};
  cantilever.interface = {0.005};
  for (BeamParameters* beam : {&oblique, &cantilever}) {
    beam->reduction = {6};
    beam->damping = {400.0, 4e-8, std::nullopt, 0.0, 0.0};
  }
  return make_paper_model(parameters);
}

class OrderWithEvents : public ::testing::TestWithParam<SurfaceKind> {};

/// A contact that was sought at once where it closes would throw off what lands on it, and the
/// more the smaller the step.
TEST_P(OrderWithEvents, OfExactPropagationIsTwo) {
  const Model model = eventful_model(GetParam());
  TimeParameters time = paper_time(1e-6);
  time.integrator = Integrator::exact;
  Simulation seen(model.system, time);
  ASSERT_EQ(seen.step_until(8000), StepOutcome::done);
  EXPECT_GT(seen.statistics(0).open, 800);
  EXPECT_GT(seen.statistics(0).sticking, 800);

  const auto motion = [&](double step) {
    time.step = step;
    return end_motion(model, time);
  };
  const std::vector<double> reference = motion(1.25e-7);
  const double coarse = relative_difference(motion(4e-6), reference);
  const double fine = relative_difference(motion(2.5e-7), reference);
  EXPECT_LT(coarse, 3e-4);
  EXPECT_GT(order(coarse, fine) / 4.0, 1.8);
  // The central difference has an error of first order, 1.3e-5 at this step.
  const std::vector<double> independent = end_motion(model, paper_time(5e-8));
  EXPECT_LT(relative_difference(reference, independent), 3e-5);
}

INSTANTIATE_TEST_SUITE_P(Surfaces, OrderWithEvents,
                         ::testing::Values(SurfaceKind::polyline, SurfaceKind::smooth));

INSTANTIATE_TEST_SUITE_P(
    Assumptions, OrderTest,
    ::testing::Combine(::testing::Values(ContactAssumption::subs_a, ContactAssumption::subs_b,
                                         ContactAssumption::subs_c, ContactAssumption::film),
                       ::testing::Values(SurfaceKind::polyline, SurfaceKind::smooth)));

}  // namespace
}  // namespace stridor
