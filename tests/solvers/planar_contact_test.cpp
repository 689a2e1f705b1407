// Contacts with two tangents: friction against a slip that is a vector.
#include <gtest/gtest.h>

#include <Eigen/Eigenvalues>
#include <Eigen/LU>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>
#include <random>
#include <vector>

#include "solvers/contact/contact_solver.hpp"

namespace stridor {
namespace {

/// A random compliance of bodies, symmetric positive definite.
Eigen::MatrixXd random_compliance(Eigen::Index size, std::mt19937& random) {
  std::normal_distribution<double> normal;
  Eigen::MatrixXd root(size, size + 1);
  for (Eigen::Index i = 0; i < root.size(); ++i) root(i) = normal(random);
  return root * root.transpose() + 0.05 * Eigen::MatrixXd::Identity(size, size);
}

/// Forces of one contact by brute force: without force, sticking, or the direction of the slip tried
/// out all around. Empty where none obeys.
std::vector<Eigen::Vector3d> brute_force(const PlanarProblem& contact, const Eigen::Matrix3d& D) {
  const Eigen::Vector3d known(contact.penetration, contact.slip.x(), contact.slip.y());
  if (known(0) <= 0.0) return {Eigen::Vector3d::Zero()};
  std::vector<Eigen::Vector3d> found;
  const Eigen::Vector3d sticking = D.fullPivLu().solve(known);
  if (sticking(0) > 0.0 && sticking.tail<2>().norm() <= contact.sticking_friction * sticking(0))
    return {sticking};
  const double mu = contact.sliding_friction;
  if (mu == 0.0) return {Eigen::Vector3d(known(0) / D(0, 0), 0.0, 0.0)};
  const auto forces_at = [&](double angle) {
    const Eigen::Vector2d d(std::cos(angle), std::sin(angle));
    const double normal = known(0) / (D(0, 0) + mu * D.block<1, 2>(0, 1).dot(d.transpose()));
    return Eigen::Vector3d(normal, mu * normal * d.x(), mu * normal * d.y());
  };
  const auto miss = [&](double angle) {
    const Eigen::Vector2d slip = (known - D * forces_at(angle)).tail<2>();
    return std::cos(angle) * slip.y() - std::sin(angle) * slip.x();
  };
  constexpr int num_angles = 720;
  for (int k = 0; k < num_angles; ++k) {
    double low = 2.0 * std::numbers::pi * k / num_angles;
    double high = 2.0 * std::numbers::pi * (k + 1) / num_angles;
    if (miss(low) * miss(high) > 0.0) continue;
    for (int i = 0; i < 60; ++i) {
      const double middle = 0.5 * (low + high);
      (miss(low) * miss(middle) > 0.0 ? low : high) = middle;
    }
    const Eigen::Vector3d forces = forces_at(low);
    const Eigen::Vector2d slip = (known - D * forces).tail<2>();
    if (forces(0) > 0.0 && slip.dot(forces.tail<2>()) > 0.0) found.push_back(forces);
  }
  return found;
}

TEST(PlanarContact, ObeysItsConditionsAsFoundByBruteForce) {
  std::mt19937 random(7);
  std::normal_distribution<double> normal;
  std::uniform_real_distribution<double> coefficient(0.0, 1.2);
  std::array<int, 3> met{};
  for (int i = 0; i < 6000; ++i) {
    const Eigen::Matrix3d D = random_compliance(3, random);
    PlanarProblem contact;
    contact.is_unilateral = true;
    contact.penetration = normal(random) + 0.5;
    contact.slip = {normal(random), normal(random)};
    contact.sliding_friction = i % 50 == 0 ? 0.0 : coefficient(random);
    contact.sticking_friction = contact.sliding_friction * (i % 3 == 0 ? 1.5 : 1.0);
    const Eigen::Vector3d known(contact.penetration, contact.slip.x(), contact.slip.y());
    ASSERT_TRUE(solve_planar(contact, D, known)) << i;
    const Eigen::Vector3d forces(contact.normal, contact.tangential.x(), contact.tangential.y());
    double nearest = std::numeric_limits<double>::infinity();
    for (const Eigen::Vector3d& other : brute_force(contact, D))
      nearest = std::min(nearest, (forces - other).norm());
    // 60 bisections leave nothing but rounding, which D amplifies by its condition.
    ASSERT_LT(nearest, 1e-9 * (1.0 + forces.norm())) << i;
    ++met[static_cast<std::size_t>(contact.state)];
  }
  for (const int times : met) EXPECT_GT(times, 400);
}

TEST(PlanarContact, AlongOneTangentIsTheContactWithOne) {
  // Slip and compliance along the first tangent alone: the same forces as with one tangent.
  std::mt19937 random(3);
  std::normal_distribution<double> normal;
  for (int i = 0; i < 500; ++i) {
    const Eigen::Matrix2d line_compliance = random_compliance(2, random);
    Eigen::Matrix3d D = Eigen::Matrix3d::Identity();
    D.topLeftCorner<2, 2>() = line_compliance;
    LocalProblem line;
    line.is_unilateral = true;
    line.penetration = normal(random);
    line.slip = normal(random);
    line.sliding_friction = 0.4;
    line.sticking_friction = 0.5;
    PlanarProblem contact;
    contact.is_unilateral = true;
    contact.sliding_friction = 0.4;
    contact.sticking_friction = 0.5;
    ASSERT_TRUE(solve_line(line, line_compliance, line.penetration, line.slip));
    ASSERT_TRUE(solve_planar(contact, D, {line.penetration, line.slip, 0.0}));
    EXPECT_EQ(contact.state, line.state);
    EXPECT_NEAR(contact.normal, line.normal, 1e-12 * (1.0 + line.normal));
    EXPECT_NEAR(contact.tangential.x(), line.tangential, 1e-12 * (1.0 + line.normal));
    EXPECT_NEAR(contact.tangential.y(), 0.0, 1e-15);
  }
}

TEST(PlanarContact, RegularisedFrictionIsThatOfItsSlipVelocity) {
  std::mt19937 random(5);
  std::normal_distribution<double> normal;
  FrictionLaw law = constant_friction(0.5);
  int crept = 0;
  for (const auto kind : {RegularisedSign::Kind::tanh, RegularisedSign::Kind::linear,
                          RegularisedSign::Kind::square_root, RegularisedSign::Kind::atan}) {
    for (const double speed : {1.0, 1e-3, 1e-8}) {
      law.sign = {kind, speed};
      for (int i = 0; i < 200; ++i) {
        const Eigen::Matrix3d D = random_compliance(3, random);
        PlanarProblem contact;
        contact.is_unilateral = true;
        contact.creep = &law;
        contact.step = 0.1;
        const Eigen::Vector3d known(std::abs(normal(random)), normal(random), normal(random));
        ASSERT_TRUE(solve_planar(contact, D, known));
        const Eigen::Vector3d forces(contact.normal, contact.tangential.x(),
                                     contact.tangential.y());
        const Eigen::Vector3d left = known - D * forces;
        EXPECT_NEAR(left(0), 0.0, 1e-12 * D.norm() * forces.norm());
        const double v = left.tail<2>().norm() / contact.step;
        const double limit = sliding_friction(law, v) * contact.normal;
        // Where it creeps v is the difference of nearly equal numbers; friction is then checked by
        // the slip that belongs to it.
        const double rounding = 1e-12 * D.norm() * forces.norm() / contact.step;
        EXPECT_NEAR(contact.tangential.norm(), limit,
                    1e-9 * contact.normal +
                        sliding_friction_slope(law, v) * contact.normal * rounding);
        if (v > 1e3 * rounding) {
          EXPECT_NEAR(left.tail<2>().dot(contact.tangential),
                      left.tail<2>().norm() * contact.tangential.norm(),
                      1e-6 * left.tail<2>().norm() * contact.tangential.norm());
        }
        crept += v < law.sign.speed ? 1 : 0;
      }
    }
  }
  EXPECT_GT(crept, 100);
}

TEST(PlanarContact, SeveralOfBothKindsObeyTheirConditionsTogether) {
  std::mt19937 random(11);
  std::normal_distribution<double> normal;
  int num_converged = 0;
  for (int i = 0; i < 300; ++i) {
    constexpr int num_lines = 2, num_planar = 3;
    ContactSolver solver(num_lines, {}, num_planar);
    const Eigen::Index size = 2 * num_lines + 3 * num_planar;
    solver.delassus() =
        0.1 * random_compliance(size, random) + 2.0 * Eigen::MatrixXd::Identity(size, size);
    std::vector<LocalProblem> lines(num_lines);
    std::vector<PlanarProblem> planar(num_planar);
    for (LocalProblem& one : lines) {
      one.is_unilateral = true;
      one.penetration = normal(random) + 0.3;
      one.slip = normal(random);
      one.sliding_friction = one.sticking_friction = 0.4;
    }
    for (PlanarProblem& one : planar) {
      one.is_unilateral = true;
      one.penetration = normal(random) + 0.3;
      one.slip = {normal(random), normal(random)};
      one.sliding_friction = one.sticking_friction = 0.4;
    }
    const ContactAnswer answer = solver.solve(lines, planar);
    ASSERT_EQ(answer.status, ContactStatus::converged) << i;
    ++num_converged;
    Eigen::VectorXd forces(size), left(size);
    for (int k = 0; k < num_lines; ++k) {
      const LocalProblem& one = lines[static_cast<std::size_t>(k)];
      forces.segment<2>(2 * k) << one.normal, one.tangential;
      left.segment<2>(2 * k) << one.penetration, one.slip;
    }
    for (int k = 0; k < num_planar; ++k) {
      const PlanarProblem& one = planar[static_cast<std::size_t>(k)];
      forces.segment<3>(solver.first_planar(k)) << one.normal, one.tangential;
      left.segment<3>(solver.first_planar(k)) << one.penetration, one.slip;
    }
    left -= solver.delassus() * forces;
    const auto check = [&](Eigen::Index row, Eigen::Index num_tangents, ContactState state) {
      const double pressure = forces(row);
      const Eigen::VectorXd friction = forces.segment(row + 1, num_tangents);
      const Eigen::VectorXd slip = left.segment(row + 1, num_tangents);
      constexpr double rounding = 1e-9;
      EXPECT_GE(pressure, 0.0);
      if (state == ContactState::open) {
        EXPECT_LE(left(row), rounding);
        EXPECT_EQ(pressure, 0.0);
        return;
      }
      EXPECT_NEAR(left(row), 0.0, rounding);
      if (state == ContactState::stick) {
        EXPECT_NEAR(slip.norm(), 0.0, rounding);
        EXPECT_LE(friction.norm(), 0.4 * pressure + rounding);
        return;
      }
      EXPECT_NEAR(friction.norm(), 0.4 * pressure, rounding);
      EXPECT_NEAR(friction.dot(slip), friction.norm() * slip.norm(), rounding);
    };
    for (int k = 0; k < num_lines; ++k) check(2 * k, 1, lines[static_cast<std::size_t>(k)].state);
    for (int k = 0; k < num_planar; ++k)
      check(solver.first_planar(k), 2, planar[static_cast<std::size_t>(k)].state);
  }
  EXPECT_EQ(num_converged, 300);
}

TEST(PlanarContact, PersistentSlidingIsOneLinearSystem) {
  // All bilateral: the forces close every gap, with friction along the directions given.
  std::mt19937 random(2);
  ContactSolver solver(1, {}, 2);
  solver.delassus() = random_compliance(8, random) + 5.0 * Eigen::MatrixXd::Identity(8, 8);
  std::vector<LocalProblem> lines(1);
  lines[0].penetration = 1.0;
  lines[0].sliding_friction = 0.2;
  lines[0].direction = -1.0;
  std::vector<PlanarProblem> planar(2);
  planar[0].penetration = -0.7;
  planar[0].sliding_friction = 0.3;
  planar[0].direction = {0.6, 0.8};
  planar[1].penetration = 0.4;
  planar[1].sliding_friction = 0.1;
  planar[1].direction = {0.0, 1.0};
  ASSERT_EQ(solver.solve(lines, planar).status, ContactStatus::converged);
  Eigen::VectorXd forces(8);
  forces << lines[0].normal, lines[0].tangential, planar[0].normal, planar[0].tangential,
      planar[1].normal, planar[1].tangential;
  const Eigen::VectorXd moved = solver.delassus() * forces;
  EXPECT_NEAR(moved(0), 1.0, 1e-14);
  EXPECT_NEAR(moved(2), -0.7, 1e-14);
  EXPECT_NEAR(moved(5), 0.4, 1e-14);
  EXPECT_NEAR(lines[0].tangential, -0.2 * lines[0].normal, 1e-15);
  EXPECT_LT((planar[0].tangential - 0.3 * planar[0].normal * planar[0].direction).norm(), 1e-15);
}

}  // namespace
}  // namespace stridor
