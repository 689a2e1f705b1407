// One suite for every way to march one body.
#include "solvers/integrators/propagator.hpp"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <memory>
#include <span>
#include <type_traits>
#include <vector>

#include "solvers/integrators/coupled_propagator.hpp"
#include "solvers/integrators/dense_two_step.hpp"
#include "tests/support/propagator_forms.hpp"

namespace stridor {
namespace {

using namespace test;

struct ModalForm {
  static std::unique_ptr<Propagator> make(const ReducedBody& body, const Eigen::MatrixXd& patterns,
                                          double step, int ports, std::span<const double> loads) {
    return make_modal_form<Integrator::central_difference>(body, patterns, step, ports, loads);
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
                                               exact_delta, ports, 0.0, loads, "chain");
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

}  // namespace
}  // namespace stridor
