#include "solvers/transient/sliding_oscillator.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <complex>
#include <functional>

#include "coupling/laws/shear_friction.hpp"
#include "coupling/laws/normal_parameters.hpp"
#include "tests/support/paper_sphere.hpp"
#include "tests/support/small_systems.hpp"

namespace stridor {
namespace {

using test::paper_sphere;
using ::testing::HasSubstr;

constexpr double k_x = 50.0, omega_x = 40.0, radius = 0.01, modulus = 4.0e6 / 3.0, creep = 0.01;
constexpr double load = 7.5e-4 * modulus * radius * radius;  ///< N
constexpr double length_unit = load / k_x;                   ///< x_0 of the paper, m

/// paper_sphere() in SI units, y upwards, on a half-space that the drive moves.
System paper_system() {
  const double mass = k_x / (omega_x * omega_x);
  Eigen::Matrix2d stiffness;
  stiffness << 1.5 * k_x, -0.5 * k_x, -0.5 * k_x, 1.5 * k_x;
  const double damping = 2.0 * 0.01 * k_x / omega_x;
  System system;
  system.bodies.push_back(test::driven_body("sphere", mass * Eigen::Matrix2d::Identity(), stiffness,
                                            Eigen::Matrix2d::Identity(), 1, damping / mass));
  system.bodies[0].drive = -1;
  system.bodies.push_back(test::rigid_body("moving rigid"));
  system.bodies[1].drive = 0;
  system.surfaces.push_back(test::rigid_line(1));
  NormalParameters normal;
  normal.law = &normal_law_type("viscoelastic");
  normal.numbers["radius"] = radius;
  normal.numbers["modulus"] = modulus;
  normal.numbers["creep_time"] = creep;
  ContactPoint contact;
  contact.name = "contact";
  contact.slave_rows = {0, 1};
  contact.assumption = ContactAssumption::film;
  contact.substrate = make_substrate_contact(normal, shear_friction(1e-2 * modulus));
  contact.substrate->friction_load = FrictionLoad::applied;
  contact.substrate->load = load;
  system.contacts.push_back(contact);
  system.drives[0].velocity = TimeCurve(5e-3 * radius / creep);
  system.drives[0].load = TimeCurve(-load);
  return system;
}

/// Its numbers in units of the paper.
void expect_paper_sphere(const SlidingOscillator& found) {
  const SubstrateOscillator paper = make_sphere(paper_sphere());
  const SubstrateEquilibrium expected = find_equilibrium(paper);
  const SubstrateEquilibrium rest = find_equilibrium(found.oscillator);
  ASSERT_TRUE(rest.converged);
  const Eigen::Vector2d place = rest.displacement * (found.length / length_unit);
  EXPECT_NEAR(place.x(), expected.displacement.x(), 1e-14);
  EXPECT_NEAR(place.y(), expected.displacement.y(), 1e-15);
  const auto s = eigenvalues(small_motion(found.oscillator, rest));
  const auto s_paper = eigenvalues(small_motion(paper, expected));
  for (const std::complex<double>& one : s_paper) {
    const double miss = std::abs(*std::min_element(s.begin(), s.end(), [&](auto a, auto b) {
      return std::abs(a / (found.time * omega_x) - one) <
             std::abs(b / (found.time * omega_x) - one);
    }) / (found.time * omega_x) - one);
    EXPECT_LT(miss, 1e-12 * std::abs(one));
  }
}

TEST(SlidingOscillator, SystemInSiUnitsSaysTheSameAsThePaper) {
  const std::optional<SlidingOscillator> found = as_oscillator(paper_system());
  ASSERT_TRUE(found.has_value());
  expect_paper_sphere(*found);
  // Numbers of the order of one: k_xx and the load are.
  EXPECT_NEAR(found->oscillator.stiffness(0, 0), 1.0, 1e-15);
  EXPECT_NEAR(found->oscillator.load.y(), 1.0, 1e-15);
  EXPECT_NEAR(found->oscillator.stiffness(0, 1), 1.0 / 3.0, 1e-15);
}

TEST(SlidingOscillator, BodyDraggedOverAHalfSpaceAtRestIsItsMirrorImage) {
  System system = paper_system();
  system.bodies[0].drive = 0;
  system.bodies[1].drive = -1;
  // Against the motion of the body, as the half-space moved before; x is mirrored with it.
  Eigen::MatrixXd& stiffness = system.bodies[0].reduced.stiffness;
  stiffness(0, 1) = stiffness(1, 0) = -stiffness(0, 1);
  const std::optional<SlidingOscillator> found = as_oscillator(system);
  ASSERT_TRUE(found.has_value());
  EXPECT_EQ(found->direction, -1.0);
  EXPECT_EQ(found->mass.base_speed, system.drives[0].velocity.value(0.0));
  expect_paper_sphere(*found);
}

TEST(SlidingOscillator, TakesSpeedsAndLoadsOfSeveralDrives) {
  System system = paper_system();
  const double speed = system.drives[0].velocity.value(0.0);
  system.drives.resize(3);
  // The body is dragged one way and the half-space moves three times as fast the same way, a third
  // of the load comes from another drive.
  system.drives[0].velocity = TimeCurve(1.5 * speed);
  system.drives[1].velocity = TimeCurve(0.5 * speed);
  system.drives[0].load = TimeCurve(-load / 3.0);
  system.drives[2].load = TimeCurve(-load / 1.5);
  system.bodies[0].drive = 1;
  system.bodies[0].loads = {{1, 0, BodyLoad::By::force}, {1, 2, BodyLoad::By::force}};
  const std::optional<SlidingOscillator> found = as_oscillator(system);
  ASSERT_TRUE(found.has_value());
  EXPECT_EQ(found->mass.base_speed, 0.5 * speed);
  EXPECT_EQ(found->direction, 1.0);
  expect_paper_sphere(*found);
}

TEST(SlidingOscillator, StartsWhereTheBodyDoes) {
  System system = paper_system();
  system.bodies[0].initial_displacement = Eigen::Vector2d(1e-4, -2e-4);
  const SlidingOscillator found = as_oscillator(system).value();
  const Eigen::Vector2d start = found.initial_displacement(system);
  EXPECT_NEAR(start.x(), 1e-4 / found.length, 1e-16);
  EXPECT_NEAR(start.y(), 2e-4 / found.length, 1e-16);
  EXPECT_TRUE(found.initial_velocity(system).isZero(0.0));
  EXPECT_TRUE(found.to_si(start, found.length).isApprox(Eigen::Vector2d(1e-4, -2e-4), 1e-15));
}

TEST(SlidingOscillator, SaysWhatASystemHasInstead) {
  const auto why = [](const std::function<void(System&)>& change) {
    System system = paper_system();
    change(system);
    std::string text;
    EXPECT_FALSE(as_oscillator(system, &text).has_value());
    return text;
  };
  EXPECT_THAT(why([](System& s) { s.bodies.push_back(s.bodies[0]); }),
              HasSubstr("2 bodies that move"));
  EXPECT_THAT(why([](System& s) { s.contacts.push_back(s.contacts[0]); }),
              HasSubstr("2 contact points"));
  EXPECT_THAT(why([](System& s) { s.contacts[0].substrate.reset(); }),
              HasSubstr("no viscoelastic half_space"));
  EXPECT_THAT(why([](System& s) {
                s.contacts[0].slave_rows = {1, 1};
              }),
              HasSubstr("does not move in x and y"));
  EXPECT_THAT(why([](System& s) { s.bodies[0].reduced.mass(1, 1) *= 2.0; }),
              HasSubstr("not the same in x and y"));
  EXPECT_THAT(why([](System& s) { s.bodies[0].reduced.stiffness.setZero(); }),
              HasSubstr("no spring holds it in x"));
  EXPECT_THAT(why([](System& s) { s.drives[0].velocity = TimeCurve::ramp(1.0, 1.0); }),
              HasSubstr("not constant from the start"));
  EXPECT_THAT(why([](System& s) { s.drives[0].velocity = TimeCurve(0.0); }),
              HasSubstr("does not move against it"));
  EXPECT_THAT(why([](System& s) { s.drives[0].is_frozen = true; }), HasSubstr("frozen"));
  EXPECT_THAT(why([](System& s) {
                s.bodies[0].modal.damping = {1.0, 0.0, 2.0, 1.0, 1.0};
              }),
              HasSubstr("damping changes over time"));
  EXPECT_THAT(why([](System& s) {
                s.bodies[0].reduced.coupled.velocity = Eigen::Matrix2d::Zero();
                s.bodies[0].reduced.coupled.position =
                    (Eigen::Matrix2d() << 0, 1, -1, 0).finished();
              }),
              HasSubstr("circulatory"));
}

}  // namespace
}  // namespace stridor
