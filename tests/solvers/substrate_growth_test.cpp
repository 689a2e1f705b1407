// The verdict of the eigenvalues on the oscillator against its nonlinear motion, at random and at
// extreme parameters.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <Eigen/Eigenvalues>
#include <cmath>
#include <complex>
#include <vector>

#include "analysis/growth_field.hpp"
#include "analysis/limit_cycle.hpp"
#include "tests/support/random_spheres.hpp"
#include "tests/support/substrate_stepper.hpp"

namespace stridor {
namespace {

using test::paper_sphere;
using test::RandomSpheres;

/// The eigenvector of the adjoint motion that picks the leading eigenvalue out of a state (x, y,
/// ẋ, ẏ): lᴴ z(t) = lᴴ z(0) exp(st).
Eigen::Vector4cd adjoint_of_leading(const SmallMotion& motion, std::complex<double> leading) {
  Eigen::Matrix4d first_order = Eigen::Matrix4d::Zero();
  first_order.topRightCorner<2, 2>().setIdentity();
  first_order.bottomLeftCorner<2, 2>() = -motion.stiffness;
  first_order.bottomRightCorner<2, 2>() = -motion.damping;
  const Eigen::EigenSolver<Eigen::Matrix4d> solver(Eigen::Matrix4d(first_order.transpose()));
  Eigen::Index nearest = 0;
  (solver.eigenvalues().array() - leading).abs().minCoeff(&nearest);
  return solver.eigenvectors().col(nearest).conjugate();
}

/// Half the difference after some time of two motions that start on either side of an equilibrium:
/// what is of second order in the disturbance cancels.
Eigen::Vector4d disturbance_after(const SubstrateOscillator& oscillator,
                                  const Eigen::Vector2d& rest, const Eigen::Vector4d& disturbance,
                                  double time) {
  Eigen::Vector4d difference = Eigen::Vector4d::Zero();
  for (const double sign : {1.0, -1.0}) {
    SubstrateMotion motion(oscillator, 1e-13);
    motion.start(rest + sign * disturbance.head<2>(), sign * disturbance.tail<2>());
    EXPECT_EQ(motion.advance(time, false), SubstrateMotion::Stop::end);
    for (std::size_t k = 0; k < 4; ++k)
      difference[static_cast<Eigen::Index>(k)] += 0.5 * sign * motion.state()[k];
  }
  return difference;
}

TEST(SubstrateGrowth, VerdictOfTheEigenvaluesIsWhatADisturbedMotionDoes) {
  RandomSpheres spheres(4);
  std::mt19937 directions(5);
  std::normal_distribution<double> normal;
  int num_unstable = 0;
  int num_undecided = 0;
  for (int i = 0; i < 1000; ++i) {
    const SubstrateOscillator oscillator = make_sphere(spheres.next());
    const SubstrateEquilibrium rest = find_equilibrium(oscillator);
    ASSERT_TRUE(rest.converged);
    const SmallMotion small = small_motion(oscillator, rest);
    const std::complex<double> s = leading_eigenvalue(small);
    // The laws bend over a factor in speed and indentation.
    const double size =
        1e-4 * std::min(rest.displacement.y(), oscillator.substrate_speed) / (1.0 + std::abs(s));
    Eigen::Vector4d disturbance;
    for (double& component : disturbance) component = size * normal(directions);
    const double time = 3.0 / std::abs(s);
    const Eigen::Vector4cd adjoint = adjoint_of_leading(small, s);
    const std::complex<double> before = adjoint.dot(disturbance.cast<std::complex<double>>());
    const std::complex<double> after =
        adjoint.dot(disturbance_after(oscillator, rest.displacement, disturbance, time)
                        .cast<std::complex<double>>());
    const double growth = std::log(std::abs(after) / std::abs(before)) / time;
    const double tolerance = 1e-4 * std::abs(s);
    EXPECT_NEAR(growth, s.real(), tolerance) << i;
    if (std::abs(s.real()) < tolerance) {
      ++num_undecided;
    } else {
      EXPECT_EQ(growth > 0.0, s.real() > 0.0) << i;
      num_unstable += s.real() > 0.0;
    }
  }
  // Both verdicts occur, and hardly any is left open.
  EXPECT_GT(num_unstable, 100);
  EXPECT_LT(num_unstable, 900);
  EXPECT_LT(num_undecided, 10);
}

/// No shear strength and as much as the modulus; speeds and loads from end to end, both laws.
std::vector<test::PaperSphere> extreme_spheres() {
  std::vector<test::PaperSphere> spheres;
  for (const double shear : {0.0, 1.0}) {
    for (const double speed : {1e-8, 1e-4, 1.0, 1e3}) {
      for (const double load : {1e-8, 1e-4, 0.1}) {
        for (const SphereContactLaw law :
             {SphereContactLaw::published_fit, SphereContactLaw::boundary_element}) {
          spheres.push_back(paper_sphere(speed, shear));
          spheres.back().normal_load = load;
          spheres.back().contact_law = law;
        }
      }
    }
  }
  return spheres;
}

/// c_11 = 2 ξ_eq near 900: the damping of viscoelastic friction far below the speed where that is
/// largest.
test::PaperSphere stiff_sphere() {
  test::PaperSphere model = paper_sphere(std::pow(10.0, -3.45), 0.0);
  model.normal_load = 0.1;
  return model;
}

std::string described(const test::PaperSphere& model) {
  return fmt::format(
      "shear {:g} speed {:g} load {:g} law {}", model.shear_strength, model.speed,
      model.normal_load,
      model.contact_law == SphereContactLaw::published_fit ? "published" : "computed");
}

TEST(SubstrateExtremes, StiffEquilibriumHasAFastEigenvalueByItself) {
  const SubstrateOscillator oscillator = make_sphere(stiff_sphere());
  const SubstrateEquilibrium rest = find_equilibrium(oscillator);
  const SmallMotion motion = small_motion(oscillator, rest);
  EXPECT_NEAR(motion.damping(0, 0), 900.0, 300.0);
  // s → −c_11 + k_11/c_11, beside which nothing else is fast.
  double fastest = 0.0;
  for (const std::complex<double>& s : eigenvalues(motion)) {
    ASSERT_TRUE(std::isfinite(s.real()) && std::isfinite(s.imag()));
    fastest = std::min(fastest, s.real());
  }
  EXPECT_NEAR(fastest, -motion.damping(0, 0), 0.01 * motion.damping(0, 0));
}

TEST(SubstrateExtremes, ThresholdsAreFiniteAndAscend) {
  for (test::PaperSphere model : extreme_spheres()) {
    const auto margin = [&](double shear) {
      model.shear_strength = shear;
      const SubstrateOscillator oscillator = make_sphere(model);
      return stability_margin(small_motion(oscillator, find_equilibrium(oscillator)));
    };
    std::vector<double> values{0.0};
    for (int k = 0; k <= 200; ++k) values.push_back(std::pow(10.0, -8.0 + 0.04 * k));
    for (const double value : values) ASSERT_TRUE(std::isfinite(margin(value))) << described(model);
    double last = -1.0;
    for (const double root : sign_changes(margin, values)) {
      EXPECT_GT(root, last) << described(model);
      last = root;
      // Each is a change of the verdict within a rounding of the margin.
      EXPECT_NE(margin(root * (1.0 - 1e-9)) > 0.0, margin(root * (1.0 + 1e-9)) > 0.0)
          << described(model);
    }
  }
}

TEST(SubstrateExtremes, FixedStepsGoOn) {
  std::vector<test::PaperSphere> models = extreme_spheres();
  models.push_back(stiff_sphere());
  for (const test::PaperSphere& model : models) {
    const SubstrateOscillator oscillator = make_sphere(model);
    const SubstrateEquilibrium rest = find_equilibrium(oscillator);
    for (const Integrator integrator : {Integrator::central_difference, Integrator::exact}) {
      SubstrateStepper stepper(oscillator, integrator, 1e-3);
      stepper.start({rest.displacement.x(), 1.01 * rest.displacement.y()}, Eigen::Vector2d::Zero());
      bool goes_on = true;
      while (goes_on && stepper.steps() < 5000) goes_on = stepper.advance();
      ASSERT_TRUE(goes_on) << described(model) << " after step " << stepper.steps();
      EXPECT_TRUE(stepper.displacement().allFinite()) << described(model);
      EXPECT_TRUE(stepper.velocity().allFinite()) << described(model);
      EXPECT_TRUE(std::isfinite(stepper.normal_force())) << described(model);
      EXPECT_TRUE(std::isfinite(stepper.tangential_force())) << described(model);
    }
  }
}

TEST(SubstrateExtremes, MotionsSettleToACycleOrToAStableEquilibrium) {
  std::vector<test::PaperSphere> models = extreme_spheres();
  models.push_back(stiff_sphere());
  for (const test::PaperSphere& model : models) {
    const SubstrateOscillator oscillator = make_sphere(model);
    const SubstrateEquilibrium rest = find_equilibrium(oscillator);
    CycleOptions options;
    options.settle = 2000.0;
    options.tolerance = 1e-8;
    const LimitCycle cycle = find_limit_cycle(
        oscillator, {rest.displacement.x(), 1.01 * rest.displacement.y()}, {0.0, 0.0}, options);
    ASSERT_NE(cycle.status, CycleStatus::diverged) << described(model);
    const bool is_stable = leading_eigenvalue(small_motion(oscillator, rest)).real() < 0.0;
    EXPECT_TRUE(is_stable || cycle.status != CycleStatus::at_rest) << described(model);
    for (const double value : {cycle.x_rms, cycle.x_min, cycle.x_max, cycle.y_max,
                               cycle.stick_fraction, cycle.free_fraction, cycle.period})
      EXPECT_TRUE(std::isfinite(value)) << described(model);
    EXPECT_EQ(cycle.status == CycleStatus::periodic, cycle.period > 0.0) << described(model);
  }
}

}  // namespace
}  // namespace stridor
