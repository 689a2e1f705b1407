#include "solvers/exponential_propagator.hpp"

#include <gtest/gtest.h>

#include <Eigen/LU>
#include <Eigen/SVD>

#include <algorithm>
#include <cmath>
#include <complex>

#include "core/errors.hpp"
#include "solvers/dense_eigenvalues.hpp"
#include "tests/support/message_of.hpp"
#include "tests/support/reference_brake.hpp"

namespace stridor {
namespace {

using test::message_of;

LinearSystem oscillator(double mass, double damping, double stiffness) {
  LinearSystem system;
  system.mass = Eigen::MatrixXd::Constant(1, 1, mass);
  system.velocity = Eigen::MatrixXd::Constant(1, 1, damping);
  system.position = Eigen::MatrixXd::Constant(1, 1, stiffness);
  system.gaps = system.forces = Eigen::MatrixXd(0, 1);
  return system;
}

TEST(ExponentialPropagator, DampedOscillatorAtStepsOfManyPeriods) {
  // m 2, c 0.4, k 50: decay 0.1 and frequency (25 − 0.01)^½ rad/s.
  ExponentialPropagator propagator(oscillator(2.0, 0.4, 50.0), 3.7);
  Eigen::VectorXd q = Eigen::VectorXd::Constant(1, 1.0);
  Eigen::VectorXd v = Eigen::VectorXd::Zero(1);
  const double w = std::sqrt(25.0 - 0.01);
  for (int n = 1; n <= 5; ++n) {
    propagator.advance(q, v);
    const double t = 3.7 * n;
    const double expected = std::exp(-0.1 * t) * (std::cos(w * t) + 0.1 / w * std::sin(w * t));
    EXPECT_NEAR(q(0), expected, 1e-12);
  }
}

TEST(ExponentialPropagator, LinearForcesAreExact) {
  // q̈ + 9 q = 1 + 2t from rest: q = (1 + 2t)/9 − cos 3t/9 − 2 sin 3t/27.
  ExponentialPropagator propagator(oscillator(1.0, 0.0, 9.0), 0.8);
  Eigen::VectorXd q = Eigen::VectorXd::Zero(1);
  Eigen::VectorXd v = q;
  for (int n = 0; n < 10; ++n) {
    const double t = 0.8 * n;
    propagator.advance(q, v, Eigen::VectorXd::Constant(1, 1.0 + 2.0 * t),
                       Eigen::VectorXd::Constant(1, 1.0 + 2.0 * (t + 0.8)));
    const double end = t + 0.8;
    EXPECT_NEAR(q(0),
                (1.0 + 2.0 * end - std::cos(3.0 * end)) / 9.0 - 2.0 * std::sin(3.0 * end) / 27.0,
                1e-13);
  }
  EXPECT_NEAR(propagator.compliance()(0, 0), (1.0 - std::cos(2.4)) / 9.0, 1e-14);
}

TEST(ExponentialPropagator, ForcedRigidMotionIsAFall) {
  ExponentialPropagator propagator(oscillator(2.0, 0.0, 0.0), 0.5);
  Eigen::VectorXd q = Eigen::VectorXd::Zero(1);
  Eigen::VectorXd v = q;
  const Eigen::VectorXd weight = Eigen::VectorXd::Constant(1, -20.0);
  for (int n = 0; n < 4; ++n) propagator.advance(q, v, weight, weight);
  EXPECT_NEAR(q(0), -20.0, 1e-13);
  EXPECT_NEAR(v(0), -20.0, 1e-13);
}

TEST(ExponentialPropagator, FoucaultPendulumTurnsItsPlane) {
  // Without stiffness of the frame: q = e^{−iΩt} cos(ω't) in the complex plane.
  const double turn = 0.3;
  LinearSystem system;
  system.mass = Eigen::Matrix2d::Identity();
  system.velocity = Eigen::Matrix2d{{0.0, -2.0 * turn}, {2.0 * turn, 0.0}};
  system.position = 4.0 * Eigen::Matrix2d::Identity();
  system.gaps = system.forces = Eigen::MatrixXd(0, 2);
  ExponentialPropagator propagator(system, 1.1);
  Eigen::VectorXd q = Eigen::Vector2d(1.0, 0.0);
  Eigen::VectorXd v = Eigen::Vector2d(0.0, -turn);
  const double w = std::sqrt(4.0 + turn * turn);
  for (int n = 1; n <= 8; ++n) {
    propagator.advance(q, v);
    const double t = 1.1 * n;
    const std::complex<double> expected = std::polar(1.0, -turn * t) * std::cos(w * t);
    EXPECT_NEAR(q(0), expected.real(), 1e-12);
    EXPECT_NEAR(q(1), expected.imag(), 1e-12);
  }
}

TEST(ExponentialPropagator, BrakeGrowsFromItsEigenvectorAtTheRateOfItsEigenvalue) {
  const DiscModel model = make_disc_model(
      test::reference_brake({"gyroscopic", "friction", "friction_damping", "geometric"}));
  const DenseSpectrum spectrum = dense_spectrum(make_pencil(model.system));
  const auto fastest = std::max_element(
      spectrum.eigenvalues.begin(), spectrum.eigenvalues.end(),
      [](const Eigenvalue& a, const Eigenvalue& b) { return a.growth() < b.growth(); });
  // Modal coordinates of the pencil back to those of the system, then to those left.
  const Eigen::VectorXcd shape =
      make_pencil(model.system).slots * spectrum.right.col(fastest - spectrum.eigenvalues.begin());
  const EliminatedSystem eliminated = eliminate_constraints(model.system);
  const Eigen::VectorXcd a = eliminated.motion.transpose() * shape;
  const double step = 1e-4;
  ExponentialPropagator propagator(eliminated.system, step);
  Eigen::VectorXd q = a.real();
  Eigen::VectorXd v = (fastest->s * a).real();
  constexpr int num_steps = 5000;
  for (int n = 0; n < num_steps; ++n) propagator.advance(q, v);
  const double t = step * num_steps;
  const Eigen::VectorXcd grown = a * std::exp(fastest->s * t);
  EXPECT_LT((q - grown.real()).norm(), 1e-6 * grown.norm());
  // The energy-like norm of displacement and velocity grows at twice the rate.
  const double w = std::abs(fastest->s.imag());
  const auto size = [&](const Eigen::VectorXd& x, const Eigen::VectorXd& y) {
    return std::log(x.squaredNorm() + y.squaredNorm() / (w * w)) / 2.0;
  };
  const Eigen::VectorXcd rate = fastest->s * grown;
  EXPECT_NEAR(size(q, v), size(grown.real(), rate.real()), 1e-6);
  EXPECT_NEAR((size(q, v) - size(a.real(), (fastest->s * a).real())) / t, fastest->growth(),
              0.5 / t);
}

TEST(ExponentialPropagator, EliminationKeepsTheEigenvalues) {
  const DiscModel model = make_disc_model(test::reference_brake({"gyroscopic", "friction"}));
  const EliminatedSystem eliminated = eliminate_constraints(model.system);
  EXPECT_EQ(eliminated.system.size(), 17);
  EXPECT_LT((model.system.gaps * eliminated.motion).norm(), 1e-12 * model.system.gaps.norm());
  const Eigen::MatrixXd inverse = eliminated.system.mass.inverse();
  for (const Eigenvalue& one : dense_eigenvalues(make_pencil(model.system))) {
    const Eigen::MatrixXcd P = one.s * one.s * eliminated.system.mass.cast<std::complex<double>>() +
                               one.s * eliminated.system.velocity.cast<std::complex<double>>() +
                               eliminated.system.position.cast<std::complex<double>>();
    const Eigen::VectorXd sizes =
        Eigen::JacobiSVD<Eigen::MatrixXcd>(inverse.cast<std::complex<double>>() * P)
            .singularValues();
    EXPECT_LT(sizes(16), 1e-9 * sizes(0)) << one.frequency();
  }
}

TEST(ExponentialPropagator, RejectsWhatItCannotMarch) {
  LinearSystem system = oscillator(1.0, 0.0, 1.0);
  EXPECT_EQ(message_of<std::invalid_argument>([&] { ExponentialPropagator made(system, 0.0); }),
            "exponential propagator: a step of 0 s");
  system.mass(0, 0) = 0.0;
  EXPECT_EQ(message_of<NumericalError>([&] { ExponentialPropagator made(system, 1.0); }),
            "exponential propagator: the mass matrix is singular");
  system = oscillator(1.0, 0.0, 1.0);
  system.position = Eigen::MatrixXd::Identity(2, 2);
  EXPECT_EQ(message_of<std::invalid_argument>([&] { ExponentialPropagator made(system, 1.0); }),
            "exponential propagator: the matrices differ in size");
  system = oscillator(1.0, 0.0, 1.0);
  system.gaps = system.forces = Eigen::MatrixXd::Ones(1, 1);
  EXPECT_EQ(message_of<std::invalid_argument>([&] { ExponentialPropagator made(system, 1.0); }),
            "exponential propagator: constraints are to be eliminated first");
  system.gaps = system.forces = Eigen::MatrixXd::Ones(2, 1);
  EXPECT_EQ(message_of<NumericalError>([&] { eliminate_constraints(system); }),
            "constraints: the 2 rows of gaps have rank 1");
}

}  // namespace
}  // namespace stridor
