// One suite for every way to march one body.
#include "solvers/integrators/propagator.hpp"

#include <gtest/gtest.h>

#include <Eigen/LU>
#include <algorithm>
#include <array>
#include <cmath>
#include <complex>
#include <memory>
#include <optional>
#include <type_traits>

#include "solvers/integrators/coupled_propagator.hpp"
#include "solvers/integrators/dense_two_step.hpp"
#include "solvers/integrators/modal_recurrence.hpp"

namespace stridor {
namespace {

/// A chain of three masses between springs, damped in proportion; row r is mass r.
ReducedBody chain(double alpha, double beta) {
  ReducedBody body;
  body.mass = Eigen::Vector3d(1.0, 2.0, 0.5).asDiagonal();
  body.stiffness = Eigen::Matrix3d{{300, -100, 0}, {-100, 300, -200}, {0, -200, 200}};
  body.damping.alpha = alpha;
  body.damping.beta = beta;
  body.rows = Eigen::Matrix3d::Identity();
  return body;
}

ReducedBody single_mass(double mass, double stiffness, double alpha, double beta) {
  ReducedBody body;
  body.mass = Eigen::MatrixXd::Constant(1, 1, mass);
  body.stiffness = Eigen::MatrixXd::Constant(1, 1, stiffness);
  body.damping.alpha = alpha;
  body.damping.beta = beta;
  body.rows = Eigen::MatrixXd::Identity(1, 1);
  return body;
}

/// δ of the exact forms.
constexpr double added = 0.02;

/// Modes marched by a scheme; those above a cut-off truncated to their residual flexibility.
template <Integrator scheme>
std::unique_ptr<Propagator> make_modal_form(const ReducedBody& body,
                                            const Eigen::MatrixXd& patterns, double step, int ports,
                                            std::span<const double> loads, double cutoff = 1e300) {
  const ModalBody modal = with_static_residual(make_modal(body), cutoff);
  // Patterns are given in reduced coordinates, ΦᵀMΦ = I.
  const Eigen::MatrixXd forces = body.rows.transpose().inverse() * patterns;
  return std::make_unique<ModalRecurrence>(
      modal, modal.shapes.transpose() * patterns, scheme, step,
      scheme == Integrator::exact ? std::optional(added) : std::nullopt, ports,
      body.damping.alpha_at(0.0), loads,
      Propagator::Residual{modal.residual,
                           modal.residual.flexibility.size() > 0
                               ? Eigen::MatrixXd(modal.residual.flexibility * forces)
                               : Eigen::MatrixXd(),
                           modal.residual.shapes.size() > 0
                               ? Eigen::MatrixXd(modal.residual.shapes * forces)
                               : Eigen::MatrixXd(),
                           step});
}

struct ModalForm {
  static std::unique_ptr<Propagator> make(const ReducedBody& body, const Eigen::MatrixXd& patterns,
                                          double step, int ports, std::span<const double> loads) {
    return make_modal_form<Integrator::central_difference>(body, patterns, step, ports, loads);
  }
};
struct ExactForm {
  static std::unique_ptr<Propagator> make(const ReducedBody& body, const Eigen::MatrixXd& patterns,
                                          double step, int ports, std::span<const double> loads) {
    return make_modal_form<Integrator::exact>(body, patterns, step, ports, loads);
  }
};
/// The highest of the three modes of chain(), 24 rad/s, is truncated.
struct ResidualForm {
  static std::unique_ptr<Propagator> make(const ReducedBody& body, const Eigen::MatrixXd& patterns,
                                          double step, int ports, std::span<const double> loads) {
    return make_modal_form<Integrator::exact>(body, patterns, step, ports, loads, 20.0);
  }
};
/// All damping as terms that might couple the modes.
struct CoupledForm {
  static std::unique_ptr<Propagator> make(const ReducedBody& given, const Eigen::MatrixXd& patterns,
                                          double step, int ports, std::span<const double> loads) {
    ReducedBody body = given;
    const Eigen::MatrixXd damping =
        given.damping.alpha * given.mass + given.damping.beta * given.stiffness;
    body.damping = {};
    body.coupled = {damping, Eigen::MatrixXd::Zero(given.size(), given.size())};
    const ModalBody modal = make_modal(body);
    return std::make_unique<CoupledPropagator>(modal, modal.shapes.transpose() * patterns, step,
                                               added, ports, 0.0, loads, "chain");
  }
};
struct PublishedForm {
  static std::unique_ptr<Propagator> make(const ReducedBody& body, const Eigen::MatrixXd& patterns,
                                          double step, int ports, std::span<const double> loads) {
    return std::make_unique<PublishedTwoStep>(body, patterns, step, ports,
                                              body.damping.alpha_at(0.0), loads);
  }
};
struct FusedForm {
  static std::unique_ptr<Propagator> make(const ReducedBody& body, const Eigen::MatrixXd& patterns,
                                          double step, int ports, std::span<const double> loads) {
    return std::make_unique<FusedTwoStep>(body, patterns, step, ports, body.damping.alpha_at(0.0),
                                          loads);
  }
};

template <class Form>
class PropagatorTest : public ::testing::Test {};
using Forms = ::testing::Types<ModalForm, PublishedForm, FusedForm>;
TYPED_TEST_SUITE(PropagatorTest, Forms);

/// Properties of every scheme.
template <class Form>
class AnyPropagatorTest : public ::testing::Test {};
using AllForms =
    ::testing::Types<ModalForm, PublishedForm, FusedForm, ExactForm, ResidualForm, CoupledForm>;
TYPED_TEST_SUITE(AnyPropagatorTest, AllForms);

const Eigen::MatrixXd no_patterns = Eigen::MatrixXd(1, 0);

/// Error at t = 1 of u'' + c u' + k u = F(t) with the solution u = t³ e^{-t}, which starts at rest
/// with u'' = 0, so that u_0 = u_{-1} = 0 is right to third order.
template <class Form>
double error_at_one(double alpha, double beta, int num_steps) {
  constexpr double stiffness = 40.0;
  const double c = alpha + beta * stiffness;
  const double step = 1.0 / num_steps;
  const auto force = [&](double t) {
    const double u = t * t * t;
    const double v = 3 * t * t - t * t * t;
    const double a = 6 * t - 6 * t * t + t * t * t;
    return std::exp(-t) * (a + c * v + stiffness * u);
  };
  const double start[] = {0.0};
  const auto body = Form::make(single_mass(1.0, stiffness, alpha, beta),
                               Eigen::MatrixXd::Identity(1, 1), step, 0, start);
  for (int n = 1; n <= num_steps; ++n) {
    const double load[] = {force(n * step)};
    body->set_loads(load);
    body->advance(nullptr);
  }
  body->settle(nullptr);
  return std::abs(body->displacement(0) - std::exp(-1.0));
}

TYPED_TEST(PropagatorTest, IsSecondOrderInTheStepWithoutDamping) {
  // Two halvings in the asymptotic range; the band leaves room for the next term of the expansion.
  for (const int n : {200, 400}) {
    const double order =
        std::log2(error_at_one<TypeParam>(0.0, 0.0, n) / error_at_one<TypeParam>(0.0, 0.0, 2 * n));
    EXPECT_GT(order, 1.9);
    EXPECT_LT(order, 2.1);
  }
}

TYPED_TEST(PropagatorTest, IsFirstOrderInTheStepWithDamping) {
  for (const int n : {400, 800}) {
    const double order = std::log2(error_at_one<TypeParam>(2.0, 0.05, n) /
                                   error_at_one<TypeParam>(2.0, 0.05, 2 * n));
    EXPECT_GT(order, 0.9);
    EXPECT_LT(order, 1.1);
  }
}

TYPED_TEST(PropagatorTest, MatchesTheSchemeWrittenOutForOneOscillator) {
  // u_{n+1} = h² (f_n − c (u_n − u_{n−1})/h − k u_n) + 2 u_n − u_{n−1}, evaluated plainly.
  constexpr double step = 0.01;
  constexpr double stiffness = 25.0;
  constexpr double c = 0.3 + 0.002 * stiffness;
  const double amplitude[] = {2.0};
  const auto body = TypeParam::make(single_mass(1.0, stiffness, 0.3, 0.002),
                                    Eigen::MatrixXd::Identity(1, 1), step, 1, amplitude);
  body->watch(0, 0);
  double previous = 0.0;
  double current = 0.0;
  for (int n = 0; n < 500; ++n) {
    const double contact = n % 7 == 0 ? 1.5 : 0.0;
    const double next =
        step * step * (2.0 + contact - c * (current - previous) / step - stiffness * current) +
        2 * current - previous;
    body->advance(&contact);
    previous = current;
    current = next;
    // Rounding of 500 steps of an oscillation of amplitude 0.1.
    ASSERT_NEAR(body->displacement(0), current, 1e-13);
    ASSERT_NEAR(body->current(0), current, 1e-13);
    ASSERT_NEAR(body->increment(0), current - previous, 1e-13);
  }
}

TYPED_TEST(PropagatorTest, CorrectionIsComplianceTimesForce) {
  const auto body = TypeParam::make(chain(0.5, 1e-3), Eigen::MatrixXd(3, 0), 0.01, 2, {});
  body->watch(0, 0);
  body->watch(1, 2);
  const double forces[] = {3.0, -1.0};
  const double expected0 =
      body->predicted(0) + body->compliance(0, 0) * 3.0 - body->compliance(0, 1) * 1.0;
  const double expected1 =
      body->predicted(1) + body->compliance(1, 0) * 3.0 - body->compliance(1, 1) * 1.0;
  body->advance(forces);
  // One multiply-add each.
  EXPECT_NEAR(body->displacement(0), expected0, 1e-17);
  EXPECT_NEAR(body->displacement(2), expected1, 1e-17);
  // h² M⁻¹ at masses 1 and 0.5, which do not share inertia.
  EXPECT_NEAR(body->compliance(0, 0), 1e-4, 1e-18);
  EXPECT_NEAR(body->compliance(1, 1), 2e-4, 1e-18);
  EXPECT_NEAR(body->compliance(0, 1), 0.0, 1e-18);
}

TYPED_TEST(PropagatorTest, PredictsTheStepThatItThenMakes) {
  // Any number of ports; nine masses, so that the modes do not fill whole blocks.
  for (const int num_ports : {0, 1, 2, 5}) {
    ReducedBody many;
    many.mass = Eigen::VectorXd::LinSpaced(9, 1.0, 2.0).asDiagonal();
    many.stiffness = Eigen::VectorXd::LinSpaced(9, 100.0, 900.0).asDiagonal();
    many.stiffness.diagonal(1).setConstant(-20.0);
    many.stiffness.diagonal(-1).setConstant(-20.0);
    many.damping.alpha = 0.5;
    many.damping.beta = 1e-3;
    many.rows = Eigen::MatrixXd::Identity(9, 9);
    const double load[] = {3.0};
    const auto body =
        TypeParam::make(many, Eigen::VectorXd::LinSpaced(9, -1.0, 1.0), 0.01, num_ports, load);
    for (int port = 0; port < num_ports; ++port) body->watch(port, 2 * port);
    std::vector<double> forces(static_cast<std::size_t>(num_ports));
    std::vector<double> position(9);
    std::vector<double> increment(9);
    for (int n = 0; n < 50; ++n) {
      for (int port = 0; port < num_ports; ++port)
        forces[static_cast<std::size_t>(port)] = std::sin(0.3 * n + port);
      const Eigen::VectorXd before = body->motion(forces.data()).displacement;
      body->predict_step(forces.data(), position, increment);
      body->advance(forces.data());
      const Propagator::Motion after = body->motion(forces.data());
      for (Eigen::Index i = 0; i < 9; ++i) {
        const auto k = static_cast<std::size_t>(i);
        ASSERT_EQ(position[k], before(i));
        // Rounding of displacements of 0.1.
        ASSERT_NEAR(position[k] + increment[k], after.displacement(i), 1e-16);
        ASSERT_NEAR(increment[k], 0.01 * after.velocity(i), 1e-15);
      }
    }
  }
}

TYPED_TEST(AnyPropagatorTest, WatchingAnotherRowShowsItsPresentAndPredictedPlace) {
  const auto body = TypeParam::make(chain(0.5, 1e-3), Eigen::MatrixXd(3, 0), 0.01, 1, {});
  body->watch(0, 0);
  const double push = 5.0;
  for (int n = 0; n < 20; ++n) {
    body->settle(&push);
    body->advance(&push);
  }
  body->watch(0, 2);
  EXPECT_EQ(body->row(0), 2);
  if (!body->has_feedthrough()) {
    EXPECT_NEAR(body->current(0), body->displacement(2), 1e-16);
  }
  const double predicted = body->predicted(0);
  const double none = 0.0;
  body->settle(&none);
  if (!body->has_feedthrough()) body->advance(&none);
  // Without the force the prediction is what happens.
  EXPECT_NEAR(body->current(0), predicted, 1e-16);
  // On new rows the lag of the truncated modes begins anew.
  if (!std::is_same_v<TypeParam, ResidualForm>) {
    EXPECT_NEAR(body->displacement(2), predicted, 1e-16);
  }
}

TYPED_TEST(AnyPropagatorTest, ExpectsItsPlaceUnderTheLastForces) {
  const auto body = TypeParam::make(chain(0.5, 1e-3), Eigen::MatrixXd(3, 0), 0.01, 1, {});
  body->watch(0, 0);
  const double push = 5.0;
  for (int n = 0; n < 20; ++n) {
    body->settle(&push);
    body->advance(&push);
  }
  if (!body->has_feedthrough()) {
    EXPECT_EQ(body->expected(0), body->predicted(0));
    return;
  }
  const double expected = body->expected(0);
  body->watch(0, 2);
  const double expected_there = body->expected(0);
  body->watch(0, 0);
  EXPECT_NEAR(body->expected(0), expected, 1e-16);
  body->settle(&push);
  EXPECT_NEAR(body->displacement(0), expected, 1e-16);
  EXPECT_NEAR(body->displacement(2), expected_there, 1e-16);
}

TYPED_TEST(AnyPropagatorTest, MorePortsThanAreFusedGiveTheSameMotion) {
  // Five ports on the same row share a force that one port carries alone.
  const auto one = TypeParam::make(chain(0.5, 1e-3), Eigen::MatrixXd(3, 0), 0.01, 1, {});
  const auto five = TypeParam::make(chain(0.5, 1e-3), Eigen::MatrixXd(3, 0), 0.01, 5, {});
  one->watch(0, 1);
  for (int port = 0; port < 5; ++port) five->watch(port, 1);
  for (int n = 0; n < 100; ++n) {
    const double whole = std::sin(0.1 * n);
    const double parts[] = {0.4 * whole, 0.3 * whole, 0.2 * whole, 0.05 * whole, 0.05 * whole};
    one->settle(&whole);
    five->settle(parts);
    for (int port = 0; port < 5; ++port) ASSERT_NEAR(five->current(port), one->current(0), 1e-14);
    one->advance(&whole);
    five->advance(parts);
    for (int port = 0; port < 5; ++port)
      ASSERT_NEAR(five->predicted(port), one->predicted(0), 1e-14);
  }
}

TYPED_TEST(AnyPropagatorTest, GoesOnBitwiseAfterSaveAndLoad) {
  const double loads[] = {1.0};
  const Eigen::MatrixXd pattern = Eigen::Vector3d(0.0, 1.0, 0.0);
  const auto straight = TypeParam::make(chain(0.5, 1e-3), pattern, 0.01, 2, loads);
  const auto resumed = TypeParam::make(chain(0.5, 1e-3), pattern, 0.01, 2, loads);
  straight->watch(0, 0);
  straight->watch(1, 2);
  const auto march = [](Propagator& body, int from, int to) {
    const auto force = [](int n) { return std::array{std::cos(0.3 * n), std::sin(0.2 * n)}; };
    for (int n = from; n < to; ++n) {
      body.advance(force(n).data());
      body.settle(force(n + 1).data());
    }
  };
  march(*straight, 0, 57);
  State state;
  straight->save(state, "body/");
  resumed->load(state, "body/");
  march(*straight, 57, 200);
  march(*resumed, 57, 200);
  for (int row = 0; row < 3; ++row)
    EXPECT_EQ(straight->displacement(row), resumed->displacement(row));
  for (int port = 0; port < 2; ++port) {
    EXPECT_EQ(straight->predicted(port), resumed->predicted(port));
    EXPECT_EQ(straight->increment(port), resumed->increment(port));
  }
}

TYPED_TEST(AnyPropagatorTest, RefusesTheStateOfAnotherBody) {
  const auto body = TypeParam::make(chain(0.5, 1e-3), Eigen::MatrixXd(3, 0), 0.01, 1, {});
  const auto other = TypeParam::make(single_mass(1.0, 10.0, 0.0, 0.0), no_patterns, 0.01, 1, {});
  State state;
  other->save(state, "");
  EXPECT_THROW(body->load(state, ""), std::invalid_argument);
  EXPECT_THROW(body->load(State{}, ""), std::invalid_argument);
}

TYPED_TEST(PropagatorTest, MassDampingCanChangeOnTheWay) {
  constexpr double step = 0.01;
  const auto body =
      TypeParam::make(single_mass(1.0, 25.0, 4.0, 0.0), Eigen::MatrixXd(1, 0), step, 1, {});
  body->watch(0, 0);
  double previous = 0.0;
  double current = 0.0;
  double alpha = 4.0;
  for (int n = 0; n < 300; ++n) {
    const double push = n == 0 ? 100.0 : 0.0;
    const double next =
        step * step * (push - alpha * (current - previous) / step - 25.0 * current) + 2 * current -
        previous;
    alpha = n < 150 ? 4.0 : 0.1;
    body->set_mass_damping(alpha);
    body->advance(&push);
    previous = current;
    current = next;
    ASSERT_NEAR(body->current(0), current, 1e-13);
  }
}

// --- exact propagation
// ----------------------------------------------------------------------------

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
  EXPECT_NEAR(
      exact_propagation(0.0, 99.999, 1e-3).feedthrough / exact_propagation(0.0, 100.001, 1e-3).feedthrough,
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
