#include "tests/support/face_contact.hpp"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <array>
#include <cmath>
#include <random>

namespace stridor {
namespace {

constexpr Eigen::Index num_pad = 3;

/// A plate with few modes, so that second derivatives are large, and one pad.
struct Place {
  AnnularPlate plate;
  double radius, angle, half_thickness, speed, normal_force, friction;
  int side;
};

struct Motion {
  Eigen::VectorXd q, v;
};

/// Deflection of the mid-surface and what is derived from it at one place.
struct Surface {
  double w, w_r, w_phi, w_r_phi, w_phi_phi;
  Surface(const Place& at, const Eigen::VectorXd& q, double r, double phi) {
    const PlateRows rows = at.plate.rows(r, phi);
    const Eigen::VectorXd c = q.head(at.plate.size());
    w = rows.w.dot(c);
    w_r = rows.w_r.dot(c);
    w_phi = rows.w_phi.dot(c);
    w_r_phi = rows.w_r_phi.dot(c);
    w_phi_phi = rows.w_phi_phi.dot(c);
  }
};

Eigen::Vector3d e_r(double phi) {
  return {std::cos(phi), std::sin(phi), 0.0};
}
Eigen::Vector3d e_phi(double phi) {
  return {-std::sin(phi), std::cos(phi), 0.0};
}
const Eigen::Vector3d e_z(0.0, 0.0, 1.0);

/// Not normalised: (−∇w, 1).
Eigen::Vector3d slope_vector(const Surface& s, double r, double phi) {
  return -s.w_r * e_r(phi) - s.w_phi / r * e_phi(phi) + e_z;
}

/// Its derivative by φ at constant r.
Eigen::Vector3d slope_vector_by_angle(const Surface& s, double r, double phi) {
  return -s.w_r_phi * e_r(phi) - s.w_r * e_phi(phi) - s.w_phi_phi / r * e_phi(phi) +
         s.w_phi / r * e_r(phi);
}

/// Derivative of n = m/|m| along dm.
Eigen::Vector3d normal_change(const Eigen::Vector3d& m, const Eigen::Vector3d& dm) {
  const Eigen::Vector3d n = m.normalized();
  return (dm - n * n.dot(dm)) / m.norm();
}

/// Generalised forces of a contact at which the multiplier is N₀, without linearisation: the pad
/// touches that point of the deformed face which lies above or below it; the force is normal to the
/// face there and friction follows the velocity of the face's particle against the pad.
Eigen::VectorXd exact_forces(const Place& at, const Motion& motion) {
  const Eigen::Index n = at.plate.size();
  const double lever = at.side * at.half_thickness;
  const Eigen::Vector3d axes[3] = {e_r(at.angle), e_phi(at.angle), e_z};
  Eigen::Vector3d pad = at.radius * axes[0];
  Eigen::Vector3d pad_velocity = Eigen::Vector3d::Zero();
  for (Eigen::Index i = 0; i < num_pad; ++i) {
    pad += motion.q(n + i) * axes[i];
    pad_velocity += motion.v(n + i) * axes[i];
  }
  // The place of the mid-surface whose face point is at the pad.
  double r = at.radius;
  double phi = at.angle;
  for (int iteration = 0; iteration < 60; ++iteration) {
    const Surface s(at, motion.q, r, phi);
    const Eigen::Vector3d middle = pad - lever * slope_vector(s, r, phi).normalized();
    r = std::hypot(middle.x(), middle.y());
    phi = std::atan2(middle.y(), middle.x());
  }
  const Surface s(at, motion.q, r, phi);
  const Surface rate(at, motion.v, r, phi);
  const Eigen::Vector3d m = slope_vector(s, r, phi);
  const Eigen::Vector3d normal = m.normalized();
  const Eigen::Vector3d m_rate = -rate.w_r * e_r(phi) - rate.w_phi / r * e_phi(phi) +
                                 at.speed * slope_vector_by_angle(s, r, phi);
  const Eigen::Vector3d face_velocity = at.speed * r * e_phi(phi) +
                                        (rate.w + at.speed * s.w_phi) * e_z +
                                        lever * normal_change(m, m_rate);
  const Eigen::Vector3d sliding = face_velocity - pad_velocity;
  const Eigen::Vector3d direction = (sliding - normal * normal.dot(sliding)).normalized();
  const Eigen::Vector3d force =
      at.normal_force * (at.side * m + at.friction * m.norm() * direction);  // on the pad

  Eigen::VectorXd forces = Eigen::VectorXd::Zero(n + num_pad);
  const PlateRows rows = at.plate.rows(r, phi);
  for (Eigen::Index i = 0; i < n; ++i) {
    const Eigen::Vector3d m_change = -rows.w_r(i) * e_r(phi) - rows.w_phi(i) / r * e_phi(phi);
    forces(i) = -force.dot(rows.w(i) * e_z + lever * normal_change(m, m_change));
  }
  for (Eigen::Index i = 0; i < num_pad; ++i) forces(n + i) = force.dot(axes[i]);
  return forces;
}

FaceContact linear_contact(const Place& at) {
  const Eigen::Index n = at.plate.size();
  FaceContact contact;
  contact.plate = at.plate.rows(at.radius, at.angle);
  for (Eigen::VectorXd* row : {&contact.plate.w, &contact.plate.w_r, &contact.plate.w_phi,
                               &contact.plate.w_r_phi, &contact.plate.w_phi_phi}) {
    row->conservativeResizeLike(Eigen::VectorXd::Zero(n + num_pad));
  }
  contact.pad_r = Eigen::VectorXd::Unit(n + num_pad, n);
  contact.pad_phi = Eigen::VectorXd::Unit(n + num_pad, n + 1);
  contact.pad_z = Eigen::VectorXd::Unit(n + num_pad, n + 2);
  contact.radius = at.radius;
  contact.half_thickness = at.half_thickness;
  contact.side = at.side;
  return contact;
}

/// Bodies without mass, stiffness and damping of their own.
LinearSystem nothing(const Place& at) {
  const Eigen::Index n = at.plate.size() + num_pad;
  const Eigen::MatrixXd zero = Eigen::MatrixXd::Zero(n, n);
  return {Eigen::MatrixXd::Identity(n, n), zero, zero, Eigen::MatrixXd(0, n),
          Eigen::MatrixXd(0, n)};
}

FaceContactLaw law_of(const Place& at) {
  return {at.friction, std::nullopt, at.speed, true, true};
}

/// Derivative of forces along a direction, of eighth order.
template <class Forces>
Eigen::VectorXd force_derivative(const Forces& forces, const Motion& about, const Motion& along,
                                 double step) {
  constexpr std::array weights{4.0 / 5.0, -1.0 / 5.0, 4.0 / 105.0, -1.0 / 280.0};
  Eigen::VectorXd sum = Eigen::VectorXd::Zero(along.q.size());
  for (std::size_t k = 0; k < weights.size(); ++k) {
    const double distance = step * static_cast<double>(k + 1);
    const auto at_distance = [&](double d) -> Eigen::VectorXd {
      return forces({about.q + d * along.q, about.v + d * along.v});
    };
    sum += weights[k] * (at_distance(distance) - at_distance(-distance));
  }
  return sum / step;
}

Place random_place(std::mt19937& generator) {
  const auto between = [&](double low, double high) {
    return std::uniform_real_distribution(low, high)(generator);
  };
  AnnularPlateParameters plate;
  plate.inner_radius = between(0.05, 0.08);
  plate.outer_radius = between(0.16, 0.2);
  plate.thickness = between(0.01, 0.03);
  plate.material = {2.1e11, 0.3, 7850.0};
  plate.nodal_diameters = 3;
  plate.radial_modes = 2;
  const double half = 0.5 * plate.thickness;
  return {AnnularPlate(plate), between(0.1, 0.15),
          between(-3.0, 3.0),  half,
          between(1.0, 50.0),  between(100.0, 5000.0),
          between(0.1, 1.0),   generator() % 2 == 0 ? 1 : -1};
}

Eigen::VectorXd random_direction(std::mt19937& generator, const AnnularPlate& plate) {
  std::normal_distribution<double> normal;
  Eigen::VectorXd direction(plate.size() + num_pad);
  // Displacements of about the same size from every coordinate.
  for (double& entry : direction) entry = normal(generator);
  direction.head(plate.size()) /= 10.0;
  return direction;
}

TEST(FaceContact, LinearForcesAreTheDerivativesOfTheExactOnes) {
  std::mt19937 generator(20240611);
  for (int trial = 0; trial < 20; ++trial) {
    const Place at = random_place(generator);
    const std::vector<FaceContact> contacts{linear_contact(at)};
    const FaceContactLaw law = law_of(at);
    const LinearSystem system = linearise(nothing(at), contacts, law,
                                          prescribed_sliding_state(contacts, law, at.normal_force));
    const Eigen::MatrixXd& stiffness = system.position;
    const Eigen::MatrixXd& damping = system.velocity;
    const Eigen::VectorXd zero = Eigen::VectorXd::Zero(at.plate.size() + num_pad);

    const Eigen::VectorXd q = random_direction(generator, at.plate);
    const auto forces = [&](const Motion& motion) { return exact_forces(at, motion); };
    const Eigen::VectorXd by_position = force_derivative(forces, {zero, zero}, {q, zero}, 1e-4);
    const Eigen::VectorXd expected = -stiffness * q;
    EXPECT_LT((by_position - expected).norm(), 1e-9 * expected.norm()) << "trial " << trial;

    const Eigen::VectorXd v = random_direction(generator, at.plate);
    const Eigen::VectorXd by_velocity =
        force_derivative(forces, {zero, zero}, {zero, v}, 1e-3 * at.speed);
    const Eigen::VectorXd braked = -damping * v;
    EXPECT_LT((by_velocity - braked).norm(), 1e-9 * braked.norm()) << "trial " << trial;
  }
}

/// Forces of a contact at a multiplier of N₀ to second order in displacements, put together from
/// the rows and matrices of the header's formulas, with friction against the whole velocity.
Eigen::VectorXd second_order_forces(const Place& at, const FaceContact& c, const Motion& motion) {
  const double s = c.side;
  const double half = c.half_thickness;
  const double r = c.radius;
  const Eigen::VectorXd& q = motion.q;
  const Eigen::VectorXd g_phi = c.plate.w_phi / r;
  const double slope_r = c.plate.w_r.dot(q), slope_phi = g_phi.dot(q);
  const double p_r = c.pad_r.dot(q), p_phi = c.pad_phi.dot(q);
  const Eigen::VectorXd normal =
      s * (c.pad_z - c.plate.w) - half * (slope_r * c.plate.w_r + slope_phi * g_phi) -
      s * (p_r * c.plate.w_r + p_phi * g_phi + slope_r * c.pad_r + slope_phi * c.pad_phi);
  const Eigen::VectorXd across = s * half * c.plate.w_r + c.pad_r;
  const Eigen::VectorXd b = s * half * g_phi + c.pad_phi;
  const Eigen::VectorXd along =
      b + slope_phi * (c.pad_z - c.plate.w) +
      s * half *
          (across.dot(q) * (c.plate.w_r_phi / r - c.plate.w_phi / (r * r)) +
           b.dot(q) * (c.plate.w_phi_phi / (r * r) + c.plate.w_r / r));
  const double turned = (c.pad_phi + s * half * c.plate.w_r_phi).dot(q) / r;
  const Eigen::Vector2d v(at.speed * r - b.dot(motion.v),
                          -across.dot(motion.v) - at.speed * r * turned);
  const Eigen::Vector2d d = v.normalized();
  return at.normal_force * (normal + at.friction * (d.x() * along + d.y() * across));
}

TEST(FaceContact, SecondOrderForcesAreTheExactOnesToSecondOrder) {
  std::mt19937 generator(77);
  for (int trial = 0; trial < 5; ++trial) {
    const Place at = random_place(generator);
    const FaceContact contact = linear_contact(at);
    const FaceContactLaw law = law_of(at);
    const Eigen::VectorXd zero = Eigen::VectorXd::Zero(at.plate.size() + num_pad);
    const Eigen::VectorXd q = random_direction(generator, at.plate);
    // Of the code, at rest.
    const auto error = [&](double size) {
      const FaceContactPoint point = face_contact_point(contact, law, size * q, at.normal_force);
      return (at.normal_force * unit_force(contact, law, point) -
              exact_forces(at, {size * q, zero}))
          .norm();
    };
    const double order = std::log2(error(2e-5) / error(1e-5));
    EXPECT_GT(order, 1.9) << trial;
    EXPECT_LT(order, 2.1) << trial;
  }
}

TEST(FaceContact, LinearForcesAboutDeformedStatesAreDerivativesToo) {
  std::mt19937 generator(31);
  for (int trial = 0; trial < 20; ++trial) {
    const Place at = random_place(generator);
    const std::vector<FaceContact> contacts{linear_contact(at)};
    const FaceContactLaw law = law_of(at);
    const Eigen::VectorXd zero = Eigen::VectorXd::Zero(at.plate.size() + num_pad);
    FaceSlidingState state;
    state.displacement = 1e-3 * random_direction(generator, at.plate);
    state.contacts = {face_contact_point(contacts[0], law, state.displacement, at.normal_force)};
    const LinearSystem system = linearise(nothing(at), contacts, law, state);
    const auto forces = [&](const Motion& motion) {
      return second_order_forces(at, contacts[0], motion);
    };
    const Motion rest{state.displacement, zero};
    const Eigen::VectorXd expected =
        at.normal_force * unit_force(contacts[0], law, state.contacts[0]);
    EXPECT_LT((forces(rest) - expected).norm(), 1e-12 * expected.norm()) << trial;
    EXPECT_LT((system.forces.row(0).transpose() * at.normal_force - expected).norm(),
              1e-12 * expected.norm());
    const Eigen::VectorXd q = random_direction(generator, at.plate);
    const Eigen::VectorXd turned = -system.position * q;
    EXPECT_LT((force_derivative(forces, rest, {q, zero}, 1e-4) - turned).norm(),
              1e-9 * turned.norm())
        << trial;
    const Eigen::VectorXd v = random_direction(generator, at.plate);
    const Eigen::VectorXd braked = -system.velocity * v;
    EXPECT_LT((force_derivative(forces, rest, {zero, v}, 1e-3 * at.speed) - braked).norm(),
              1e-9 * braked.norm())
        << trial;
    // The row of the constraint is the slope of the gap.
    const auto gap = [&](const Motion& motion) -> Eigen::VectorXd {
      return Eigen::VectorXd::Constant(motion.q.size(),
                                       face_contact_point(contacts[0], law, motion.q, 0.0).gap);
    };
    const double slope = system.gaps.row(0).dot(q);
    EXPECT_NEAR(force_derivative(gap, rest, {q, zero}, 1e-4)(0), slope, 1e-9 * std::abs(slope));
  }
}

TEST(FaceContact, RowsAreTheForcesOfTheSlidingState) {
  std::mt19937 generator(7);
  for (int trial = 0; trial < 5; ++trial) {
    const Place at = random_place(generator);
    const FaceContact contact = linear_contact(at);
    const Eigen::VectorXd zero = Eigen::VectorXd::Zero(at.plate.size() + num_pad);
    const Eigen::VectorXd expected =
        at.normal_force * (contact.gap() + at.friction * contact.friction());
    EXPECT_LT((exact_forces(at, {zero, zero}) - expected).norm(), 1e-13 * expected.norm());
  }
}

}  // namespace
}  // namespace stridor
