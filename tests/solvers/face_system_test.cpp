// A disc between pads as an ordinary system, against the model that is assembled for discs alone.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <complex>
#include <string>
#include <vector>

#include "coupling/laws/stribeck_friction.hpp"
#include "solvers/eigenvalues/dense_eigenvalues.hpp"
#include "solvers/eigenvalues/linear_pencil.hpp"
#include "solvers/equilibrium/linearise.hpp"
#include "tests/support/face_contacts.hpp"
#include "tests/support/face_system.hpp"

namespace stridor {
namespace {

/// Largest distance of one of the eigenvalues from the nearest of the others that is left, by its
/// size.
double largest_spectrum_difference(std::vector<Eigenvalue> some, std::vector<Eigenvalue> others) {
  double largest = std::abs(static_cast<double>(some.size()) - static_cast<double>(others.size()));
  for (const Eigenvalue& one : some) {
    const auto nearest =
        std::min_element(others.begin(), others.end(), [&](const auto& a, const auto& b) {
          return std::abs(a.s - one.s) < std::abs(b.s - one.s);
        });
    if (nearest == others.end()) break;
    largest = std::max(largest, std::abs(nearest->s - one.s) / std::abs(one.s));
    others.erase(nearest);
  }
  return largest;
}

struct DiscCase {
  std::string name;
  std::vector<std::string> terms;
  bool is_penalty;
  bool has_piston;
  bool is_elastic;
};

DiscModelParameters brake_of(const DiscCase& one) {
  DiscModelParameters brake = test::squealing_brake();
  brake.terms = one.terms;
  brake.contact.friction.coefficient = 0.3;
  if (one.is_elastic) brake = test::with_elastic_pads(brake);
  if (!one.is_penalty) brake.contact.formulation = ContactFormulation::lagrange;
  if (one.has_piston) {
    brake.contact.preload.reset();
    brake.pads.piston.emplace().force = 3000.0;
  }
  return brake;
}

std::vector<DiscCase> disc_cases() {
  const std::vector<std::vector<std::string>> terms{
      {},
      {"gyroscopic"},
      {"friction"},
      {"gyroscopic", "friction"},
      {"gyroscopic", "friction", "friction_damping"},
      {"gyroscopic", "friction", "geometric"},
      {"gyroscopic", "friction", "friction_damping", "geometric"},
      {"friction", "friction_damping", "geometric", "structural_damping"},
      {"gyroscopic", "friction", "friction_damping", "geometric", "structural_damping"}};
  std::vector<DiscCase> all;
  for (std::size_t i = 0; i < terms.size(); ++i) {
    for (int k = 0; k < 8; ++k) {
      all.push_back({fmt::format("terms_{}_{}_{}_{}", i, k & 1 ? "penalty" : "rigid",
                                 k & 2 ? "piston" : "preload", k & 4 ? "elastic" : "masses"),
                     terms[i], (k & 1) != 0, (k & 2) != 0, (k & 4) != 0});
    }
  }
  return all;
}

class FaceSystem : public testing::TestWithParam<DiscCase> {};

TEST_P(FaceSystem, HasTheEigenvaluesAndForcesOfTheDiscModel) {
  const DiscModelParameters brake = brake_of(GetParam());
  const DiscModel model = make_disc_model(brake);
  const System system = test::disc_system(brake);
  const LinearisationTerms terms = test::face_terms(brake);
  const Equilibrium equilibrium = test::face_equilibrium(system, terms);
  ASSERT_EQ(equilibrium.status, EquilibriumStatus::converged) << equilibrium.failure;
  for (std::size_t i = 0; i < model.contacts.size(); ++i) {
    const FaceContactPoint& expected = model.state.contacts[i];
    const ContactEquilibrium& found = equilibrium.contacts[i];
    EXPECT_EQ(found.is_closed, expected.is_closed);
    EXPECT_NEAR(found.force, expected.force, 1e-9 * 3000.0);
    const Eigen::Vector2d friction = model.law.friction * expected.force * expected.direction;
    EXPECT_NEAR(found.friction_force, friction.x(), 1e-9 * 3000.0);
    EXPECT_NEAR(found.friction_across, friction.y(), 1e-9 * 3000.0);
  }
  // Rounding of ω² up to the stiffness of the penalty.
  EXPECT_LT(largest_spectrum_difference(dense_eigenvalues(linearise(system, equilibrium, terms)),
                               dense_eigenvalues(make_pencil(model.system))),
            1e-9);
}

INSTANTIATE_TEST_SUITE_P(Cases, FaceSystem, testing::ValuesIn(disc_cases()),
                         [](const auto& one) { return one.param.name; });

TEST(FaceEquilibrium, ContactsOpenWhereTheyWouldPull) {
  // Pads of elastic material with contacts far apart, which friction tilts until edges lift.
  DiscModelParameters brake = test::with_elastic_pads(test::squealing_brake());
  brake.contact.preload.reset();
  brake.pads.piston.emplace().force = 3000.0;
  brake.pads.elastic->thickness = 0.04;
  brake.contact.friction.coefficient = 0.6;
  for (const bool is_rigid : {false, true}) {
    if (is_rigid) brake.contact.formulation = ContactFormulation::lagrange;
    const DiscModel model = make_disc_model(brake);
    const System system = test::disc_system(brake);
    const Equilibrium equilibrium = test::face_equilibrium(system);
    ASSERT_EQ(equilibrium.status, EquilibriumStatus::converged);
    int open = 0;
    for (std::size_t i = 0; i < model.contacts.size(); ++i) {
      const FaceContactPoint& expected = model.state.contacts[i];
      EXPECT_EQ(equilibrium.contacts[i].is_closed, expected.is_closed);
      EXPECT_NEAR(equilibrium.contacts[i].force, expected.is_closed ? expected.force : 0.0, 1e-6);
      if (!expected.is_closed) {
        EXPECT_NEAR(equilibrium.contacts[i].gap, expected.gap, 1e-6 * expected.gap);
        ++open;
      }
    }
    EXPECT_GT(open, 0);
    EXPECT_LT(largest_spectrum_difference(dense_eigenvalues(linearise(system, equilibrium)),
                                 dense_eigenvalues(make_pencil(model.system))),
              1e-9);
  }
}

TEST(FaceEquilibrium, SlopeOfStribecksLawIsThatOfFrictionByVelocity) {
  // Derivatives of the generalised force by differences of the law with the whole kinematics.
  FacePlace place;
  place.radius = 0.13;
  place.half_thickness = 0.006;
  place.side = -1;
  place.spin = 3.0;
  place.turned = 0.2;
  const FaceKinematics face = make_face_kinematics(place);
  const FrictionLaw law = stribeck_friction(0.5, 0.3, 0.4);
  FacePorts y, rate;
  y << 1e-4, 2e-3, -3e-3, 1e-2, 2e-2, 1e-4, -2e-4, 3e-5;
  const auto force = [&](const FacePorts& at, const FacePorts& by) -> FacePorts {
    const Eigen::Vector2d v = face.velocity(at, by);
    const Eigen::Vector2d tau = sliding_friction(law, v.norm()) * v.normalized();
    return -(face.normal_at(at) + tau.x() * face.along_at(at) + tau.y() * face.across);
  };
  const ContactLinearisation local = linearise_face(tangent_kinematics(face, y), num_face_ports, law, 1.0);
  EXPECT_LT((local.force_row - force(y, FacePorts::Zero())).norm(), 1e-14);
  for (int k = 0; k < num_face_ports; ++k) {
    constexpr double h = 1e-5;
    const FacePorts step = h * FacePorts::Unit(k);
    const FacePorts zero = FacePorts::Zero();
    // Second-order differences: h² times the third derivative, which Ω r = 0.39 m/s divides.
    const FacePorts by_position = (force(y + step, zero) - force(y - step, zero)) / (2.0 * h);
    const FacePorts by_velocity = (force(y, step) - force(y, -step)) / (2.0 * h);
    EXPECT_LT((local.force_by_position.col(k) - by_position).norm(), 1e-6) << k;
    EXPECT_LT((local.force_by_velocity.col(k) - by_velocity).norm(), 1e-6) << k;
    EXPECT_NEAR(-local.gap_row(k), (face.gap(y + step) - face.gap(y - step)) / (2.0 * h), 1e-9);
  }
}

TEST(FaceEquilibrium, RefusesFrictionThatTurnsAtNoSpeed) {
  DiscModelParameters brake = test::squealing_brake();
  System system = test::disc_system(brake);
  for (ContactPoint& contact : system.contacts) contact.face->spin = 0.0;
  EXPECT_THROW((void)test::face_equilibrium(system), std::invalid_argument);
}

}  // namespace
}  // namespace stridor
