#include "solvers/transient/substrate_oscillator.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <span>
#include <vector>

#include "solvers/eigenvalues/dense_eigenvalues.hpp"
#include "tests/support/paper_sphere.hpp"
#include "tests/support/random_spheres.hpp"

namespace stridor {
namespace {

using test::paper_sphere;
using test::RandomSpheres;

/// ẍ of the nonlinear equations while sliding.
Eigen::Vector2d acceleration(const SubstrateOscillator& oscillator, const Eigen::Vector2d& x,
                             const Eigen::Vector2d& v) {
  const SubstrateForces forces =
      oscillator.contact.at(x.y(), v.x() - oscillator.substrate_speed, -1.0);
  return oscillator.load + Eigen::Vector2d(forces.tangential.value, -forces.normal.value) -
         oscillator.damping * v - oscillator.stiffness * x;
}

/// Distance to the nearest of some numbers.
double distance(std::complex<double> s, std::span<const std::complex<double>> others) {
  double least = std::abs(s - others[0]);
  for (const std::complex<double>& other : others) least = std::min(least, std::abs(s - other));
  return least;
}

TEST(SubstrateOscillator, LinearisationIsTheDerivativeOfTheNonlinearEquations) {
  RandomSpheres spheres(1);
  for (int i = 0; i < 1000; ++i) {
    const SubstrateOscillator oscillator = make_sphere(spheres.next());
    const SubstrateEquilibrium rest = find_equilibrium(oscillator);
    ASSERT_TRUE(rest.converged);
    const SmallMotion motion = small_motion(oscillator, rest);
    const auto row = [&](int of, double step, bool of_velocity) {
      // Central differences of fourth order.
      const auto at = [&](double h) {
        Eigen::Vector2d x = rest.displacement;
        Eigen::Vector2d v = Eigen::Vector2d::Zero();
        (of_velocity ? v : x)[of] += h;
        return acceleration(oscillator, x, v);
      };
      return Eigen::Vector2d(-(8.0 * (at(step) - at(-step)) - (at(2.0 * step) - at(-2.0 * step))) /
                             (12.0 * step));
    };
    const double y = rest.displacement.y();
    const double v = oscillator.substrate_speed;
    // The error is of the fifth derivative, a few hundred times (1e-3)^4 of the size; rounding
    // takes 1e-16 of the terms over 1e-3 of the step.
    const double size = 1.0 + motion.stiffness.cwiseAbs().maxCoeff();
    const double rate = 1.0 + motion.damping.cwiseAbs().maxCoeff() + 1e-4 / v;
    EXPECT_NEAR((row(0, 1e-3, false) - motion.stiffness.col(0)).norm(), 0.0, 1e-8 * size) << i;
    EXPECT_NEAR((row(1, 1e-3 * y, false) - motion.stiffness.col(1)).norm(), 0.0,
                1e-8 * size + 1e-12 / y)
        << i;
    EXPECT_NEAR((row(0, 1e-3 * v, true) - motion.damping.col(0)).norm(), 0.0, 1e-8 * rate) << i;
    EXPECT_NEAR((row(1, 1e-3, true) - motion.damping.col(1)).norm(), 0.0, 1e-8 * rate) << i;
  }
}

TEST(SubstrateOscillator, EquilibriumIsOneAndTheOnlyOne) {
  RandomSpheres spheres(2);
  for (int i = 0; i < 1000; ++i) {
    const SubstrateOscillator oscillator = make_sphere(spheres.next());
    const SubstrateEquilibrium rest = find_equilibrium(oscillator);
    ASSERT_TRUE(rest.converged);
    const double y = rest.displacement.y();
    EXPECT_LT(acceleration(oscillator, rest.displacement, Eigen::Vector2d::Zero()).norm(),
              1e-13 * (1.0 + rest.displacement.norm() + std::abs(rest.forces.tangential.value)));
    int changes = 0;
    for (int k = -60; k < 60; ++k) {
      const double below = imbalance(oscillator, y * std::pow(10.0, (k + 0.3) / 15.0));
      const double above = imbalance(oscillator, y * std::pow(10.0, (k + 1.3) / 15.0));
      changes += (below > 0.0) != (above > 0.0);
    }
    EXPECT_EQ(changes, 1) << i;
    const SubstrateEquilibrium other = find_equilibrium(oscillator, 1e6 * y);
    EXPECT_NEAR(other.displacement.y(), y, 1e-13 * y);
  }
}

TEST(SubstrateOscillator, EigenvaluesAreThoseOfTheCommonSolvers) {
  RandomSpheres spheres(3);
  for (int i = 0; i < 300; ++i) {
    const SubstrateOscillator oscillator = make_sphere(spheres.next());
    const SubstrateEquilibrium rest = find_equilibrium(oscillator);
    for (const SmallMotionTerms terms :
         {SmallMotionTerms::all, SmallMotionTerms::without_damping}) {
      const SmallMotion motion = small_motion(oscillator, rest, terms);
      const auto closed = eigenvalues(motion);
      std::vector<std::complex<double>> dense;
      for (const Eigenvalue& one : dense_eigenvalues(make_pencil(oscillator, motion))) {
        dense.push_back(one.s);
        if (one.s.imag() > 0.0) dense.push_back(std::conj(one.s));
      }
      ASSERT_EQ(dense.size(), 4u);
      double size = 0.0;
      double apart = 1e300;
      for (std::size_t a = 0; a < 4; ++a) {
        size = std::max(size, std::abs(dense[a]));
        for (std::size_t b = 0; b < a; ++b) apart = std::min(apart, std::abs(dense[a] - dense[b]));
      }
      // Rounding moves two roots that lie close together by its root.
      const double tolerance = 1e-10 * size * (1.0 + 1e-2 * size / std::max(apart, 1e-6 * size));
      for (std::size_t a = 0; a < 4; ++a) {
        EXPECT_LT(distance(closed[a], dense), tolerance) << i << ' ' << a;
        EXPECT_LT(distance(dense[a], closed), tolerance) << i << ' ' << a;
      }
    }
  }
}

TEST(SubstrateOscillator, EquivalentDampingVanishesAtTheSpeedsOfThePaper) {
  // PPH, Fig. 4: zeros of ξ_eq over the speed at F̃_n = 7.5e-3 without shear strength.
  test::PaperSphere model = paper_sphere();
  model.normal_load = 7.5e-3;
  model.shear_strength = 0.0;
  const auto damping = [&](double speed) {
    model.speed = speed;
    const SubstrateOscillator oscillator = make_sphere(model);
    return small_motion(oscillator, find_equilibrium(oscillator)).damping(0, 0);
  };
  for (const double speed : {3.297711e-3, 0.1284937}) {
    const double below = damping(speed * (1.0 - 1e-6));
    const double above = damping(speed * (1.0 + 1e-6));
    EXPECT_LT(below * above, 0.0) << speed;
  }
}

TEST(SubstrateOscillator, NothingBreaksAtExtremes) {
  for (const double shear : {0.0, 1e-3, 1.0}) {
    for (const double speed : {1e-8, 1e-4, 1.0, 1e3}) {
      for (const double load : {1e-8, 1e-4, 0.1}) {
        for (const SphereContactLaw law :
             {SphereContactLaw::published_fit, SphereContactLaw::boundary_element}) {
          test::PaperSphere model = paper_sphere();
          model.contact_law = law;
          model.normal_load = load;
          model.shear_strength = shear;
          model.speed = speed;
          const SubstrateOscillator oscillator = make_sphere(model);
          const SubstrateEquilibrium rest = find_equilibrium(oscillator);
          ASSERT_TRUE(rest.converged);
          EXPECT_LT(rest.evaluations, 60);
          EXPECT_TRUE(std::isfinite(leading_eigenvalue(small_motion(oscillator, rest)).real()));
        }
      }
    }
  }
}

TEST(SubstrateOscillator, NotPressedOnMeansNoEquilibrium) {
  SubstrateOscillator oscillator = make_sphere(paper_sphere());
  oscillator.load.y() = -1.0;
  EXPECT_FALSE(find_equilibrium(oscillator).converged);
}

}  // namespace
}  // namespace stridor
