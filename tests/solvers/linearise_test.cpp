#include "solvers/equilibrium/linearise.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <Eigen/LU>
#include <cmath>
#include <complex>
#include <numbers>
#include <utility>
#include <vector>

#include "core/errors.hpp"
#include "coupling/laws/stribeck_friction.hpp"
#include "substructures/bodies/beam.hpp"
#include "tests/support/linearisation.hpp"
#include "tests/support/message_of.hpp"
#include "tests/support/paper_model.hpp"

namespace stridor {
namespace {

using namespace test;

using ::testing::HasSubstr;

using Complex = std::complex<double>;

/// Modal displacements of all bodies.
Eigen::VectorXd stacked(const Equilibrium& equilibrium) {
  Eigen::Index size = 0;
  for (const Eigen::VectorXd& body : equilibrium.displacement) size += body.size();
  Eigen::VectorXd all(size);
  size = 0;
  for (const Eigen::VectorXd& body : equilibrium.displacement) {
    all.segment(size, body.size()) = body;
    size += body.size();
  }
  return all;
}

TEST(Linearise, IsTheTangentOfTheEquilibrium) {
  // (K + Sᵀ G S) δq + Sᵀ B_Eᵀ δλ = δf, B_C S δq = 0 is how the equilibrium moves with the load.
  for (const auto& [angle, kind] : {std::pair(trailing_angle, SurfaceKind::polyline),
                                    std::pair(leading_angle, SurfaceKind::polyline),
                                    std::pair(trailing_angle, SurfaceKind::smooth)}) {
    for (const ContactAssumption assumption : all_assumptions) {
      System system = paper_system_at(angle, assumption);
      system.surfaces[0].kind = kind;
      EquilibriumState state = sliding_state(system, drive_displacement_at(system, 0, 0.0905));
      const Equilibrium equilibrium = find_equilibrium(system, state);
      ASSERT_EQ(equilibrium.status, EquilibriumStatus::converged) << equilibrium.failure;
      const Pencil pencil = linearise(system, equilibrium);
      const Eigen::Index n = pencil.num_modes();
      Eigen::MatrixXd matrix = Eigen::MatrixXd::Zero(n + 1, n + 1);
      matrix.diagonal().head(n) = pencil.omega.array().square();
      if (pencil.port_stiffness.size() > 0) {
        matrix.topLeftCorner(n, n) +=
            pencil.ports.transpose() * pencil.port_stiffness * pencil.ports;
      }
      matrix.topRightCorner(n, 1) = pencil.ports.transpose() * pencil.equilibrium.transpose();
      matrix.bottomLeftCorner(1, n) = pencil.compatibility * pencil.ports;
      Eigen::VectorXd right_side = Eigen::VectorXd::Zero(n + 1);
      const ModalBody& oblique = system.bodies[1].modal;
      right_side.segment(system.bodies[0].modal.size(), oblique.size()) =
          oblique.rows.row(system.bodies[1].loads.front().row);
      const Eigen::VectorXd tangent = matrix.partialPivLu().solve(right_side);

      // Central difference: error (step/load)² ~ 1e-8 times the curvature, of order 1 at most.
      const double step = 1e-4 * paper_load;
      state.drives[0].load += step;
      const Equilibrium more = find_equilibrium(system, state);
      state.drives[0].load -= 2.0 * step;
      const Equilibrium less = find_equilibrium(system, state);
      const Eigen::VectorXd slope = (stacked(more) - stacked(less)) / (2.0 * step);
      EXPECT_LT((tangent.head(n) - slope).norm(), 1e-7 * slope.norm());
      EXPECT_NEAR(tangent(n), (more.contacts[0].force - less.contacts[0].force) / (2.0 * step),
                  1e-7);

      // The test can tell: without the terms it is off by more than that.
      if (assumption == ContactAssumption::subs_a) continue;
      const Pencil rows_only = linearise(system, equilibrium, no_terms);
      EXPECT_EQ(rows_only.port_stiffness.size(), 0);
      matrix.topLeftCorner(n, n).setZero();
      matrix.diagonal().head(n) = pencil.omega.array().square();
      matrix.bottomLeftCorner(1, n) = rows_only.compatibility * rows_only.ports;
      EXPECT_GT((matrix.partialPivLu().solve(right_side).head(n) - slope).norm(),
                1e-5 * slope.norm());
    }
  }
}

struct Growth {
  double position;   ///< m
  double growth;     ///< 1/s
  double frequency;  ///< Hz, a guess
};

TEST(Linearise, AboutTheDeformedEquilibriumItPredictsTheBursts) {
  // Growth by an independent calculation, 3 %. For the leading beam the position is that of the
  // undeformed slave, for the trailing one that of the contact itself: they differ by what friction
  // bends the tip, 0.04 and 0.1 mm.
  const System leading = paper_system_at(leading_angle);
  for (const Growth& expected :
       {Growth{0.0635, 36.0, 3529.0}, Growth{0.074, 87.0, 3529.0}, Growth{0.083, 87.0, 3520.0},
        Growth{0.091, 133.0, 3530.0}, Growth{0.0935, 98.0, 10569.0}}) {
    const Equilibrium equilibrium = find_equilibrium(
        leading, sliding_state(leading, drive_displacement_at(leading, 0, expected.position)));
    const Complex s = eigenvalue_near(linearise(leading, equilibrium),
                                      at_frequency(expected.growth, expected.frequency));
    EXPECT_NEAR(s.real(), expected.growth, 0.03 * expected.growth) << expected.position;
  }
  const System trailing = paper_system_at(trailing_angle);
  for (const Growth& expected :
       {Growth{0.0625, 43.0, 3524.0}, Growth{0.075, 90.0, 3521.0}, Growth{0.0815, 86.0, 3525.0},
        Growth{0.092, 129.0, 3530.0}, Growth{0.048, 45.0, 10572.0}, Growth{0.0935, 71.0, 10581.0},
        Growth{0.0955, 52.0, 6952.0}}) {
    const Equilibrium equilibrium =
        find_equilibrium_at(trailing, 0, expected.position, sliding_state(trailing, 0.0));
    const Complex s = eigenvalue_near(linearise(trailing, equilibrium),
                                      at_frequency(expected.growth, expected.frequency));
    EXPECT_NEAR(s.real(), expected.growth, 0.03 * expected.growth) << expected.position;
  }
}

TEST(Linearise, TheForceInEquilibriumChangesGrowthLittle) {
  // The part that λ adds where the contact turns and shifts; 1.3 % at the weakest maximum, 36 1/s.
  const System system = paper_system_at(leading_angle);
  for (const auto& [position, growth, frequency] :
       {Growth{0.0635, 36.0, 3529.0}, Growth{0.083, 87.0, 3520.0}, Growth{0.091, 133.0, 3530.0}}) {
    const Equilibrium equilibrium =
        find_equilibrium(system, sliding_state(system, drive_displacement_at(system, 0, position)));
    const Complex guess = at_frequency(growth, frequency);
    const double whole = eigenvalue_near(linearise(system, equilibrium), guess).real();
    const double rows = eigenvalue_near(linearise(system, equilibrium, no_terms), guess).real();
    EXPECT_NEAR(whole, rows, 0.015 * whole);
    EXPECT_GT(std::abs(whole - rows), 1e-3 * whole);
  }
}

TEST(Linearise, AboutTheUndeformedGeometryItIsThePublishedLocus) {
  // Eigenvalues by an independent calculation, given to four or five digits.
  const struct {
    double angle, position, growth, frequency;
  } cases[] = {{trailing_angle, 0.048, 20.40, 10572.2}, {trailing_angle, 0.048, -7.13, 1120.30},
               {trailing_angle, 0.0955, 41.79, 6950.6}, {trailing_angle, 0.0955, -5.85, 24.79},
               {leading_angle, 0.048, 6.79, 10556.4},   {leading_angle, 0.0565, -13.36, 37.43}};
  for (const auto& [angle, position, growth, frequency] : cases) {
    const System system = paper_system_at(angle);
    const Equilibrium equilibrium =
        find_equilibrium(system, sliding_state(system, drive_displacement_at(system, 0, position),
                                               ContactGeometry::undeformed));
    const Pencil pencil = linearise(system, equilibrium);
    EXPECT_EQ(pencil.port_stiffness.size(), 0);
    EXPECT_EQ(pencil.port_damping.size(), 0);
    const Complex s = eigenvalue_near(pencil, at_frequency(growth, frequency));
    EXPECT_NEAR(s.real(), growth, 0.01 + 1e-3 * std::abs(growth));
    EXPECT_NEAR(s.imag() / (2.0 * std::numbers::pi), frequency, 0.01 + 1e-5 * frequency);

    Pencil placed = make_modal_pencil(system);
    place_undeformed(placed, system, equilibrium.state.drive_displacement, 0.30, 1.0);
    EXPECT_LT((placed.compatibility * placed.ports - pencil.compatibility * pencil.ports).norm(),
              1e-12 * placed.ports.norm());
    EXPECT_LT((placed.equilibrium * placed.ports - pencil.equilibrium * pencil.ports).norm(),
              1e-12 * placed.ports.norm());
  }
}

TEST(Linearise, FrictionThatFallsWithTheVelocityFeedsTheTangentialMotion) {
  for (const auto geometry : {ContactGeometry::undeformed, ContactGeometry::deformed}) {
    System system = paper_system_at(trailing_angle);
    system.contacts[0].friction = stribeck_friction(0.5, 0.2, 0.05);
    const Equilibrium equilibrium =
        find_equilibrium(system, sliding_state(system, 0.010, geometry));
    const ContactEquilibrium& contact = equilibrium.contacts.at(0);
    const Pencil pencil = linearise(system, equilibrium);
    ASSERT_EQ(pencil.port_damping.rows(), 6);
    // H = λ χ (dμ/dv) τ τᵀ with τ the sliding velocity per velocity of the ports.
    const auto& [xi, tangent, normal, weights] = contact.projection;
    PortVector sliding(6);
    sliding << tangent, -(1.0 - xi) * tangent, -xi * tangent;
    const double slope = sliding_friction_slope(system.contacts[0].friction, contact.slip_velocity);
    EXPECT_LT(slope, 0.0);
    const PortMatrix expected = contact.force * slope * sliding * sliding.transpose();
    EXPECT_LT((pencil.port_damping - expected).norm(), 1e-14 * expected.norm());
    EXPECT_EQ(pencil.port_stiffness.size() > 0, geometry == ContactGeometry::deformed);
    LinearisationTerms terms;
    terms.friction_slope = false;
    EXPECT_EQ(linearise(system, equilibrium, terms).port_damping.size(), 0);
  }
}

TEST(Linearise, OpenContactsDoNotAppear) {
  ModelParameters parameters = paper_model();
  BeamParameters block = paper_oblique(0.0);
  block.length = 0.010;
  block.thickness = 0.004;
  block.mesh = {2, 1};
  block.reduction = {4};
  parameters.substructures["oblique"] = block;
  parameters.contact->slave = {"oblique.bottom"};
  parameters.contact->assumption = ContactAssumption::film;
  const System system = make_paper_model(parameters).system;
  const Equilibrium equilibrium = find_equilibrium(system, sliding_state(system, 0.020));
  ASSERT_EQ(equilibrium.status, EquilibriumStatus::converged) << equilibrium.failure;
  std::vector<std::size_t> closed;
  for (std::size_t i = 0; i < equilibrium.contacts.size(); ++i)
    if (equilibrium.contacts[i].is_closed) closed.push_back(i);
  ASSERT_LT(closed.size(), system.contacts.size());
  const Pencil pencil = linearise(system, equilibrium);
  EXPECT_EQ(pencil.num_constraints(), static_cast<Eigen::Index>(closed.size()));
  EXPECT_EQ(pencil.num_ports(), 6 * static_cast<Eigen::Index>(closed.size()));
  EXPECT_EQ(pencil.port_stiffness.rows(), pencil.num_ports());
  EXPECT_NO_THROW(check_pencil(pencil));
  for (std::size_t k = 0; k < closed.size(); ++k) {
    const auto row = static_cast<Eigen::Index>(k);
    const ModalBody& body = system.bodies[1].modal;
    const Eigen::RowVectorXd expected = body.rows.row(system.contacts[closed[k]].slave_rows.y);
    EXPECT_EQ(pencil.ports.row(6 * row + 1).tail(body.size()), expected);
    EXPECT_NE(pencil.compatibility(row, 6 * row + 1), 0.0);
  }
}

TEST(Linearise, AnEquilibriumThatHasNotConvergedIsRefused) {
  const System system = paper_system_at(trailing_angle);
  EXPECT_THAT(message_of<std::invalid_argument>([&] { linearise(system, Equilibrium{}); }),
              HasSubstr("linearise: the equilibrium has not converged"));
}

}  // namespace
}  // namespace stridor
