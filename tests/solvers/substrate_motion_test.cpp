#include "solvers/transient/substrate_motion.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <complex>
#include <numbers>

#include "tests/support/paper_sphere.hpp"

namespace stridor {
namespace {

using test::paper_sphere;

/// Largest error of a harmonic oscillator after 2 π with steps of equal length.
double harmonic_error(int num_steps) {
  using Step = RungeKuttaStep<2>;
  const auto f = [](const Step::State& y, Step::State& slope) { slope = {y[1], -y[0]}; };
  Step step;
  Step::State y{1.0, 0.0};
  const double h = 2.0 * std::numbers::pi / num_steps;
  for (int i = 0; i < num_steps; ++i) {
    Step::State slope;
    f(y, slope);
    step.take(y, slope, h, f);
    y = step.end();
  }
  return std::hypot(y[0] - 1.0, y[1]);
}

TEST(RungeKutta, OrderIsEight) {
  const double order = std::log2(harmonic_error(8) / harmonic_error(16));
  EXPECT_GT(order, 7.7);
  EXPECT_LT(order, 9.3);
}

TEST(RungeKutta, ErrorEstimateIsOfTheErrorOfOneStep) {
  using Step = RungeKuttaStep<2>;
  const auto f = [](const Step::State& y, Step::State& slope) { slope = {y[1], -y[0]}; };
  const auto estimate = [&](double h) {
    Step step;
    step.take({1.0, 0.0}, {0.0, -1.0}, h, f);
    const double error = std::hypot(step.end()[0] - std::cos(h), step.end()[1] + std::sin(h));
    const double said = step.error({1.0, 1.0});
    EXPECT_GT(said, error);  // it is of a lower order
    return said;
  };
  EXPECT_NEAR(std::log2(estimate(0.8) / estimate(0.4)), 8.0, 0.7);
}

/// A rigid-looking law without friction: an oscillator off the substrate is linear.
TEST(SubstrateMotion, FreeFlightIsTheDampedOscillator) {
  SubstrateOscillator oscillator = make_sphere(paper_sphere());
  oscillator.stiffness << 4.0, 0.0, 0.0, 1.0;
  SubstrateMotion motion(oscillator, 1e-13);
  motion.start({0.3, -5.0}, {0.0, 0.0});
  // y swings about 1 and comes back to the substrate where y = 0; x is by itself.
  ASSERT_EQ(motion.advance(1.0, false), SubstrateMotion::Stop::end);
  EXPECT_EQ(motion.mode(), SubstrateMode::free);
  const double omega = std::sqrt(4.0 - 1e-4);
  const double x = 0.3 * std::exp(-0.01) * (std::cos(omega) + 0.01 / omega * std::sin(omega));
  EXPECT_NEAR(motion.state()[0], x, 1e-12);
  const double free = std::sqrt(1.0 - 1e-4);
  const double y = 1.0 - 6.0 * std::exp(-0.01) * (std::cos(free) + 0.01 / free * std::sin(free));
  EXPECT_NEAR(motion.state()[1], y, 1e-11);
  EXPECT_DOUBLE_EQ(motion.statistics().free_time, 1.0);
}

TEST(SubstrateMotion, TouchesDownWhereTheFreeFlightEnds) {
  SubstrateOscillator oscillator = make_sphere(paper_sphere());
  oscillator.stiffness << 4.0, 0.0, 0.0, 1.0;
  oscillator.damping.setZero();
  SubstrateMotion motion(oscillator, 1e-13);
  // 1 − 2 cos t = 0 at π/3.
  motion.start({0.0, -1.0}, {0.0, 0.0});
  (void)motion.advance(std::numbers::pi / 3.0 - 1e-9, false);
  EXPECT_EQ(motion.mode(), SubstrateMode::free);
  (void)motion.advance(std::numbers::pi / 3.0 + 1e-9, false);
  EXPECT_NE(motion.mode(), SubstrateMode::free);
  EXPECT_NEAR(motion.statistics().free_time, std::numbers::pi / 3.0, 1e-12);
}

TEST(SubstrateMotion, StaysInEquilibrium) {
  const SubstrateOscillator oscillator = make_sphere(paper_sphere(4e-4, 1.5e-3));
  const SubstrateEquilibrium rest = find_equilibrium(oscillator);
  SubstrateMotion motion(oscillator, 1e-10);
  motion.start(rest.displacement, Eigen::Vector2d::Zero());
  (void)motion.advance(50.0, false);
  EXPECT_NEAR(motion.state()[0], rest.displacement.x(), 1e-10);
  EXPECT_NEAR(motion.state()[1], rest.displacement.y(), 1e-10);
}

TEST(SubstrateMotion, ShortTimeGrowthIsTheEigenvalue) {
  for (const double shear : {2e-4, 1.5e-3, 3e-3}) {
    const SubstrateOscillator oscillator = make_sphere(paper_sphere(4e-4, shear));
    const SubstrateEquilibrium rest = find_equilibrium(oscillator);
    const SmallMotion small = small_motion(oscillator, rest);
    // Along the eigenvector of the leading eigenvalue: (s² + s c_21 + …) relates x and y.
    const std::complex<double> s = leading_eigenvalue(small);
    const std::complex<double> x = 1.0;
    const std::complex<double> y =
        -(s * s + s * small.damping(0, 0) + small.stiffness(0, 0)) / small.stiffness(0, 1);
    const double amplitude = 1e-6 * rest.displacement.y() / std::max(1.0, std::abs(y));
    SubstrateMotion motion(oscillator, 1e-13);
    const auto at = [&](std::complex<double> phase) {
      return Eigen::Vector2d(amplitude * (x * phase).real(), amplitude * (y * phase).real());
    };
    motion.start(rest.displacement + at(1.0), at(s));
    const double time = 2.0;
    (void)motion.advance(time, false);
    const Eigen::Vector2d expected = at(std::exp(s * time));
    const Eigen::Vector2d found =
        Eigen::Vector2d(motion.state()[0], motion.state()[1]) - rest.displacement;
    EXPECT_LT((found - expected).norm(), 1e-4 * amplitude * std::max(1.0, std::abs(y)) *
                                             std::exp(std::max(0.0, s.real() * time)))
        << shear;
  }
}

TEST(SubstrateMotion, FrictionOfStickingStaysBelowItsStrength) {
  const SubstrateOscillator oscillator = make_sphere(paper_sphere());
  const SubstrateEquilibrium rest = find_equilibrium(oscillator);
  SubstrateMotion motion(oscillator, 1e-9);
  motion.start({rest.displacement.x(), 1.01 * rest.displacement.y()}, Eigen::Vector2d::Zero());
  int sticking = 0;
  for (int i = 1; i <= 2000; ++i) {
    (void)motion.advance(0.05 * i, false);
    const auto& s = motion.state();
    if (motion.mode() != SubstrateMode::stick) continue;
    ++sticking;
    EXPECT_EQ(s[2], oscillator.substrate_speed);
    const double required = oscillator.damping(0, 0) * s[2] + oscillator.stiffness(0, 0) * s[0] +
                            oscillator.stiffness(0, 1) * s[1];
    EXPECT_LE(std::abs(required), oscillator.contact.static_strength(s[1]).value * (1.0 + 1e-12));
  }
  EXPECT_GT(sticking, 300);
}

TEST(SubstrateMotion, NothingBreaksAtExtremes) {
  for (const double shear : {0.0, 1.0}) {
    for (const double speed : {1e-8, 1e-3, 1e3}) {
      for (const double load : {1e-8, 1e-4, 0.1}) {
        test::PaperSphere model = paper_sphere(speed, shear);
        model.normal_load = load;
        const SubstrateOscillator oscillator = make_sphere(model);
        const SubstrateEquilibrium rest = find_equilibrium(oscillator);
        SubstrateMotion motion(oscillator, 1e-6);
        motion.start({rest.displacement.x(), 1.5 * rest.displacement.y()}, {0.0, 0.0});
        // Arrives, or says that it does not.
        const SubstrateMotion::Stop stop = motion.advance(5.0, false);
        for (const double value : motion.state()) EXPECT_FALSE(std::isnan(value));
        EXPECT_EQ(stop, SubstrateMotion::Stop::end) << shear << ' ' << speed << ' ' << load;
      }
    }
  }
}

}  // namespace
}  // namespace stridor
