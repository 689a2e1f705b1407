#include "coupling/kinematics/contact.hpp"
#include "tests/support/constants.hpp"

#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <cmath>
#include <limits>
#include <random>

namespace stridor {
namespace {

using Eigen::Vector2d;

using test::eps;

/// Slave point and ends of the master segment: positions, displacements, velocities or forces.
struct Triple {
  Vector2d slave, first, second;
};

double apply(const ContactRow& row, const Triple& u) {
  return row.slave[0] * u.slave.x() + row.slave[1] * u.slave.y() + row.master[0] * u.first.x() +
         row.master[1] * u.first.y() + row.master[2] * u.second.x() + row.master[3] * u.second.y();
}

/// −B_Eᵀ λ
Triple forces(const ContactRow& equilibrium, double lambda) {
  return {-lambda * Vector2d(equilibrium.slave[0], equilibrium.slave[1]),
          -lambda * Vector2d(equilibrium.master[0], equilibrium.master[1]),
          -lambda * Vector2d(equilibrium.master[2], equilibrium.master[3])};
}

double power(const Triple& force, const Triple& velocity) {
  return force.slave.dot(velocity.slave) + force.first.dot(velocity.first) +
         force.second.dot(velocity.second);
}

Vector2d direction(double angle) {
  return {std::cos(angle), std::sin(angle)};
}
Vector2d turned_left(const Vector2d& v) {
  return {-v.y(), v.x()};
}

Projection at(double xi, double angle) {
  return {xi, direction(angle), turned_left(direction(angle)), weights_at({}, xi).value};
}

void expect_rows_near(const ContactRow& a, const ContactRow& b, double tolerance) {
  for (std::size_t i = 0; i < 2; ++i) EXPECT_NEAR(a.slave[i], b.slave[i], tolerance) << i;
  for (std::size_t i = 0; i < a.master.size(); ++i)
    EXPECT_NEAR(a.master[i], b.master[i], tolerance) << i;
}

class Configurations {
 public:
  double number(double low, double high) {
    return std::uniform_real_distribution<double>(low, high)(generator_);
  }
  Vector2d point() { return {number(-1.0, 1.0), number(-1.0, 1.0)}; }
  /// Any slave, any segment that is not shorter than 0.1.
  Triple triple() {
    Triple t{point(), point(), point()};
    while ((t.second - t.first).norm() < 0.1) t.second = point();
    return t;
  }

 private:
  std::mt19937 generator_{20240607};
};

TEST(Project, XiIsZeroAndOneAtTheEndsOfTheSegment) {
  const Segment segment{{0.25, 1.0}, {0.75, 1.0}};
  EXPECT_EQ(project(segment, segment.first).xi, 0.0);
  EXPECT_EQ(project(segment, segment.second).xi, 1.0);
  EXPECT_EQ(project(segment, {0.5, 7.0}).xi, 0.5);
  EXPECT_EQ(project(segment, {0.0, 1.0}).xi, -0.5);
  EXPECT_EQ(project(segment, {1.25, 1.0}).xi, 2.0);
}

TEST(Project, NormalIsTheTangentTurnedLeft) {
  const Projection flat = project({{0.0, 0.0}, {2.0, 0.0}}, {1.0, 1.0});
  EXPECT_EQ(flat.tangent, Vector2d(1.0, 0.0));
  EXPECT_EQ(flat.normal, Vector2d(0.0, 1.0));
  const Projection backwards = project({{0.0, 0.0}, {-2.0, 0.0}}, {1.0, 1.0});
  EXPECT_EQ(backwards.normal, Vector2d(0.0, -1.0));
}

TEST(Project, FootPointIsOrthogonalBelowTheSlave) {
  // A handful of roundings on numbers of order 1, over lengths of at least 0.1.
  Configurations random;
  for (int i = 0; i < 1000; ++i) {
    const auto [slave, first, second] = random.triple();
    const Projection p = project({first, second}, slave);
    const Vector2d foot = (1.0 - p.xi) * first + p.xi * second;
    const double scale = 1.0 + std::abs(p.xi);
    EXPECT_NEAR(p.tangent.dot(slave - foot), 0.0, 32.0 * eps * scale) << i;
    EXPECT_NEAR(p.tangent.norm(), 1.0, 4.0 * eps);
    EXPECT_NEAR(p.tangent.dot(p.normal), 0.0, 4.0 * eps);
    EXPECT_NEAR(p.tangent.x() * p.normal.y() - p.tangent.y() * p.normal.x(), 1.0, 4.0 * eps);
  }
}

TEST(ProjectAlong, OwnTangentGivesTheOrthogonalProjection) {
  Configurations random;
  for (int i = 0; i < 1000; ++i) {
    const auto [slave, first, second] = random.triple();
    const Projection own = project({first, second}, slave);
    const Projection along = project_along({first, second}, slave, own.tangent);
    EXPECT_NEAR(along.xi, own.xi, 32.0 * eps * (1.0 + std::abs(own.xi)) / 0.1);
    EXPECT_EQ(along.tangent, own.tangent);
    EXPECT_EQ(along.normal, own.normal);
  }
}

TEST(ProjectAlong, FootPointLiesBelowTheSlaveAlongTheGivenNormal) {
  // The segment is turned against the given tangent by up to 60 degrees.
  Configurations random;
  for (int i = 0; i < 1000; ++i) {
    const double angle = random.number(-3.0, 3.0);
    const Vector2d first = random.point();
    const Vector2d second =
        first + random.number(0.1, 1.0) * direction(angle + random.number(-1.0, 1.0));
    const Vector2d slave = random.point();
    const Projection p = project_along({first, second}, slave, direction(angle));
    const Vector2d foot = (1.0 - p.xi) * first + p.xi * second;
    EXPECT_NEAR(direction(angle).dot(slave - foot), 0.0, 32.0 * eps * (1.0 + std::abs(p.xi)));
    EXPECT_EQ(p.tangent, direction(angle));
    EXPECT_EQ(p.normal, turned_left(direction(angle)));
  }
}

TEST(ProjectAlong, XiIsZeroAndOneAtTheEndsWhateverTheTangent) {
  const Segment segment{{0.2, 0.1}, {0.7, -0.3}};
  for (const double angle : {-0.6, 0.0, 0.5}) {
    EXPECT_EQ(project_along(segment, segment.first, direction(angle)).xi, 0.0);
    EXPECT_EQ(project_along(segment, segment.second, direction(angle)).xi, 1.0);
  }
}

TEST(ContactRows, OfAHorizontalSegment) {
  const ContactRows rows = make_rows(at(0.25, 0.0), 0.5, 1.0);
  expect_rows_near(rows.compatibility, {{0.0, -1.0}, {0.0, 0.75, 0.0, 0.25}}, 0.0);
  expect_rows_near(rows.equilibrium, {{0.5, -1.0}, {-0.375, 0.75, -0.125, 0.25}}, 0.0);
  const ContactRows backwards = make_rows(at(0.25, 0.0), 0.5, -1.0);
  expect_rows_near(backwards.compatibility, rows.compatibility, 0.0);
  expect_rows_near(backwards.equilibrium, {{-0.5, -1.0}, {0.375, 0.75, 0.125, 0.25}}, 0.0);
}

TEST(ContactRows, OfATiltedSegment) {
  const double mu = 0.3;
  for (const double angle : {-0.4, 0.1, 1.3, 2.9}) {
    for (const double chi : {-1.0, 1.0}) {
      for (const double xi : {0.0, 0.3, 1.0}) {
        const double c = std::cos(angle);
        const double s = std::sin(angle);
        const double x = chi * mu * c;
        const double y = chi * mu * s;
        const ContactRows rows = make_rows(at(xi, angle), mu, chi);
        expect_rows_near(rows.compatibility,
                         {{s, -c}, {-(1 - xi) * s, (1 - xi) * c, -xi * s, xi * c}}, 4.0 * eps);
        expect_rows_near(rows.equilibrium,
                         {{s + x, -c + y},
                          {-(1 - xi) * (s + x), (1 - xi) * (c - y), -xi * (s + x), xi * (c - y)}},
                         8.0 * eps);
      }
    }
  }
}

TEST(ContactRows, WithoutFrictionBothAreEqual) {
  Configurations random;
  for (int i = 0; i < 100; ++i) {
    const ContactRows rows =
        make_rows(at(random.number(0.0, 1.0), random.number(-3.0, 3.0)), 0.0, i % 2 ? 1.0 : -1.0);
    EXPECT_EQ(rows.equilibrium.slave, rows.compatibility.slave);
    EXPECT_EQ(rows.equilibrium.master, rows.compatibility.master);
  }
}

TEST(ContactRows, CommonTranslationOpensNothingAndForcesBalance) {
  Configurations random;
  for (int i = 0; i < 1000; ++i) {
    const ContactRows rows = make_rows(at(random.number(-0.2, 1.2), random.number(-3.0, 3.0)),
                                       random.number(0.0, 1.0), i % 2 ? 1.0 : -1.0);
    const Vector2d shift = random.point();
    EXPECT_NEAR(apply(rows.compatibility, {shift, shift, shift}), 0.0, 16.0 * eps);
    EXPECT_NEAR(apply(rows.equilibrium, {shift, shift, shift}), 0.0, 32.0 * eps);
    const Triple force = forces(rows.equilibrium, 0.2);
    EXPECT_LE((force.slave + force.first + force.second).norm(), 8.0 * eps);
  }
}

TEST(ContactRows, CommonRotationOpensNothingWhereTheSlaveTouches) {
  // Action and reaction share their line: no moment remains, with friction or without.
  Configurations random;
  for (int i = 0; i < 1000; ++i) {
    auto [slave, first, second] = random.triple();
    const double xi = random.number(0.0, 1.0);
    slave = (1.0 - xi) * first + xi * second;
    const ContactRows rows = make_rows(project({first, second}, slave), 0.3, i % 2 ? 1.0 : -1.0);
    const Triple turn{turned_left(slave), turned_left(first), turned_left(second)};
    EXPECT_NEAR(apply(rows.compatibility, turn), 0.0, 64.0 * eps / 0.1);
    EXPECT_NEAR(apply(rows.equilibrium, turn), 0.0, 64.0 * eps / 0.1);
  }
}

TEST(ContactRows, CompatibilityOfPositionsIsMinusTheGap) {
  Configurations random;
  for (int i = 0; i < 1000; ++i) {
    const Triple position = random.triple();
    const Segment segment{position.first, position.second};
    // Orthogonal: the distance from the line through the segment, positive on its left.
    const Vector2d along = position.second - position.first;
    const Vector2d to_slave = position.slave - position.first;
    const double gap = (along.x() * to_slave.y() - along.y() * to_slave.x()) / along.norm();
    const Projection own = project(segment, position.slave);
    const double tolerance = 64.0 * eps * (1.0 + std::abs(own.xi)) / 0.1;
    EXPECT_NEAR(apply(make_rows(own, 0.3, 1.0).compatibility, position), -gap, tolerance) << i;

    // Along a given normal: the distance in that direction to the point hit on the segment's line.
    const double tilt = std::atan2(along.y(), along.x()) + random.number(-0.5, 0.5);
    const Projection given = project_along(segment, position.slave, direction(tilt));
    const double distance = gap * along.norm() / along.dot(direction(tilt));
    EXPECT_NEAR(apply(make_rows(given, 0.3, 1.0).compatibility, position), -distance,
                tolerance + 64.0 * eps * (1.0 + std::abs(given.xi)) / 0.1)
        << i;
  }
}

TEST(ContactRows, PositiveMultiplierPushesTheBodiesApart) {
  const Triple force = forces(make_rows(at(0.25, 0.0), 0.0, 1.0).equilibrium, 2.0);
  EXPECT_EQ(force.slave, Vector2d(0.0, 2.0));
  EXPECT_EQ(force.first, Vector2d(0.0, -1.5));
  EXPECT_EQ(force.second, Vector2d(0.0, -0.5));
}

TEST(ContactRows, FrictionOpposesSliding) {
  // Sliding with v along t in the direction χ, the contact takes exactly λ μ |v| out.
  const double lambda = 0.2;
  const double mu = 0.3;
  Configurations random;
  for (int i = 0; i < 1000; ++i) {
    const double chi = i % 2 ? 1.0 : -1.0;
    const Projection projection = at(random.number(0.0, 1.0), random.number(-3.0, 3.0));
    const ContactRow row = make_rows(projection, mu, chi).equilibrium;
    const Vector2d common = random.point();
    const double speed = random.number(0.001, 1.0);
    const Triple velocity{common + chi * speed * projection.tangent, common, common};
    EXPECT_LT(power(forces(row, lambda), velocity), 0.0);
    EXPECT_NEAR(power(forces(row, lambda), velocity), -lambda * mu * speed, 32.0 * eps);
  }
}

TEST(ContactRows, SignOfFrictionAsPrintedWouldDriveTheSliding) {
  // BDF (21) as printed subtracts the friction terms. The row differs from that one, by twice them.
  const double lambda = 0.2;
  const double mu = 0.3;
  const Projection projection = at(0.4, 0.1);
  const ContactRows rows = make_rows(projection, mu, 1.0);
  ContactRow printed = rows.compatibility;
  printed.slave[0] -= mu * projection.tangent.x();
  printed.slave[1] -= mu * projection.tangent.y();
  for (std::size_t k = 0; k < 2; ++k) {
    const double weight = k == 0 ? 1.0 - projection.xi : projection.xi;
    printed.master[2 * k] += weight * mu * projection.tangent.x();
    printed.master[2 * k + 1] += weight * mu * projection.tangent.y();
  }
  const Triple sliding{0.03 * projection.tangent, Vector2d::Zero(), Vector2d::Zero()};
  EXPECT_GT(power(forces(printed, lambda), sliding), 0.0);
  EXPECT_LT(power(forces(rows.equilibrium, lambda), sliding), 0.0);
  EXPECT_NEAR(rows.equilibrium.slave[0] - printed.slave[0], 2.0 * mu * projection.tangent.x(),
              8.0 * eps);
}

TEST(ContactRows, StaticNormalForceBalancesTheLoad) {
  // Vertical balance of the slave body under F_y < 0: λ (cos g − χ μ sin g) = |F_y|.
  const double load = -0.2;
  for (const double mu : {0.0, 0.3}) {
    for (const double angle : {-0.05, 0.0, 0.02}) {
      for (const double chi : {-1.0, 1.0}) {
        const ContactRow row = make_rows(at(0.6, angle), mu, chi).equilibrium;
        const double lambda = std::abs(load) / (std::cos(angle) - chi * mu * std::sin(angle));
        EXPECT_NEAR(forces(row, lambda).slave.y() + load, 0.0, 8.0 * eps * std::abs(load));
      }
    }
  }
  // Trailing beam on a sagging master (g < 0, χ = +1): the normal force lies below the load.
  const double per_unit = forces(make_rows(at(0.6, -0.05), 0.3, 1.0).equilibrium, 1.0).slave.y();
  EXPECT_LT(std::abs(load) / per_unit, std::abs(load));
}

}  // namespace
}  // namespace stridor
