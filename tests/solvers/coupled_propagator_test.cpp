#include "solvers/integrators/coupled_propagator.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <array>
#include <cmath>
#include <complex>
#include <functional>
#include <optional>
#include <random>
#include <vector>

#include "core/errors.hpp"
#include "solvers/integrators/coupled_step.hpp"
#include "solvers/integrators/modal_recurrence.hpp"

namespace stridor {
namespace {

using Complex = std::complex<double>;

/// Four masses between springs, watched each; the first carries a load. Free motions up to
/// 28 rad/s.
ReducedBody damped_chain(double alpha, double beta) {
  ReducedBody body;
  body.mass = Eigen::Vector4d(1.0, 2.0, 0.5, 1.5).asDiagonal();
  body.stiffness = Eigen::Matrix4d{
      {300, -100, 0, 0}, {-100, 300, -200, 0}, {0, -200, 350, -150}, {0, 0, -150, 150}};
  body.damping.alpha = alpha;
  body.damping.beta = beta;
  body.rows = Eigen::Matrix4d::Identity();
  return body;
}

Eigen::Matrix4d skew(double scale, std::uint32_t seed) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> number(-scale, scale);
  Eigen::Matrix4d matrix = Eigen::Matrix4d::Zero();
  for (int i = 0; i < 4; ++i) {
    for (int j = 0; j < i; ++j) {
      matrix(i, j) = number(random);
      matrix(j, i) = -matrix(i, j);
    }
  }
  return matrix;
}

/// Gyroscopic and circulatory terms, and damping of one spring only.
ReducedBody coupled_chain(double gyroscopic, double circulatory) {
  ReducedBody body = damped_chain(0.1, 0.0);
  Eigen::Matrix4d damper = Eigen::Matrix4d::Zero();
  damper(3, 3) = 1.2;
  body.coupled = {damper + skew(gyroscopic, 1), skew(circulatory, 2)};
  return body;
}

/// M ü + V u̇ + Q u with everything in it, damping included.
struct FullMatrices {
  Eigen::Matrix4d mass, velocity, position;

  explicit FullMatrices(const ReducedBody& body)
      : mass(body.mass),
        velocity(body.damping.alpha * body.mass + body.damping.beta * body.stiffness),
        position(body.stiffness) {
    if (body.coupled.is_empty()) return;
    velocity += body.coupled.velocity;
    position += body.coupled.position;
  }
  /// Amplitude under f exp(iΩt).
  Eigen::Vector4cd response(const Eigen::Vector4d& force, double frequency) const {
    const Complex s(0.0, frequency);
    const Eigen::Matrix4cd dynamic =
        (s * s) * mass.cast<Complex>() + s * velocity.cast<Complex>() + position.cast<Complex>();
    return dynamic.lu().solve(force.cast<Complex>());
  }
};

constexpr double added = 0.02;

/// Ports on masses 0 and 2, which then move to 1 and 3; loads, damping and motion change too.
struct Driven {
  static constexpr int num_ports = 2;
  std::vector<double> seen;

  void look(Propagator& body, const double* forces) {
    for (int port = 0; port < num_ports; ++port) {
      seen.insert(seen.end(),
                  {body.predicted(port), body.expected(port), body.current(port),
                   body.increment(port), body.compliance(port, 0), body.compliance(port, 1)});
    }
    for (int row = 0; row < 4; ++row) seen.push_back(body.displacement(row));
    const Propagator::Motion motion = body.motion(forces);
    seen.insert(seen.end(), motion.displacement.begin(), motion.displacement.end());
    seen.insert(seen.end(), motion.velocity.begin(), motion.velocity.end());
    std::vector<double> position(4), increment(4);
    body.predict_step(forces, position, increment);
    seen.insert(seen.end(), position.begin(), position.end());
    seen.insert(seen.end(), increment.begin(), increment.end());
    if (!body.has_feedthrough()) return;
    body.predict_ahead();
    seen.insert(seen.end(), body.ahead(), body.ahead() + num_ports);
    seen.insert(seen.end(), body.ahead_compliances(), body.ahead_compliances() + 4);
  }

  void run(Propagator& body) {
    body.watch(0, 0);
    body.watch(1, 2);
    const Eigen::Vector4d u(0.3, -0.2, 0.1, 0.4), v(1.0, 2.0, -1.0, 0.5);
    if (body.has_feedthrough()) {
      body.predict_start(u, v);
      for (int port = 0; port < num_ports; ++port)
        seen.insert(seen.end(), {body.predicted(port), body.compliance(port, 0)});
    }
    std::array<double, num_ports> forces{3.0, -1.0};
    body.set_motion(u, v, forces.data());
    for (int n = 0; n < 60; ++n) {
      if (n == 20) body.watch(0, 1);
      if (n == 25) body.watch(1, 3);
      forces = {3.0 + std::sin(0.3 * n), -1.0 - 0.05 * n};
      body.settle(forces.data());
      look(body, forces.data());
      const double load[] = {0.2 * n};
      if (n == 30) body.set_loads(load);
      body.advance(forces.data());
    }
  }
};

class WithoutCoupling : public ::testing::TestWithParam<std::optional<double>> {};

TEST_P(WithoutCoupling, EveryNumberIsThatOfTheModes) {
  const double step = 0.03;
  const ReducedBody proportional = damped_chain(0.4, 2e-3);
  ReducedBody body = damped_chain(0.4, 0.0);
  body.coupled = {2e-3 * body.stiffness, Eigen::Matrix4d::Zero()};
  const ModalBody modes = make_modal(proportional);
  const ModalBody coupled = make_modal(body);
  ASSERT_TRUE(coupled.shapes.isApprox(modes.shapes, 1e-12));
  const Eigen::MatrixXd pattern = modes.shapes.transpose().col(0);
  const double load[] = {0.7};
  ModalRecurrence expected(modes, pattern, Integrator::exact, step, GetParam(), Driven::num_ports,
                           0.4, load);
  CoupledPropagator found(coupled, pattern, step, GetParam(), Driven::num_ports, 0.4, load, "body");
  ASSERT_EQ(found.has_feedthrough(), GetParam().has_value());
  Driven by_modes, by_matrices;
  by_modes.run(expected);
  by_matrices.run(found);
  ASSERT_EQ(by_matrices.seen.size(), by_modes.seen.size());
  for (std::size_t i = 0; i < by_modes.seen.size(); ++i)
    EXPECT_NEAR(by_matrices.seen[i], by_modes.seen[i], 1e-11) << i;
}

INSTANTIATE_TEST_SUITE_P(Feedthrough, WithoutCoupling,
                         ::testing::Values(std::nullopt, std::optional(0.0), std::optional(added)));

/// A body without forces, in its modes, and where it is after `num_steps`.
Eigen::Vector4d free_motion(const ReducedBody& body, double step, int num_steps,
                            const Eigen::Vector4d& u, const Eigen::Vector4d& v) {
  const ModalBody modal = make_modal(body);
  CoupledPropagator propagator(modal, Eigen::MatrixXd(4, 0), step, added, 0, body.damping.alpha, {},
                               "body");
  const Eigen::Matrix4d to_modal = modal.shapes.transpose() * body.mass;
  propagator.set_motion(to_modal * u, to_modal * v, nullptr);
  for (int n = 0; n < num_steps; ++n) {
    propagator.settle(nullptr);
    propagator.advance(nullptr);
  }
  propagator.settle(nullptr);
  return modal.shapes * propagator.motion(nullptr).displacement;
}

TEST(CoupledPropagator, DampingThatChangesActsFromTheNextInstantOn) {
  ReducedBody body = coupled_chain(3.0, 60.0);
  const ModalBody modal = make_modal(body);
  constexpr double step = 0.03;
  constexpr int before = 20;
  constexpr int after = 30;
  CoupledPropagator changing(modal, Eigen::MatrixXd(4, 0), step, std::nullopt, 0, 0.1, {}, "body");
  CoupledPropagator first(modal, Eigen::MatrixXd(4, 0), step, std::nullopt, 0, 0.1, {}, "body");
  CoupledPropagator second(modal, Eigen::MatrixXd(4, 0), step, std::nullopt, 0, 2.0, {}, "body");
  const auto run = [](Propagator& propagator, int num_steps) {
    for (int n = 0; n < num_steps; ++n) {
      propagator.settle(nullptr);
      propagator.advance(nullptr);
    }
    propagator.settle(nullptr);
    return propagator.motion(nullptr);
  };
  const Eigen::Vector4d u(0.3, -0.2, 0.1, 0.4), v(1.0, 2.0, -1.0, 0.5);
  for (CoupledPropagator* one : {&changing, &first}) one->set_motion(u, v, nullptr);
  run(changing, before - 1);
  changing.set_mass_damping(2.0);
  const Propagator::Motion found = run(changing, 1 + after);
  const Propagator::Motion between = run(first, before);
  second.set_motion(between.displacement, between.velocity, nullptr);
  const Propagator::Motion expected = run(second, after);
  EXPECT_TRUE(found.displacement.isApprox(expected.displacement, 1e-12));
  EXPECT_TRUE(found.velocity.isApprox(expected.velocity, 1e-12));
  EXPECT_FALSE(found.displacement.isApprox(run(first, after).displacement, 0.1));
}

TEST(CoupledPropagator, FreeMotionIsThatOfTheEigenvectors) {
  const ReducedBody body = coupled_chain(3.0, 60.0);
  const FullMatrices matrices(body);
  Eigen::MatrixXd companion = Eigen::MatrixXd::Zero(8, 8);
  companion.topRightCorner(4, 4).setIdentity();
  companion.bottomLeftCorner(4, 4) = -matrices.mass.inverse() * matrices.position;
  companion.bottomRightCorner(4, 4) = -matrices.mass.inverse() * matrices.velocity;
  const Eigen::EigenSolver<Eigen::MatrixXd> eigen(companion);
  ASSERT_GT(eigen.eigenvalues().real().maxCoeff(), 0.05) << "circulatory terms make it flutter";
  Eigen::VectorXd start(8);
  start << 0.3, -0.2, 0.1, 0.4, 1.0, 2.0, -1.0, 0.5;
  const Eigen::VectorXcd shares = eigen.eigenvectors().lu().solve(start.cast<Complex>());
  for (const double step : {0.06, 0.03, 0.001}) {
    const int num_steps = static_cast<int>(std::lround(2.1 / step));
    const double time = num_steps * step;
    const Eigen::VectorXcd end =
        eigen.eigenvectors() *
        ((time * eigen.eigenvalues().array()).exp() * shares.array()).matrix();
    const Eigen::Vector4d found = free_motion(body, step, num_steps, start.head(4), start.tail(4));
    EXPECT_TRUE(found.isApprox(end.real().head(4), 1e-10)) << step;
  }
}

/// Largest difference from the response of the equations to a force on mass 2 that comes up slowly
/// enough to leave no free motion behind, over the last period.
double response_error(const ReducedBody& body, double step, std::optional<double> delta) {
  const ModalBody modal = make_modal(body);
  CoupledPropagator propagator(modal, Eigen::MatrixXd(4, 0), step, delta, 1, body.damping.alpha, {},
                               "body");
  propagator.watch(0, 2);
  constexpr double frequency = 5.0;
  constexpr int row = 1;
  const Complex amplitude = FullMatrices(body).response(Eigen::Vector4d::Unit(2), frequency)(row);
  const auto num_steps = static_cast<int>(std::lround(120.0 / step));
  double largest = 0.0;
  for (int n = 0; n <= num_steps; ++n) {
    const double t = n * step;
    const double rise = t < 30.0 ? 0.5 - 0.5 * std::cos(M_PI * t / 30.0) : 1.0;
    const double force[] = {rise * std::cos(frequency * t)};
    propagator.settle(force);
    if (t > 118.0) {
      const double exact = (amplitude * std::exp(Complex(0.0, frequency * t))).real();
      largest = std::max(largest, std::abs(propagator.displacement(row) - exact));
    }
    propagator.advance(force);
  }
  return largest / std::abs(amplitude);
}

TEST(CoupledPropagator, ForcesActWithTheSecondOrderOfTheStep) {
  const ReducedBody body = coupled_chain(3.0, 10.0);
  for (const std::optional<double>& delta : {std::optional<double>(), std::optional(0.0)}) {
    const double coarse = response_error(body, 0.02, delta);
    const double fine = response_error(body, 0.01, delta);
    EXPECT_LT(coarse, 0.02);
    EXPECT_GT(std::log2(coarse / fine), 1.9) << coarse << ' ' << fine;
  }
}

TEST(CoupledPropagator, AnswersAConstantForceAsTheStatics) {
  const ReducedBody body = coupled_chain(3.0, 40.0);
  const ModalBody modal = make_modal(body);
  const Eigen::Matrix4d flexibility = FullMatrices(body).position.inverse();
  const Eigen::MatrixXd pattern = modal.shapes.transpose().col(0);
  const double load[] = {2.0};
  for (const std::optional<double>& delta : {std::optional<double>(), std::optional(added)}) {
    CoupledPropagator propagator(modal, pattern, 0.05, delta, 1, body.damping.alpha, load, "body");
    propagator.watch(0, 3);
    const double force[] = {-5.0};
    const Eigen::Vector4d expected = flexibility * Eigen::Vector4d(2.0, 0.0, 0.0, -5.0);
    // Where it begins, it stays.
    const Eigen::Vector4d start = modal.shapes.transpose() * body.mass * expected;
    propagator.set_motion(start, Eigen::Vector4d::Zero(), force);
    for (int n = 0; n < 100; ++n) {
      propagator.settle(force);
      for (int row = 0; row < 4; ++row)
        ASSERT_NEAR(propagator.displacement(row), expected(row), 1e-13) << n;
      EXPECT_LT(propagator.motion(force).velocity.norm(), 1e-12);
      propagator.advance(force);
    }
  }
}

TEST(CoupledPropagator, GyroscopicTermsDoNoWork) {
  ReducedBody body = damped_chain(0.0, 0.0);
  body.coupled = {skew(8.0, 3), Eigen::Matrix4d::Zero()};
  const ModalBody modal = make_modal(body);
  CoupledPropagator propagator(modal, Eigen::MatrixXd(4, 0), 0.06, added, 0, 0.0, {}, "body");
  const auto energy = [&] {
    propagator.settle(nullptr);
    const Propagator::Motion motion = propagator.motion(nullptr);
    return 0.5 * motion.velocity.squaredNorm() +
           0.5 * modal.omega.cwiseProduct(motion.displacement).squaredNorm();
  };
  propagator.set_motion(Eigen::Vector4d(0.1, 0.2, -0.1, 0.3), Eigen::Vector4d(1, -2, 0.5, 1),
                        nullptr);
  const double before = energy();
  for (int n = 0; n < 100000; ++n) propagator.advance(nullptr);
  EXPECT_NEAR(energy() / before, 1.0, 1e-9);
}

TEST(CoupledPropagator, GoesOnBitwiseFromItsState) {
  const ReducedBody body = coupled_chain(3.0, 10.0);
  const ModalBody modal = make_modal(body);
  const auto make = [&] {
    auto made =
        std::make_unique<CoupledPropagator>(modal, Eigen::MatrixXd(4, 0), 0.02, added, 2,
                                            body.damping.alpha, std::span<const double>(), "body");
    made->watch(1, 3);
    return made;
  };
  const auto whole = make();
  const auto go = [](Propagator& propagator, int from, int to) {
    for (int n = from; n < to; ++n) {
      const double forces[] = {std::sin(0.1 * n), 1.0};
      propagator.settle(forces);
      propagator.advance(forces);
    }
  };
  go(*whole, 0, 50);
  State state;
  whole->save(state, "");
  const auto resumed = make();
  resumed->load(state, "");
  go(*whole, 50, 90);
  go(*resumed, 50, 90);
  const double none[] = {0.0, 0.0};
  EXPECT_EQ(whole->motion(none).displacement, resumed->motion(none).displacement);
  EXPECT_EQ(whole->motion(none).velocity, resumed->motion(none).velocity);
  EXPECT_EQ(whole->predicted(1), resumed->predicted(1));
}

/// G of two directions with the impulse that r takes at once, and the answer to a force that
/// changes its sign with every step.
TEST(CoupledStep, KeepsTheSymplecticFormOfAGyroscopicBody) {
  ReducedBody body = damped_chain(0.0, 0.0);
  body.coupled = {skew(8.0, 3), Eigen::Matrix4d::Zero()};
  const ModalBody modal = make_modal(body);
  for (const double delta : {0.0, 0.1, 0.2}) {
    const CoupledStep step = make_coupled_step(modal, 0.055, delta, 0.0, "body");
    // (Ω x)ᵀ y = x_rᵀ 𝒢 y_r + x_rᵀ y_v − x_vᵀ y_r, the form of the body, which e^{Ah} keeps.
    const Eigen::Matrix4d gyroscopic = modal.coupled.velocity;
    Eigen::MatrixXd form = Eigen::MatrixXd::Zero(8, 8);
    form.topLeftCorner(4, 4) = gyroscopic;
    form.topRightCorner(4, 4).setIdentity();
    form.bottomLeftCorner(4, 4) = -Eigen::Matrix4d::Identity();
    EXPECT_LT((step.free.transpose() * form * step.free - form).norm(), 1e-11 * form.norm());
    // A kick λ = P⁻¹ C x with J and P = G keeps Ω g(A)⁻¹; with any row b the answer of r to forces
    // on others is as theirs on it but for the skew impulse, half of which G holds.
    const Eigen::MatrixXd impulse = step.free.partialPivLu().solve(step.by_force);
    const Eigen::Matrix4d at_once = impulse.topRows(4);
    EXPECT_GT(at_once.norm(), 1e-3 * step.feedthrough.norm());
    EXPECT_LT((at_once + at_once.transpose()).norm(), 1e-12 * step.feedthrough.norm());
    EXPECT_LT((step.feedthrough - step.feedthrough.transpose() - at_once).norm(), 1e-12 * step.feedthrough.norm());
    const Eigen::MatrixXd excess = step.feedthrough - step.alternating();
    EXPECT_LT((excess - excess.transpose()).norm(), 1e-11 * step.feedthrough.norm());
  }
}

TEST(CoupledPropagator, RefusesAStepThatItsFastestMotionOutruns) {
  const ReducedBody body = coupled_chain(3.0, 10.0);
  try {
    CoupledPropagator(make_modal(body), Eigen::MatrixXd(4, 0), 0.1, added, 0, 0.1, {}, "rotor");
    FAIL() << "the fastest motion has 28 rad/s";
  } catch (const ConfigError& error) {
    EXPECT_EQ(error.problems().front().key, "time.step");
    EXPECT_THAT(error.what(), ::testing::HasSubstr("the fastest free motion of 'rotor'"));
  }
}

}  // namespace
}  // namespace stridor
