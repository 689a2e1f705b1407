// Exact propagation, and the residual flexibility of the modes that it leaves out.
#include <gtest/gtest.h>

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <complex>

#include "solvers/integrators/two_step_scheme.hpp"
#include "substructures/reduction/modal_body.hpp"
#include "tests/support/propagator_forms.hpp"

namespace stridor {
namespace {

using namespace test;

TEST(ExactPropagation, FreeMotionFromAnyStartIsExactAtAnyStep) {
  // Under-, critically and over-damped, damped rigid; steps of a tenth to thirty radians.
  for (const double damping : {0.0, 0.4, 10.0, 40.0}) {
    for (const double stiffness : {0.0, 25.0}) {
      for (const double step : {0.02, 0.3, 6.0}) {
        const auto body =
            ExactForm::make(single_mass(1.0, stiffness, damping, 0.0), no_patterns, step, 1, {});
        body->watch(0, 0);
        const double none = 0.0;
        body->set_motion(Eigen::VectorXd::Constant(1, 0.3), Eigen::VectorXd::Constant(1, -2.0),
                         &none);
        const double half = 0.5 * damping;
        const std::complex<double> root = std::sqrt(std::complex<double>(half * half - stiffness));
        for (int n = 1; n <= 10; ++n) {
          body->advance(&none);
          body->settle(&none);
          const double t = n * step;
          // q₀ (cosh + c/2 · sinh/κ) + v₀ sinh/κ, each times exp(−c t/2), with the limits of a
          // vanishing κ.
          const std::complex<double> slow = std::exp((root - half) * t);
          const std::complex<double> fast = std::exp((-root - half) * t);
          const std::complex<double> even = 0.5 * (slow + fast);
          const std::complex<double> odd =
              std::abs(root) < 1e-9 ? t * slow : 0.5 * (slow - fast) / root;
          const double expected = (0.3 * (even + half * odd) - 2.0 * odd).real();
          // Rounding, grown over ten steps of a motion that decays; without stiffness the
          // displacement grows to 120.
          EXPECT_NEAR(body->displacement(0), expected, 2e-12 * (1.0 + std::abs(expected)))
              << "c = " << damping << ", k = " << stiffness << ", h = " << step << ", n = " << n;
        }
      }
    }
  }
}

TEST(ExactPropagation, AConstantForceIsFollowedExactly) {
  const double load[] = {7.0};
  for (const double step : {0.01, 0.5, 3.0}) {
    const auto body = ExactForm::make(single_mass(1.0, 25.0, 0.6, 0.0),
                                      Eigen::MatrixXd::Identity(1, 1), step, 0, load);
    // At rest until t = 0, where the force sets in: the first step starts from there.
    body->set_motion(Eigen::VectorXd::Zero(1), Eigen::VectorXd::Zero(1), nullptr);
    const double frequency = std::sqrt(25.0 - 0.09);
    for (int n = 1; n <= 20; ++n) {
      body->advance(nullptr);
      const double t = n * step;
      const double expected =
          7.0 / 25.0 *
          (1.0 - std::exp(-0.3 * t) *
                     (std::cos(frequency * t) + 0.3 / frequency * std::sin(frequency * t)));
      EXPECT_NEAR(body->displacement(0), expected, 1e-13);
    }
  }
}

TEST(ExactPropagation, TheVelocityIsThatOfTheMotion) {
  const auto body = ExactForm::make(single_mass(2.0, 50.0, 0.4, 0.0), no_patterns, 0.1, 1, {});
  body->watch(0, 0);
  const double force = 3.0;
  body->set_motion(Eigen::VectorXd::Zero(1), Eigen::VectorXd::Constant(1, 1.5), &force);
  // Modal coordinates of a mass of 2: velocities come out as √2 times those given in them.
  EXPECT_NEAR(body->motion(&force).velocity(0), 1.5, 1e-14);
}

TEST(ExactPropagation, HasTheCentralDifferenceAsItsLimitForSmallSteps) {
  // Coefficients differ by O(h) of themselves: s by (ch)²/2, e by ch/2 (c = 3, h = 1e-5).
  const StepCoefficients exact = exact_propagation(100.0, 3.0, 1e-5);
  const StepCoefficients published = central_difference(100.0, 3.0, 1e-5);
  EXPECT_NEAR(exact.keep, published.keep, 1e-9);
  EXPECT_NEAR(exact.answer() / published.answer(), 1.0, 2e-5);
  EXPECT_NEAR(exact.pull / (1e4 * exact.answer()), 1.0, 1e-14);
}

TEST(ExactPropagation, SmallStepsLoseNoDigits) {
  // k = h²ω² (1 − ch/2 + …) with ωh = 1e-8, where 1 − a − b from rounded a and b has no digit left.
  const StepCoefficients c = exact_propagation(1.0, 0.5, 1e-8);
  EXPECT_NEAR(c.pull / 1e-16, 1.0 - 0.25e-8, 1e-14);
  const StepCoefficients overdamped = exact_propagation(1.0, 10.0, 1e-8);
  EXPECT_NEAR(overdamped.pull / 1e-16, 1.0 - 5e-8, 1e-14);
}

TEST(ExactPropagation, IsSecondOrderInTheStepUnderAVaryingForce) {
  for (const double alpha : {0.0, 2.0}) {
    for (const int n : {100, 200}) {
      const double order = std::log2(error_at_one<ExactForm>(alpha, 0.05 * alpha, n) /
                                     error_at_one<ExactForm>(alpha, 0.05 * alpha, 2 * n));
      EXPECT_GT(order, 1.9);
      EXPECT_LT(order, 2.1);
    }
  }
}

/// Displacement per force exp(iΩt) by the recurrence of a mode.
std::complex<double> transfer(const StepCoefficients& c, double frequency, double step) {
  const std::complex<double> z = std::exp(std::complex<double>(0.0, frequency * step));
  return c.gain / (z - 1.0 - c.keep * (1.0 - 1.0 / z) + c.pull) + c.feedthrough;
}

TEST(ExactPropagation, AnswersAnOscillatingForceToFourthOrderHoweverStiffTheMode) {
  constexpr double step = 1e-3;
  for (const double omega : {1.0, 30.0, 500.0, 1500.0, 2000.0, 1e5}) {
    const StepCoefficients c = exact_propagation(omega, 0.0, step);
    for (const double frequency : {80.0, 160.0, 320.0}) {
      const double exact = 1.0 / (omega * omega - frequency * frequency);
      const double y = frequency * step;
      // The next term of the expansion is at most y⁴/100 of the larger of 1/ω² and 1/Ω², next to a
      // resonance times the amplification.
      const double scale = std::max(1.0 / (omega * omega), std::abs(exact));
      EXPECT_LT(std::abs(transfer(c, frequency, step) - exact), 0.01 * y * y * y * y * scale)
          << "ω " << omega << ", Ω " << frequency;
    }
  }
  // Without direct feedthrough, e p_n alone, the error is of second order, y²/12.
  const StepCoefficients c = exact_propagation(1.0, 0.0, step);
  const StepCoefficients plain{c.keep, c.pull, c.answer()};
  EXPECT_NEAR(std::abs(transfer(plain, 320.0, step) * (1.0 - 320.0 * 320.0)) - 1.0,
              0.32 * 0.32 / 12.0, 2e-4);
}

TEST(ExactPropagation, AnswersASlowForceWithTheRightDelay) {
  // H = (1 − iΩ c/ω²)/ω² at small Ω, with light and heavy damping and without stiffness H =
  // 1/(iΩc).
  constexpr double step = 1e-3;
  constexpr double frequency = 1e-4;
  for (const double omega : {20.0, 1000.0, 5000.0}) {
    for (const double damping : {0.5, 300.0, 20000.0}) {
      const std::complex<double> found =
          transfer(exact_propagation(omega, damping, step), frequency, step) * omega * omega;
      EXPECT_NEAR(found.real(), 1.0, 1e-4);
      EXPECT_NEAR(found.imag() / (frequency * damping / (omega * omega)), -1.0, 1e-4)
          << "ω " << omega << ", c " << damping;
    }
  }
  const std::complex<double> drift = transfer(exact_propagation(0.0, 300.0, step), frequency, step);
  EXPECT_NEAR(std::abs(drift * std::complex<double>(0.0, frequency * 300.0) - 1.0), 0.0, 1e-4);
}

TEST(ExactPropagation, FeedthroughAnswerHasNoJumpsWhereItsFormulaChanges) {
  for (const double damping : {0.0, 50.0, 99.99, 100.01, 3000.0}) {
    const double below = exact_propagation(0.0999, damping, 1e-3).feedthrough;
    const double above = exact_propagation(0.1001, damping, 1e-3).feedthrough;
    EXPECT_NEAR(above / below, 1.0, 1e-6) << "c " << damping;
  }
  EXPECT_NEAR(exact_propagation(0.0, 99.999, 1e-3).feedthrough /
                  exact_propagation(0.0, 100.001, 1e-3).feedthrough,
              1.0, 1e-7);
  EXPECT_NEAR(exact_propagation(0.0, 0.0, 1e-3).feedthrough, 1e-6 / 12.0, 1e-20);
}

TEST(ExactPropagation, NoModeAnswersAtOnceByMoreThanItsFlexibility) {
  // δ = 0.309, as a free mode with c h = 2.14 needs it, where 1 − δ (ω h)² would be negative.
  for (const double turn : {1.9, 2.0}) {
    for (const double damping : {0.0, 0.01}) {
      const StepCoefficients c = exact_propagation(turn, damping, 1.0, 0.309);
      EXPECT_NEAR(c.feedthrough, 1.0 / (turn * turn), 1e-15);
      EXPECT_EQ(c.gain, 0.0);
    }
  }
  EXPECT_GT(exact_propagation(1.7, 0.0, 1.0, 0.309).gain, 0.0);
  const StepCoefficients central = central_difference(1.9, 0.0, 1.0, 0.4);
  EXPECT_NEAR(central.feedthrough, 1.0 / (1.9 * 1.9), 1e-15);
  EXPECT_EQ(central.gain, 0.0);
}

TEST(ExactPropagation, AChangedDampingChangesNoForceOnTheWay) {
  // u = u* + W f of the step that the forces were found for, whatever damping follows.
  const auto body = ExactForm::make(chain(40.0, 1e-3), Eigen::MatrixXd(3, 0), 0.05, 1, {});
  body->watch(0, 1);
  const double force = 2.0;
  body->settle(&force);
  body->advance(&force);
  const double expected = body->predicted(0) + body->compliance(0, 0) * force;
  const double before = body->compliance(0, 0);
  body->set_mass_damping(0.1);
  EXPECT_EQ(body->compliance(0, 0), before);
  body->settle(&force);
  EXPECT_NEAR(body->displacement(1), expected, 1e-16);
  body->advance(&force);
  EXPECT_GT(std::abs(body->compliance(0, 0) - before), 1e-3 * before);
}

TEST(StaticResidual, StandsForTheModesLeftOutUnderAConstantForce) {
  // The chain settles under a force on one mass and a load on another as if no mode was missing.
  const double load[] = {1.5};
  const Eigen::MatrixXd pattern = Eigen::Vector3d(0.0, 0.0, 1.0);
  const auto body = ResidualForm::make(chain(8.0, 0.0), pattern, 0.05, 2, load);
  body->watch(0, 0);
  body->watch(1, 2);
  const double forces[] = {2.0, 0.0};
  for (int n = 0; n < 2000; ++n) {
    body->advance(forces);
    body->settle(forces);
  }
  const Eigen::Vector3d expected =
      Eigen::Matrix3d(chain(0.0, 0.0).stiffness).inverse() * Eigen::Vector3d(2.0, 0.0, 1.5);
  for (int row = 0; row < 3; ++row) EXPECT_NEAR(body->displacement(row), expected(row), 1e-14);
  EXPECT_NEAR(body->current(0), expected(0), 1e-14);
  EXPECT_NEAR(body->current(1), expected(2), 1e-14);
  // Two moving modes, given back in reduced coordinates, which here are the rows.
  const ModalBody modal = with_static_residual(make_modal(chain(8.0, 0.0)), 20.0);
  ASSERT_EQ(modal.size(), 2);
  EXPECT_LT(
      (modal.shapes * body->motion(forces).displacement + body->residual_displacement() - expected)
          .norm(),
      1e-14);
}

TEST(StaticResidual, FollowsTheForcesWithTheLagOfItsDamping) {
  // R f~ on top of the moving modes, f~_n = w f_n + (1 − w) f~_{n−1}, w = h/(h + β).
  const double beta = 0.02;
  const ModalBody all = make_modal(chain(0.0, beta));
  const ModalBody kept = with_static_residual(all, 20.0);
  const auto body = ResidualForm::make(chain(0.0, beta), Eigen::MatrixXd(3, 0), 0.05, 1, {});
  body->watch(0, 1);
  const double none = 0.0;
  body->settle(&none);
  const double R = kept.residual.flexibility(1, 1);
  EXPECT_NEAR(R, all.rows(1, 2) * all.rows(1, 2) / (all.omega(2) * all.omega(2)), 1e-16);
  const double w = 0.05 / 0.07;
  double lagging = 0.0;
  for (const double force : {1.0, 1.7, 1.1}) {
    body->settle(&force);
    lagging = w * force + (1.0 - w) * lagging;
    const double moving = kept.rows.row(1).dot(body->motion(&force).displacement);
    EXPECT_NEAR(body->current(0) - moving, R * lagging, 1e-16);
    EXPECT_NEAR(body->displacement(1), body->current(0), 1e-16);
    body->advance(&force);
  }
}

}  // namespace
}  // namespace stridor
