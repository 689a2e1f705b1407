// One suite for every way to march one body.
#include "solvers/propagator.hpp"

#include <gtest/gtest.h>

#include <Eigen/LU>
#include <cmath>
#include <memory>

#include "solvers/dense_two_step.hpp"
#include "solvers/modal_recurrence.hpp"

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

ReducedBody oscillator(double mass, double stiffness, double alpha, double beta) {
  ReducedBody body;
  body.mass = Eigen::MatrixXd::Constant(1, 1, mass);
  body.stiffness = Eigen::MatrixXd::Constant(1, 1, stiffness);
  body.damping.alpha = alpha;
  body.damping.beta = beta;
  body.rows = Eigen::MatrixXd::Identity(1, 1);
  return body;
}

struct ModalForm {
  static std::unique_ptr<Propagator> make(const ReducedBody& body, const Eigen::MatrixXd& patterns,
                                          double step, int slots, std::span<const double> loads) {
    // Patterns are given in reduced coordinates; a row of the body turns them into modal ones.
    const ModalBody modal = make_modal(body);
    const Eigen::MatrixXd modal_patterns =
        modal.rows.transpose() * body.rows.transpose().inverse() * patterns;
    return std::make_unique<ModalRecurrence>(modal, modal_patterns, step, slots,
                                             body.damping.alpha_at(0.0), loads);
  }
};
struct PublishedForm {
  static std::unique_ptr<Propagator> make(const ReducedBody& body, const Eigen::MatrixXd& patterns,
                                          double step, int slots, std::span<const double> loads) {
    return std::make_unique<PublishedTwoStep>(body, patterns, step, slots,
                                              body.damping.alpha_at(0.0), loads);
  }
};
struct FusedForm {
  static std::unique_ptr<Propagator> make(const ReducedBody& body, const Eigen::MatrixXd& patterns,
                                          double step, int slots, std::span<const double> loads) {
    return std::make_unique<FusedTwoStep>(body, patterns, step, slots, body.damping.alpha_at(0.0),
                                          loads);
  }
};

template <class Form>
class PropagatorTest : public ::testing::Test {};
using Forms = ::testing::Types<ModalForm, PublishedForm, FusedForm>;
TYPED_TEST_SUITE(PropagatorTest, Forms);

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
  const auto body = Form::make(oscillator(1.0, stiffness, alpha, beta),
                               Eigen::MatrixXd::Identity(1, 1), step, 0, start);
  for (int n = 1; n <= num_steps; ++n) {
    const double load[] = {force(n * step)};
    body->set_loads(load);
    body->advance(nullptr);
  }
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
  const auto body = TypeParam::make(oscillator(1.0, stiffness, 0.3, 0.002),
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

TYPED_TEST(PropagatorTest, ForeseesTheStepThatItThenMakes) {
  // Any number of slots; nine masses, so that the modes do not fill whole blocks.
  for (const int num_slots : {0, 1, 2, 5}) {
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
        TypeParam::make(many, Eigen::VectorXd::LinSpaced(9, -1.0, 1.0), 0.01, num_slots, load);
    for (int slot = 0; slot < num_slots; ++slot) body->watch(slot, 2 * slot);
    std::vector<double> forces(static_cast<std::size_t>(num_slots));
    std::vector<double> position(9);
    std::vector<double> increment(9);
    for (int n = 0; n < 50; ++n) {
      for (int slot = 0; slot < num_slots; ++slot)
        forces[static_cast<std::size_t>(slot)] = std::sin(0.3 * n + slot);
      const Eigen::VectorXd before = body->motion().displacement;
      body->foresee(forces.data(), position, increment);
      body->advance(forces.data());
      const Propagator::Motion after = body->motion();
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

TYPED_TEST(PropagatorTest, WatchingAnotherRowShowsItsPresentAndPredictedPlace) {
  const auto body = TypeParam::make(chain(0.5, 1e-3), Eigen::MatrixXd(3, 0), 0.01, 1, {});
  body->watch(0, 0);
  const double push = 5.0;
  for (int n = 0; n < 20; ++n) body->advance(&push);
  body->watch(0, 2);
  EXPECT_EQ(body->row(0), 2);
  EXPECT_NEAR(body->current(0), body->displacement(2), 1e-16);
  const double predicted = body->predicted(0);
  const double none = 0.0;
  body->advance(&none);
  EXPECT_NEAR(body->displacement(2), predicted, 1e-16);
}

TYPED_TEST(PropagatorTest, MoreSlotsThanAreFusedGiveTheSameMotion) {
  // Five slots on the same row share a force that one slot carries alone.
  const auto one = TypeParam::make(chain(0.5, 1e-3), Eigen::MatrixXd(3, 0), 0.01, 1, {});
  const auto five = TypeParam::make(chain(0.5, 1e-3), Eigen::MatrixXd(3, 0), 0.01, 5, {});
  one->watch(0, 1);
  for (int slot = 0; slot < 5; ++slot) five->watch(slot, 1);
  for (int n = 0; n < 100; ++n) {
    const double whole = std::sin(0.1 * n);
    const double parts[] = {0.4 * whole, 0.3 * whole, 0.2 * whole, 0.05 * whole, 0.05 * whole};
    one->advance(&whole);
    five->advance(parts);
  }
  for (int slot = 0; slot < 5; ++slot) {
    EXPECT_NEAR(five->current(slot), one->current(0), 1e-14);
    EXPECT_NEAR(five->predicted(slot), one->predicted(0), 1e-14);
  }
}

TYPED_TEST(PropagatorTest, GoesOnBitwiseAfterSaveAndLoad) {
  const double loads[] = {1.0};
  const Eigen::MatrixXd pattern = Eigen::Vector3d(0.0, 1.0, 0.0);
  const auto straight = TypeParam::make(chain(0.5, 1e-3), pattern, 0.01, 2, loads);
  const auto resumed = TypeParam::make(chain(0.5, 1e-3), pattern, 0.01, 2, loads);
  straight->watch(0, 0);
  straight->watch(1, 2);
  const auto force = [](int n, double* forces) {
    forces[0] = std::cos(0.3 * n);
    forces[1] = std::sin(0.2 * n);
  };
  double forces[2];
  for (int n = 0; n < 57; ++n) {
    force(n, forces);
    straight->advance(forces);
  }
  State state;
  straight->save(state, "body/");
  resumed->load(state, "body/");
  for (int n = 57; n < 200; ++n) {
    force(n, forces);
    straight->advance(forces);
    resumed->advance(forces);
  }
  for (int row = 0; row < 3; ++row)
    EXPECT_EQ(straight->displacement(row), resumed->displacement(row));
  for (int slot = 0; slot < 2; ++slot) {
    EXPECT_EQ(straight->predicted(slot), resumed->predicted(slot));
    EXPECT_EQ(straight->increment(slot), resumed->increment(slot));
  }
}

TYPED_TEST(PropagatorTest, RefusesTheStateOfAnotherBody) {
  const auto body = TypeParam::make(chain(0.5, 1e-3), Eigen::MatrixXd(3, 0), 0.01, 1, {});
  const auto other = TypeParam::make(oscillator(1.0, 10.0, 0.0, 0.0), no_patterns, 0.01, 1, {});
  State state;
  other->save(state, "");
  EXPECT_THROW(body->load(state, ""), std::invalid_argument);
  EXPECT_THROW(body->load(State{}, ""), std::invalid_argument);
}

TYPED_TEST(PropagatorTest, MassDampingCanChangeOnTheWay) {
  constexpr double step = 0.01;
  const auto body =
      TypeParam::make(oscillator(1.0, 25.0, 4.0, 0.0), Eigen::MatrixXd(1, 0), step, 1, {});
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

}  // namespace
}  // namespace stridor
