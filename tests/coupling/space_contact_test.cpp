// Kinematics of points on planes and facets: exact derivatives.
#include "coupling/kinematics/space_contact.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

namespace stridor {
namespace {

/// A slave over a warped facet of which all nodes are displaced.
struct Over {
  FacetSurface surface;
  SpacePlace place;
  TangentPorts ports;
  double drawn = 0.7;

  Over(int corners, bool is_smooth, unsigned seed) {
    std::mt19937 random(seed);
    std::uniform_real_distribution<double> unit(-1.0, 1.0);
    surface.positions = {{0, 0, 0}, {0.1, 0.05, 1}, {1, 0.02, 1.2}, {1.1, 0.15, 0}};
    surface.facets = {{corners, {0, 1, 2, 3}}};
    connect_facets(surface, SurfaceKind::polyline);
    if (is_smooth) {
      auto& bulges = surface.bulges.emplace_back();
      for (Eigen::Vector3d& bulge : bulges)
        bulge = 0.1 * Eigen::Vector3d(unit(random), unit(random), unit(random));
    }
    surface.spin = {0.4, -0.3, 0.5};
    surface.axis_point = {-0.2, 0.3, 0.1};
    place.surface = 0;
    place.slave = {0.45, 0.2, 0.65};
    ports.resize(3 * surface.max_nodes() + 3);
    for (double& port : ports) port = 0.05 * unit(random);
  }

  TangentKinematics at(const TangentPorts& y) const {
    const SpaceInstant instant = space_instant(place, &surface, 0, 0.0, y, drawn);
    const Eigen::Vector2d on = closest_on(instant.deformed, instant.slave, {0.4, 0.4});
    return tangent_kinematics(instant, on, y.size());
  }
};

TEST(SpaceContact, DerivativesAreThoseOfGapDirectionsAndVelocity) {
  constexpr double h = 1e-5;
  for (const int corners : {3, 4}) {
    for (const bool is_smooth : {false, true}) {
      const Over over(corners, is_smooth, 7);
      const TangentKinematics at = over.at(over.ports);
      ASSERT_GT(at.gap, 0.01);
      for (Eigen::Index k = 0; k < over.ports.size(); ++k) {
        TangentPorts more = over.ports, less = over.ports;
        more[k] += h;
        less[k] -= h;
        const TangentKinematics after = over.at(more), before = over.at(less);
        const auto change = [&](const auto& a, const auto& b) -> TangentPorts {
          return (a - b) / (2.0 * h);
        };
        // Lengths are about 1: third derivatives are of some tens.
        constexpr double allowed = 1e-8;
        EXPECT_NEAR((after.gap - before.gap) / (2.0 * h), at.normal[k], allowed);
        EXPECT_LT((change(after.normal, before.normal) - at.normal_bending.col(k)).norm(), allowed)
            << corners << is_smooth << k;
        for (Eigen::Index i = 0; i < 2; ++i) {
          const auto& bending = at.friction_bending[static_cast<std::size_t>(i)];
          EXPECT_LT((change(after.friction.col(i), before.friction.col(i)) - bending.col(k)).norm(),
                    allowed)
              << corners << is_smooth << k << i;
          EXPECT_NEAR((after.velocity(i) - before.velocity(i)) / (2.0 * h), -at.turning(k, i),
                      allowed);
        }
      }
      EXPECT_LT((at.normal_bending - at.normal_bending.transpose()).norm(), 1e-12);
    }
  }
}

TEST(SpaceContact, ARigidMotionOfBothBodiesOpensNothing) {
  const Over over(4, true, 11);
  const TangentKinematics at = over.at(over.ports);
  TangentPorts moved(over.ports.size());
  for (Eigen::Index k = 0; k < moved.size(); k += 3) moved.segment<3>(k) << 0.3, -0.2, 0.5;
  EXPECT_NEAR(at.normal.dot(moved), 0.0, 1e-15);
  EXPECT_NEAR((at.friction.transpose() * moved).norm(), 0.0, 1e-15);
}

TEST(SpaceContact, AFlatFaceThatSpinsSlidesAsTheFaceOfAPlate) {
  // The tilted face of a disc of thickness h whose normals stay straight: w = a x + b y.
  constexpr double radius = 0.13, half = 0.006, speed = 25.0, a = 2e-5, b = -3e-5;
  const Eigen::Vector3d slave(3e-6, -4e-6, 5e-6);
  FacetSurface surface;
  surface.positions = {{0.12, -0.01, half}, {0.14, -0.01, half}, {0.14, 0.01, half},
                       {0.12, 0.01, half}};
  surface.facets = {{4, {0, 1, 2, 3}}};
  connect_facets(surface, SurfaceKind::polyline);
  surface.spin = {0.0, 0.0, speed};
  SpacePlace place;
  place.surface = 0;
  place.slave = {radius, 0.0, half};
  TangentPorts ports(15);
  for (Eigen::Index k = 0; k < 4; ++k) {
    const Eigen::Vector3d& at = surface.positions[static_cast<std::size_t>(k)];
    ports.segment<3>(3 * k) << -half * a, -half * b, a * at.x() + b * at.y();
  }
  ports.tail<3>() = slave;
  const SpaceInstant instant = space_instant(place, &surface, 0, 0.0, ports);
  const Eigen::Vector2d on = closest_on(instant.deformed, instant.slave, {0.5, 0.5});
  const TangentKinematics found = tangent_kinematics(instant, on, ports.size());

  FacePlace on_face;
  on_face.radius = radius;
  on_face.half_thickness = half;
  on_face.spin = speed;
  const FaceKinematics face = make_face_kinematics(on_face);
  FacePorts of_face;
  of_face << a * radius, a, b * radius, b, -a * radius, slave.y(), slave.z(), slave.x();
  const Eigen::Vector2d expected = face.velocity(of_face, FacePorts::Zero());
  // The first tangent is x, the radius; the second one y, along the circumference. What is of second order
  // in displacements is not in the face's.
  EXPECT_NEAR(found.velocity(0), expected(1), 1e-7 * speed * radius);
  EXPECT_NEAR(found.velocity(1), expected(0), 1e-4 * speed * radius);
  EXPECT_NEAR(found.gap, face.gap(of_face), 1e-8 * half);
  EXPECT_GT(std::abs(expected(1)), 1e-6 * speed * radius);
}

TEST(SpaceContact, FramesAreOrthonormalAndReferredToX) {
  const Eigen::Vector3d normal = Eigen::Vector3d(0.3, 0.8, -0.2).normalized();
  const SpaceFrame frame = space_frame(normal, reference_for(normal));
  Eigen::Matrix3d axes;
  axes << frame.tangents[0], frame.tangents[1], frame.normal;
  EXPECT_LT((axes.transpose() * axes - Eigen::Matrix3d::Identity()).norm(), 1e-15);
  EXPECT_NEAR(axes.determinant(), 1.0, 1e-15);
  EXPECT_GT(frame.tangents[0].x(), 0.0);
  EXPECT_NEAR(frame.tangents[1].x(), 0.0, 1e-15);
  EXPECT_EQ(reference_for(Eigen::Vector3d::UnitX()), Eigen::Vector3d::UnitZ());
}

}  // namespace
}  // namespace stridor
