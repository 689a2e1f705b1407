// Discs with pads that are elastic bodies.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "solvers/eigenvalues/dense_eigenvalues.hpp"
#include "tests/support/disc_model.hpp"
#include "tests/support/reference_brake.hpp"

namespace stridor {
namespace {

using test::pencil_of;

DiscModelParameters elastic_brake(double youngs_modulus, int num_modes) {
  DiscModelParameters brake = test::reference_brake(
      {"gyroscopic", "friction", "friction_damping", "geometric", "structural_damping"});
  brake.disc.damping.beta = brake.pads.damping.beta = 1e-7;
  brake.pads.mass.reset();
  brake.pads.elastic.emplace();
  ElasticPadParameters& pad = *brake.pads.elastic;
  pad.length = 0.06;
  pad.thickness = 0.015;
  pad.width = 0.04;
  pad.material = {youngs_modulus, 0.3, 2500.0};
  pad.mesh = {6, 2};
  pad.reduction.fixed_interface_modes = num_modes;
  brake.contact.offsets = {-0.02, 0.0, 0.02};
  return brake;
}

/// The same with pads of four coordinates each, r, φ, normal and a turn θ, put together by hand
/// from the matrices of a rigid body whose springs are at its back, in contact by a penalty.
LinearSystem with_rigid_pads(const DiscModelParameters& brake) {
  const AnnularPlate plate(brake.disc.plate);
  const ElasticPadParameters& pad = *brake.pads.elastic;
  const PadStiffness& springs = brake.pads.stiffness;
  const double L = pad.length, H = pad.thickness;
  const double m = pad.material.density * L * H * pad.width;
  Eigen::Matrix4d M = Eigen::Vector4d(m, m, m, m * (L * L + H * H) / 12).asDiagonal();
  Eigen::Matrix4d K = Eigen::Matrix4d::Zero();
  K(0, 0) = springs.radial;
  const Eigen::RowVector4d along(0, 1, 0, -H / 2), away(0, 0, 1, 0), turn(0, 0, 0, 1);
  K += springs.circumferential * along.transpose() * along +
       springs.normal * (away.transpose() * away + L * L / 12 * turn.transpose() * turn) +
       springs.coupling * (along.transpose() * away + away.transpose() * along);
  const Eigen::Index n = plate.size();
  const double speed = brake.disc.speed;
  const Eigen::MatrixXd S = plate.spin();
  const Eigen::MatrixXd elastic = plate.omega().cwiseAbs2().asDiagonal();
  LinearSystem system;
  system.mass = Eigen::MatrixXd::Identity(n + 8, n + 8);
  system.velocity = system.position = Eigen::MatrixXd::Zero(n + 8, n + 8);
  const Eigen::MatrixXd C = brake.disc.damping.beta * elastic;
  system.velocity.topLeftCorner(n, n) = C + 2 * speed * S;
  system.position.topLeftCorner(n, n) = elastic - speed * speed * S.transpose() * S + speed * C * S;
  std::vector<FaceContact> contacts;
  const double N0 = *brake.contact.preload / 3.0;
  for (const int side : {1, -1}) {
    const Eigen::Index first = side > 0 ? n : n + 4;
    system.mass.block<4, 4>(first, first) = M;
    system.position.block<4, 4>(first, first) = K;
    system.velocity.block<4, 4>(first, first) = brake.pads.damping.beta * K;
    for (Eigen::Index i = 0; i < 3; ++i) {
      const double offset = brake.contact.offsets[static_cast<std::size_t>(i)];
      const double turned = offset / brake.pads.radius;
      FaceContact contact;
      contact.plate = plate.rows(brake.pads.radius, brake.pads.angle + turned);
      for (Eigen::VectorXd* row : {&contact.plate.w, &contact.plate.w_r, &contact.plate.w_phi,
                                   &contact.plate.w_r_phi, &contact.plate.w_phi_phi})
        row->conservativeResizeLike(Eigen::VectorXd::Zero(n + 8));
      const auto on_pad = [&](double r, double u, double v, double theta) {
        Eigen::VectorXd row = Eigen::VectorXd::Zero(n + 8);
        row.segment<4>(first) = Eigen::Vector4d(r, u, v, theta);
        return row;
      };
      // The face is at y = −H/2: u + θ H/2, v + θ x.
      const double c = std::cos(turned), s = std::sin(turned);
      contact.pad_r = on_pad(c, s, 0, s * H / 2);
      contact.pad_phi = on_pad(-s, c, 0, c * H / 2);
      contact.pad_z = side * on_pad(0, 0, 1, offset);
      contact.radius = brake.pads.radius;
      contact.half_thickness = brake.disc.plate.thickness / 2;
      contact.side = side;
      contacts.push_back(contact);
    }
  }
  const FaceContactLaw law{brake.contact.friction.coefficient, brake.contact.penalty, speed, true,
                           true};
  return linearise(system, contacts, law, prescribed_sliding_state(contacts, law, N0));
}

/// What vibrates; stiff pads also have motions that only decay.
std::vector<Eigenvalue> vibrating(const Pencil& pencil) {
  std::vector<Eigenvalue> found = dense_eigenvalues(pencil);
  std::erase_if(found, [](const Eigenvalue& one) { return one.s.imag() <= 0.0; });
  return found;
}

TEST(DiscWithElasticPads, StiffPadsAreRigidBodies) {
  // By a penalty: a rigid body cannot be held at three points of a line.
  DiscModelParameters brake = elastic_brake(1e16, 4);
  brake.contact.formulation = ContactFormulation::penalty;
  brake.contact.penalty = 1e9;
  const auto expected = vibrating(make_pencil(with_rigid_pads(brake)));
  const auto found = vibrating(pencil_of(brake));
  ASSERT_EQ(expected.size(), 21U);
  ASSERT_GE(found.size(), expected.size());
  for (std::size_t i = 0; i < expected.size(); ++i)
    EXPECT_LT(std::abs(found[i].s - expected[i].s), 1e-5 * std::abs(expected[i].s)) << i;
}

TEST(DiscWithElasticPads, EigenvaluesConvergeWithTheModesOfThePads) {
  const auto lowest = [](int num_modes) {
    auto found = vibrating(pencil_of(elastic_brake(1e10, num_modes)));
    found.resize(16);
    return found;
  };
  const DiscModelParameters brake = elastic_brake(1e10, 0);
  const auto exact = lowest(num_interior_dofs(*brake.pads.elastic, brake.contact.offsets));
  double last = 1e300;
  for (const int num_modes : {2, 6, 18, 36}) {
    const auto found = lowest(num_modes);
    double error = 0.0;
    for (std::size_t i = 0; i < exact.size(); ++i)
      error = std::max(error, std::abs(found[i].s - exact[i].s) / std::abs(exact[i].s));
    EXPECT_LT(error, 0.5 * last) << num_modes;
    last = error;
  }
  EXPECT_LT(last, 1e-4);
}

TEST(DiscWithElasticPads, TheAngleOfThePadsDoesNotMatter) {
  DiscModelParameters brake = elastic_brake(1e10, 10);
  const auto there = dense_eigenvalues(pencil_of(brake));
  for (const double angle : {0.4, 1.7, 5.0}) {
    brake.pads.angle = angle;
    const auto found = dense_eigenvalues(pencil_of(brake));
    ASSERT_EQ(found.size(), there.size());
    for (std::size_t i = 0; i < found.size(); ++i)
      EXPECT_LT(std::abs(found[i].s - there[i].s), 1e-12 * std::abs(there.back().s)) << angle;
  }
}

TEST(DiscWithElasticPads, ContactPointsAreTheNodesOfTheFaceUnlessNamed) {
  DiscModelParameters brake = elastic_brake(1e10, 10);
  brake.contact.offsets.clear();
  const DiscModel model = make_disc_model(brake);
  EXPECT_EQ(model.contacts.size(), 2U * 13U);
  EXPECT_EQ(model.system.gaps.rows(), 26);
  EXPECT_EQ(model.system.size(), 13 + 2 * (1 + 26 + 10));
}

TEST(DiscWithElasticPads, VerdictsHoldToHalfTheHighestModeOfAPad) {
  const DiscModelParameters brake = elastic_brake(1e10, 3);
  const PadBody pad =
      make_elastic_pad(*brake.pads.elastic, brake.pads.stiffness, brake.contact.offsets);
  const double omega = std::sqrt(pad.stiffness(pad.size() - 1, pad.size() - 1));
  EXPECT_NEAR(make_disc_model(brake).highest_frequency,
              std::min(0.5 * omega / (2.0 * std::acos(-1.0)),
                       make_disc_model(test::reference_brake({})).highest_frequency),
              1e-9 * omega);
}

}  // namespace
}  // namespace stridor
