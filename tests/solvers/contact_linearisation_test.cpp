#include "solvers/equilibrium/contact_linearisation.hpp"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <complex>
#include <random>

#include "coupling/laws/stribeck_friction.hpp"
#include "tests/support/linearisation.hpp"

namespace stridor {
namespace {

using namespace test;

using Complex = std::complex<double>;

/// v_d of the laws that depend on the velocity, m/s.
constexpr double falling_over = 0.08;

/// A contact anywhere on an inclined, deformed segment, open or penetrating, with friction that
/// depends on the velocity.
struct RandomContact {
  ContactPositions positions;
  FrictionLaw law = stribeck_friction(0.6, 0.2, falling_over);
  double friction_factor = 0.7;
  Eigen::Vector2d undeformed_tangent;
  PortVector velocity = PortVector::Zero(6);
};

RandomContact random_contact(std::mt19937& random, ContactAssumption assumption) {
  std::uniform_real_distribution<double> unit(-1.0, 1.0);
  RandomContact contact;
  contact.positions.assumption = assumption;
  const double angle = 0.5 * unit(random);
  contact.undeformed_tangent = {std::cos(angle), std::sin(angle)};
  const Eigen::Vector2d first(1e-4 * unit(random), 1e-4 * unit(random));
  const Eigen::Vector2d along =
      1e-3 * contact.undeformed_tangent + 3e-4 * Eigen::Vector2d(unit(random), unit(random));
  contact.positions.master = {{}, {first, first + along}};
  contact.positions.undeformed = {{}, {first, first + 1e-3 * contact.undeformed_tangent}};
  contact.positions.slave = first + (0.5 + 0.7 * unit(random)) * along +
                            1e-4 * Eigen::Vector2d(unit(random), unit(random));
  contact.positions.prescribed = project(Segment{first, first + 1e-3 * contact.undeformed_tangent},
                                         first + (0.5 + 0.5 * unit(random)) * along);
  contact.positions.driven_velocity = unit(random);
  return contact;
}

/// The kinematics of a contact, written out once more for real and for complex numbers: gap, ξ and
/// the port forces per unit of λ.
template <class Number>
struct ContactMap {
  Number gap;
  Number xi;
  std::array<Number, 6> force;
};

template <class Number>
ContactMap<Number> contact_map(const RandomContact& contact, const std::array<Number, 6>& shift,
                               const std::array<Number, 6>& velocity) {
  const ContactPositions& positions = contact.positions;
  const auto moved = [&](const Eigen::Vector2d& point, std::size_t port) {
    return std::array<Number, 2>{point.x() + shift[port], point.y() + shift[port + 1]};
  };
  const auto slave = moved(positions.slave, 0);
  const auto first = moved(positions.master.nodes[0], 2);
  const auto second = moved(positions.master.nodes[1], 4);
  const std::array<Number, 2> along{second[0] - first[0], second[1] - first[1]};
  const std::array<Number, 2> arm{slave[0] - first[0], slave[1] - first[1]};

  // Components of the tangent; the normal is (−ty, tx).
  Number tx = contact.undeformed_tangent.x();
  Number ty = contact.undeformed_tangent.y();
  Number xi = positions.prescribed.xi;
  if (positions.assumption == ContactAssumption::subs_b ||
      positions.assumption == ContactAssumption::film) {
    const Number length = std::sqrt(along[0] * along[0] + along[1] * along[1]);
    tx = along[0] / length;
    ty = along[1] / length;
  }
  if (positions.assumption != ContactAssumption::subs_a)
    xi = (tx * arm[0] + ty * arm[1]) / (tx * along[0] + ty * along[1]);

  ContactMap<Number> map;
  map.xi = xi;
  map.gap = (-ty * arm[0] + tx * arm[1]) - xi * (-ty * along[0] + tx * along[1]);
  const auto slip = [&](std::size_t component) {
    return velocity[component] - (1.0 - xi) * velocity[2 + component] -
           xi * velocity[4 + component];
  };
  const Number speed = tx * (slip(0) + positions.driven_velocity) + ty * slip(1);
  const double direction = std::real(speed) < 0.0 ? -1.0 : 1.0;
  const FrictionLaw& law = contact.law;
  const Number friction =
      contact.friction_factor *
      (law.dynamic_coefficient + (law.static_coefficient - law.dynamic_coefficient) *
                                     std::exp(-direction * speed / falling_over));
  const Number px = -ty - direction * friction * tx;
  const Number py = tx - direction * friction * ty;
  // The bodies feel −B_Eᵀλ.
  map.force = {px, py, -(1.0 - xi) * px, -(1.0 - xi) * py, -xi * px, -xi * py};
  return map;
}

/// All derivatives by complex steps: exact to rounding.
struct ExactDerivatives {
  PortVector gap = PortVector::Zero(6);
  PortVector xi = gap;
  PortMatrix force_by_position = PortMatrix::Zero(6, 6);
  PortMatrix force_by_velocity = force_by_position;
};

ExactDerivatives exact_derivatives(const RandomContact& contact) {
  constexpr double step = 1e-30;
  ExactDerivatives exact;
  for (std::size_t k = 0; k < 6; ++k) {
    std::array<Complex, 6> zero{};
    std::array<Complex, 6> shifted{};
    shifted[k] = Complex(0.0, step);
    const auto column = static_cast<Eigen::Index>(k);
    const auto by_position = contact_map<Complex>(contact, shifted, zero);
    const auto by_velocity = contact_map<Complex>(contact, zero, shifted);
    exact.gap(column) = by_position.gap.imag() / step;
    exact.xi(column) = by_position.xi.imag() / step;
    for (std::size_t j = 0; j < 6; ++j) {
      const auto row = static_cast<Eigen::Index>(j);
      exact.force_by_position(row, column) = by_position.force[j].imag() / step;
      exact.force_by_velocity(row, column) = by_velocity.force[j].imag() / step;
    }
  }
  return exact;
}

TEST(ContactLinearisation, IsTheDerivativeOfTheKinematics) {
  // Both sides are exact but for rounding; the inclination of 1 rad and less amplifies it little.
  constexpr double tolerance = 1e-12;
  std::mt19937 random(20220901);
  for (const ContactAssumption assumption : all_assumptions) {
    for (int k = 0; k < 200; ++k) {
      const RandomContact contact = random_contact(random, assumption);
      const ContactLinearisation linear =
          linearise_contact(contact.positions, contact.law, contact.friction_factor);
      const auto here = contact_map<double>(contact, {}, {});
      EXPECT_NEAR(linear.gap, here.gap, 1e-18);
      EXPECT_NEAR(linear.projection.xi, here.xi, tolerance);
      for (std::size_t j = 0; j < 6; ++j)
        EXPECT_NEAR(linear.force_row(static_cast<Eigen::Index>(j)), -here.force[j], tolerance);

      const ExactDerivatives exact = exact_derivatives(contact);
      EXPECT_LT((linear.gap_row + exact.gap).norm(), tolerance);
      EXPECT_LE((linear.shift_row - exact.xi).norm(), tolerance * exact.xi.norm());
      EXPECT_LE((linear.force_by_position + exact.force_by_position).norm(),
                tolerance * exact.force_by_position.norm());
      EXPECT_LE((linear.force_by_velocity + exact.force_by_velocity).norm(),
                tolerance * exact.force_by_velocity.norm());
    }
  }
}

/// A contact anywhere on a curved piece of smooth surface, within and at both ends of the surface.
ContactPositions random_smooth_contact(std::mt19937& random, ContactAssumption assumption) {
  std::uniform_real_distribution<double> unit(-1.0, 1.0);
  ContactPositions positions;
  positions.assumption = assumption;
  const int before = static_cast<int>(random() % 3);
  positions.undeformed.stencil = positions.master.stencil = {0, 4, before};
  for (int k = 0; k < 4; ++k) {
    const auto node = static_cast<std::size_t>(k);
    positions.undeformed.nodes[node] = Eigen::Vector2d(1e-3 * (k - before), 1e-4 * unit(random));
    positions.master.nodes[node] =
        positions.undeformed.nodes[node] + 1e-4 * Eigen::Vector2d(unit(random), unit(random));
  }
  const double xi = 0.5 + 0.5 * unit(random);
  positions.slave = positions.master.combine(weights_at(positions.master.stencil, xi).value) +
                    2e-5 * Eigen::Vector2d(unit(random), unit(random));
  positions.prescribed =
      project(positions.undeformed, 5e-4 * Eigen::Vector2d(1.0 + unit(random), 0.0), 0.5);
  positions.driven_velocity = unit(random);
  return positions;
}

/// The kinematics of a smooth contact, written out once more for complex displacements of its
/// ports: gap, ξ and the port forces per unit of λ, one after the other.
std::array<Complex, 12> smooth_contact_map(const ContactPositions& positions,
                                           const FrictionLaw& law, double friction_factor,
                                           const std::array<Complex, 10>& shift, double xi_guess) {
  const Stencil& stencil = positions.master.stencil;
  const auto combine = [&](const SurfacePiece& piece, const std::array<Complex, 4>& weights,
                           bool is_displaced) {
    std::array<Complex, 2> sum{};
    for (std::size_t k = 0; k < 4; ++k) {
      for (std::size_t i = 0; i < 2; ++i) {
        const Complex moved = is_displaced ? shift[2 + 2 * k + i] : 0.0;
        sum[i] += weights[k] * (piece.nodes[k](static_cast<Eigen::Index>(i)) + moved);
      }
    }
    return sum;
  };
  // Weights of a complex ξ from their Taylor polynomials about ξ = 0.
  const NodeWeights zero = weights_at(stencil, 0.0);
  const NodeWeights one = weights_at(stencil, 1.0);
  const auto weights = [&](Complex xi, int derivative) {
    std::array<Complex, 4> w{};
    for (std::size_t k = 0; k < 4; ++k) {
      const double third = one.curvature[k] - zero.curvature[k];
      w[k] = derivative == 0
                 ? zero.value[k] +
                       xi * (zero.slope[k] + xi * (zero.curvature[k] / 2.0 + xi * third / 6.0))
                 : zero.slope[k] + xi * (zero.curvature[k] + xi * third / 2.0);
    }
    return w;
  };
  const bool is_prescribed = positions.assumption == ContactAssumption::subs_a;
  const bool is_fixed = positions.assumption == ContactAssumption::subs_c || is_prescribed;
  const SurfacePiece& directions = is_fixed ? positions.undeformed : positions.master;
  const auto ahead = [&](Complex xi) {
    const auto along = combine(directions, weights(xi, 1), !is_fixed);
    const auto point = combine(positions.master, weights(xi, 0), true);
    return along[0] * (positions.slave.x() + shift[0] - point[0]) +
           along[1] * (positions.slave.y() + shift[1] - point[1]);
  };
  Complex xi = xi_guess;
  if (!is_prescribed) {
    // Newton with the derivative of the real problem: the error falls by the curvature each time.
    const double step = 1e-7;
    const double slope = ((ahead(xi_guess + step) - ahead(xi_guess - step)) / (2.0 * step)).real();
    for (int k = 0; k < 30; ++k) xi -= ahead(xi) / slope;
  }
  auto along = combine(directions, weights(xi, 1), !is_fixed);
  const Complex length = std::sqrt(along[0] * along[0] + along[1] * along[1]);
  const Complex tx = along[0] / length;
  const Complex ty = along[1] / length;
  const auto point = combine(positions.master, weights(xi, 0), true);
  std::array<Complex, 12> map{};
  map[0] = -ty * (positions.slave.x() + shift[0] - point[0]) +
           tx * (positions.slave.y() + shift[1] - point[1]);
  map[1] = xi;
  const Complex speed = tx * positions.driven_velocity;
  const double direction = speed.real() < 0.0 ? -1.0 : 1.0;
  const Complex friction = friction_factor * (law.dynamic_coefficient +
                                              (law.static_coefficient - law.dynamic_coefficient) *
                                                  std::exp(-direction * speed / falling_over));
  const Complex push[] = {-ty - direction * friction * tx, tx - direction * friction * ty};
  for (std::size_t i = 0; i < 2; ++i) {
    map[2 + i] = push[i];
    const auto w = weights(xi, 0);
    for (std::size_t k = 0; k < 4; ++k) map[4 + 2 * k + i] = -w[k] * push[i];
  }
  return map;
}

TEST(ContactLinearisation, IsTheDerivativeOfTheKinematicsOnASmoothSurface) {
  // Complex steps are exact to rounding, which the projection enlarges by 10 at most.
  constexpr double step = 1e-30;
  constexpr double tolerance = 1e-11;
  const FrictionLaw law = stribeck_friction(0.6, 0.2, falling_over);
  std::mt19937 random(20261121);
  for (const ContactAssumption assumption : all_assumptions) {
    for (int trial = 0; trial < 100; ++trial) {
      const ContactPositions positions = random_smooth_contact(random, assumption);
      const ContactLinearisation linear = linearise_contact(positions, law, 0.7);
      const double xi = linear.projection.xi;
      const auto here = smooth_contact_map(positions, law, 0.7, {}, xi);
      EXPECT_NEAR(linear.gap, here[0].real(), 1e-17);
      EXPECT_NEAR(xi, here[1].real(), tolerance);
      ASSERT_EQ(linear.force_row.size(), 10);
      PortVector gap(10);
      PortVector shift(10);
      PortMatrix force(10, 10);
      for (std::size_t k = 0; k < 10; ++k) {
        std::array<Complex, 10> displaced{};
        displaced[k] = Complex(0.0, step);
        const auto map = smooth_contact_map(positions, law, 0.7, displaced, xi);
        const auto column = static_cast<Eigen::Index>(k);
        gap(column) = map[0].imag() / step;
        shift(column) = map[1].imag() / step;
        for (std::size_t j = 0; j < 10; ++j)
          force(static_cast<Eigen::Index>(j), column) = map[2 + j].imag() / step;
        EXPECT_NEAR(linear.force_row(column), -here[2 + k].real(), tolerance);
      }
      EXPECT_LT((linear.gap_row + gap).norm(), tolerance);
      EXPECT_LE((linear.shift_row - shift).norm(), tolerance * shift.norm());
      EXPECT_LE((linear.force_by_position + force).norm(), tolerance * force.norm());
    }
  }
}

TEST(ContactLinearisation, RoughnessChangesTheGapAndItsDerivativeOnly) {
  // The gap's row by central differences of the gap, 1e-6 of a correlation length apart: error
  // (1e-6)² and the rounding of a gap of 1e-5 over steps of 1e-10.
  constexpr double step = 1e-10;
  constexpr double tolerance = 1e-10;
  const FrictionLaw law = constant_friction(0.3);
  const Roughness roughness({1e-6, 1e-4, 3}, 0.01);
  std::mt19937 random(17);
  for (const ContactAssumption assumption : all_assumptions) {
    for (int trial = 0; trial < 20; ++trial) {
      ContactPositions positions = random_smooth_contact(random, assumption);
      const ContactLinearisation without = linearise_contact(positions, law, 1.0);
      positions.roughness = &roughness;
      positions.arc_length = {2e-3, 3e-3, 4e-3, 5e-3};
      const ContactLinearisation linear = linearise_contact(positions, law, 1.0);
      EXPECT_EQ(linear.force_row, without.force_row);
      EXPECT_EQ(linear.force_by_position, without.force_by_position);
      EXPECT_NE(linear.gap, without.gap);
      EXPECT_EQ(linear.gap_row != without.gap_row, assumption != ContactAssumption::subs_a);
      LinearisationTerms no_slope;
      no_slope.roughness = false;
      EXPECT_EQ(linearise_contact(positions, law, 1.0, no_slope).gap_row, without.gap_row);
      for (Eigen::Index k = 0; k < 10; ++k) {
        const auto gap_at = [&](double displacement) {
          ContactPositions moved = positions;
          double& coordinate = k < 2
                                   ? moved.slave(k)
                                   : moved.master.nodes[static_cast<std::size_t>(k / 2 - 1)](k % 2);
          coordinate += displacement;
          return linearise_contact(moved, law, 1.0).gap;
        };
        EXPECT_NEAR(linear.gap_row(k), -(gap_at(step) - gap_at(-step)) / (2.0 * step),
                    tolerance + 1e-16 / step);
      }
    }
  }
}

TEST(ContactLinearisation, RowsAreThoseOfTheContactButForTheSlopeOfSubsC) {
  std::mt19937 random(7);
  for (const ContactAssumption assumption : all_assumptions) {
    const RandomContact contact = random_contact(random, assumption);
    for (const bool with_slope : {false, true}) {
      LinearisationTerms terms;
      terms.slope = with_slope;
      const ContactLinearisation linear =
          linearise_contact(contact.positions, contact.law, contact.friction_factor, terms);
      const ContactRows rows = make_rows(linear.projection, linear.friction, linear.direction);
      const auto& [c, e] = rows;
      PortVector compatibility(6);
      PortVector equilibrium(6);
      compatibility << c.slave[0], c.slave[1], c.master[0], c.master[1], c.master[2], c.master[3];
      equilibrium << e.slave[0], e.slave[1], e.master[0], e.master[1], e.master[2], e.master[3];
      EXPECT_LT((linear.force_row - equilibrium).norm(), 1e-15);
      const bool is_row = !with_slope || assumption != ContactAssumption::subs_c;
      EXPECT_EQ((linear.gap_row - compatibility).norm() < 1e-15, is_row);
    }
  }
}

TEST(ContactLinearisation, TermsAddUpToTheWhole) {
  std::mt19937 random(11);
  for (const ContactAssumption assumption : all_assumptions) {
    const RandomContact contact = random_contact(random, assumption);
    const auto linear = [&](const LinearisationTerms& terms) {
      return linearise_contact(contact.positions, contact.law, contact.friction_factor, terms);
    };
    const ContactLinearisation whole = linear({});
    const ContactLinearisation nothing = linear(no_terms);
    EXPECT_EQ(nothing.force_by_position, PortMatrix::Zero(6, 6).eval());
    EXPECT_EQ(nothing.force_by_velocity, PortMatrix::Zero(6, 6).eval());
    PortMatrix position = PortMatrix::Zero(6, 6);
    PortMatrix velocity = PortMatrix::Zero(6, 6);
    PortVector gap = nothing.gap_row;
    int num_active = 0;
    for (bool LinearisationTerms::*term :
         {&LinearisationTerms::turning_normal, &LinearisationTerms::turning_friction,
          &LinearisationTerms::shift, &LinearisationTerms::slope,
          &LinearisationTerms::friction_slope}) {
      LinearisationTerms one = no_terms;
      one.*term = true;
      const ContactLinearisation part = linear(one);
      position += part.force_by_position;
      velocity += part.force_by_velocity;
      gap += part.gap_row - nothing.gap_row;
      const bool is_active = part.force_by_position != nothing.force_by_position ||
                             part.force_by_velocity != nothing.force_by_velocity ||
                             part.gap_row != nothing.gap_row;
      num_active += is_active ? 1 : 0;
    }
    EXPECT_LE((position - whole.force_by_position).norm(), 1e-14 * whole.force_by_position.norm());
    EXPECT_EQ(velocity, whole.force_by_velocity);
    EXPECT_LT((gap - whole.gap_row).norm(), 1e-15);
    // Subs-a: slope of μ; Subs-c: that, shift and slope; Subs-b and FiLM: all but the slope.
    EXPECT_EQ(num_active, assumption == ContactAssumption::subs_a   ? 1
                          : assumption == ContactAssumption::subs_c ? 3
                                                                    : 4);
  }
}

}  // namespace
}  // namespace stridor
