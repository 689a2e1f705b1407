#include "solvers/equilibrium/equilibrium.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <Eigen/SparseLU>
#include <cmath>

#include "core/errors.hpp"
#include "coupling/laws/stribeck_friction.hpp"
#include "substructures/bodies/beam.hpp"
#include "tests/support/message_of.hpp"
#include "tests/support/paper_equilibrium.hpp"
#include "tests/support/paper_model.hpp"

namespace stridor {
namespace {

using namespace test;

using ::testing::HasSubstr;

/// Displacement of the drive that puts the undeformed slave of the paper at a position.
double to(double position) {
  return position - 0.030;
}

Equilibrium paper_equilibrium(const System& system, double position) {
  Equilibrium equilibrium = find_equilibrium(system, sliding_state(system, to(position)));
  EXPECT_EQ(equilibrium.status, EquilibriumStatus::converged) << equilibrium.failure;
  return equilibrium;
}

TEST(Equilibrium, OfBodiesThatNothingTouchesOrLoadsIsRest) {
  // Even where nothing holds them: the oblique beam's guided support lets it move as a whole.
  System system = paper_system_at(trailing_angle);
  system.contacts.clear();
  EquilibriumState state;
  const Equilibrium rest = find_equilibrium(system, state);
  ASSERT_EQ(rest.status, EquilibriumStatus::converged);
  for (std::size_t b = 0; b < system.bodies.size(); ++b) {
    ASSERT_EQ(rest.displacement[b].size(), system.bodies[b].modal.size());
    EXPECT_EQ(rest.displacement[b].norm(), 0.0);
  }
  state.drives = {{0.0, -paper_load}};
  EXPECT_THAT(message_of<NumericalError>([&] { find_equilibrium(system, state); }),
              HasSubstr("is free to move"));
}

TEST(Equilibrium, UnderSubsBTheForceBalancesTheLoadOnTheInclinedSegment) {
  // λ (cos γ − χ μ sin γ) = |F_y|
  for (const double angle : {trailing_angle, leading_angle}) {
    for (const auto assumption : {ContactAssumption::subs_b, ContactAssumption::film}) {
      const System system = paper_system_at(angle, assumption);
      for (const double velocity : {0.030, -0.030}) {
        for (const double position : {0.030, 0.0477, 0.074, 0.0955, 0.099}) {
          EquilibriumState state = sliding_state(system, to(position));
          state.drives[0].velocity = velocity;
          const Equilibrium equilibrium = find_equilibrium(system, state);
          ASSERT_EQ(equilibrium.status, EquilibriumStatus::converged) << equilibrium.failure;
          EXPECT_LE(equilibrium.residual, 1e-12);
          const ContactEquilibrium& contact = equilibrium.contacts.at(0);
          const double direction = velocity > 0.0 ? 1.0 : -1.0;
          EXPECT_EQ(contact.direction, direction);
          EXPECT_LT(contact.projection.tangent.y(), -1e-3);
          EXPECT_NEAR(contact.force * (contact.projection.normal.y() -
                                       direction * paper_friction * contact.projection.tangent.y()),
                      paper_load, rigid_mode_error * paper_load);
          EXPECT_EQ(contact.friction_force, direction * paper_friction * contact.force);
        }
      }
    }
  }
}

TEST(Equilibrium, UnderSubsAAndSubsCTheForceIsTheLoad) {
  for (const auto assumption : {ContactAssumption::subs_a, ContactAssumption::subs_c}) {
    const System system = paper_system_at(trailing_angle, assumption);
    EXPECT_NEAR(paper_equilibrium(system, 0.0905).contacts.at(0).force, paper_load,
                rigid_mode_error * paper_load);
  }
}

TEST(Equilibrium, LiesWithinTheForcesOfTheTransients) {
  // Extremes of λ after 0.4 s by an independent calculation; there s = 0.0405 m.
  const struct {
    double angle, min, max;
  } cases[] = {{trailing_angle, 0.19751, 0.19976}, {leading_angle, 0.19774, 0.19977}};
  for (const auto& [angle, min, max] : cases) {
    const System system = paper_system_at(angle);
    for (const double position : {0.0405, 0.050, 0.060, 0.070, 0.080, 0.090, 0.096}) {
      const double force = paper_equilibrium(system, position).contacts.at(0).force;
      EXPECT_GT(force, min);
      EXPECT_LT(force, max);
    }
    // The sag grows with s, so λ is largest at the beginning, but for the ripple that the nodes
    // leave on it there, 4e-4 of λ.
    EXPECT_NEAR(paper_equilibrium(system, 0.0405).contacts.at(0).force, max, 6e-4 * paper_load);
  }
}

TEST(Equilibrium, IsThatOfTheFullModel) {
  // K u + B_Eᵀ λ = f, B_C (X + u) = 0 on all DoFs, with the rows of the last iterate: another
  // model, without modes, and another iteration.
  const System system = paper_system_at(trailing_angle);
  const double position = 0.0904;
  const Equilibrium equilibrium = paper_equilibrium(system, position);
  const BodyMatrices oblique = make_beam(paper_oblique(trailing_angle));
  const BodyMatrices cantilever = make_beam(paper_cantilever());
  const auto num_master = static_cast<int>(cantilever.num_dofs());
  const int num_dofs = num_master + static_cast<int>(oblique.num_dofs());

  const int segment = equilibrium.contacts[0].segment;
  const auto& surface = cantilever.surfaces.at("top");
  std::vector<int> dofs = point_dofs(oblique, "tip");
  for (int& dof : dofs) dof += num_master;
  Eigen::Matrix<double, 6, 1> place;
  place << position, 0.0, 0.0, 0.0, 0.0, 0.0;
  for (int end = 0; end < 2; ++end) {
    const auto node = static_cast<std::size_t>(surface[static_cast<std::size_t>(segment + end)]);
    place(2 + 2 * end) = cantilever.nodes(static_cast<Eigen::Index>(node), 0);
    for (const int dof : cantilever.node_dofs[node]) dofs.push_back(dof);
  }

  std::vector<Eigen::Triplet<double>> stiffness;
  const auto add = [&](const SparseMatrix& matrix, int offset) {
    for (Eigen::Index column = 0; column < matrix.outerSize(); ++column) {
      for (SparseMatrix::InnerIterator entry(matrix, column); entry; ++entry) {
        stiffness.emplace_back(static_cast<int>(entry.row()) + offset,
                               static_cast<int>(entry.col()) + offset, entry.value());
      }
    }
  };
  add(cantilever.stiffness, 0);
  add(oblique.stiffness, num_master);
  Eigen::VectorXd right_side = Eigen::VectorXd::Zero(num_dofs + 1);
  right_side(num_master + oblique.load_dof) = -paper_load;

  Eigen::VectorXd solution = Eigen::VectorXd::Zero(num_dofs + 1);
  double change = 1.0;
  for (int iteration = 0; iteration < 20 && change > 2e-7; ++iteration) {
    const Eigen::Matrix<double, 6, 1> now = place + solution(dofs);
    const Segment under{now.segment<2>(2), now.tail<2>()};
    const ContactRows rows = make_rows(project(under, now.head<2>()), paper_friction, 1.0);
    const auto& [c, e] = rows;
    const double by_gap[] = {c.slave[0],  c.slave[1],  c.master[0],
                             c.master[1], c.master[2], c.master[3]};
    const double by_force[] = {e.slave[0],  e.slave[1],  e.master[0],
                               e.master[1], e.master[2], e.master[3]};
    auto entries = stiffness;
    double penetration = 0.0;
    for (std::size_t k = 0; k < 6; ++k) {
      entries.emplace_back(dofs[k], num_dofs, by_force[k]);
      entries.emplace_back(num_dofs, dofs[k], by_gap[k]);
      penetration += by_gap[k] * place(static_cast<Eigen::Index>(k));
    }
    right_side(num_dofs) = -penetration;
    SparseMatrix matrix(num_dofs + 1, num_dofs + 1);
    matrix.setFromTriplets(entries.begin(), entries.end());
    const Eigen::SparseLU<SparseMatrix::Base> factor(matrix);
    ASSERT_EQ(factor.info(), Eigen::Success);
    const Eigen::VectorXd next = factor.solve(right_side);
    change = (next - solution).norm() / next.norm();
    solution = next;
  }
  ASSERT_LE(change, 2e-7);

  // Reduction and modes are exact in statics; the remainder is rounding, most of it in the full
  // model, whose stiffness has a condition number of 1e9: eps times that.
  const ContactEquilibrium& contact = equilibrium.contacts[0];
  const double tolerance = 1e-6;
  EXPECT_NEAR(contact.force, solution(num_dofs), tolerance * paper_load);
  const ContactPoint& point = system.contacts[0];
  const MasterSurface& master = system.surfaces[0];
  const auto s = static_cast<std::size_t>(segment);
  Eigen::Matrix<double, 6, 1> ports;
  ports << moved(system, equilibrium, point.slave_body, point.slave_rows),
      moved(system, equilibrium, master.body, master.rows[s]),
      moved(system, equilibrium, master.body, master.rows[s + 1]);
  const Eigen::Matrix<double, 6, 1> full = solution(dofs);
  EXPECT_LT((ports - full).norm(), tolerance * full.norm());
}

TEST(Equilibrium, BodiesStandWhereTheContactsSayTheyDo) {
  const System system = paper_system_at(leading_angle);
  const Equilibrium equilibrium = paper_equilibrium(system, 0.0655);
  const ContactEquilibrium& contact = equilibrium.contacts.at(0);
  const ContactPoint& point = system.contacts[0];
  const MasterSurface& surface = system.surfaces[0];
  const auto s = static_cast<std::size_t>(contact.segment);
  const Segment segment{
      surface.positions[s] + moved(system, equilibrium, surface.body, surface.rows[s]),
      surface.positions[s + 1] + moved(system, equilibrium, surface.body, surface.rows[s + 1])};
  const Eigen::Vector2d slave = point.slave_position + Eigen::Vector2d(to(0.0655), 0.0) +
                                moved(system, equilibrium, point.slave_body, point.slave_rows);
  const Projection here = project(segment, slave);
  // The displacements by the modal sum against those by the flexibility: rounding of millimetres.
  const double rounding = 1e-13;
  EXPECT_NEAR(here.normal.dot(slave - segment.first), 0.0, rounding);
  EXPECT_NEAR(0.001 * here.xi, 0.001 * contact.projection.xi, rounding);
  EXPECT_NEAR(here.tangent.y(), contact.projection.tangent.y(), rounding / 0.001);
  EXPECT_NEAR(contact.position, surface.arc_length[s] + 0.001 * here.xi, rounding);
  EXPECT_NEAR(contact.gap, 0.0, rounding);
}

TEST(Equilibrium, ReversingTheDriveIsReversingTheFriction) {
  const System system = paper_system_at(trailing_angle);
  EquilibriumState state = sliding_state(system, to(0.0905));
  EXPECT_EQ(state.drives[0].velocity, 0.030);
  EXPECT_EQ(state.drives[0].load, -paper_load);
  EXPECT_EQ(state.friction_factor, 1.0);
  const double forward = find_equilibrium(system, state).contacts[0].force;
  state.drives[0].velocity = 0.0;
  EXPECT_EQ(find_equilibrium(system, state).contacts[0].force, forward);
  state.friction_factor = 0.0;
  const double without = find_equilibrium(system, state).contacts[0].force;
  state.drives[0].velocity = -0.030;
  state.friction_factor = 1.0;
  const Equilibrium backward = find_equilibrium(system, state);
  EXPECT_EQ(backward.contacts[0].direction, -1.0);
  EXPECT_LT(backward.contacts[0].slip_velocity, 0.0);
  EXPECT_LT(forward, without);
  EXPECT_GT(backward.contacts[0].force, without);
}

TEST(Equilibrium, FrictionIsThatOfTheLawAtTheSlidingVelocity) {
  System system = paper_system_at(trailing_angle);
  const FrictionLaw stribeck = stribeck_friction(0.5, 0.2, 0.05);
  system.contacts[0].friction = stribeck;
  EquilibriumState state = sliding_state(system, to(0.0905));
  state.friction_factor = 0.5;
  const ContactEquilibrium contact = find_equilibrium(system, state).contacts.at(0);
  EXPECT_DOUBLE_EQ(contact.slip_velocity, 0.030 * contact.projection.tangent.x());
  EXPECT_EQ(contact.friction, 0.5 * sliding_friction(stribeck, contact.slip_velocity));
  EXPECT_NEAR(contact.force * (contact.projection.normal.y() -
                               contact.friction * contact.projection.tangent.y()),
              paper_load, rigid_mode_error * paper_load);
}

TEST(Equilibrium, InUndeformedGeometryItIsThatOfSubsA) {
  const System system = paper_system_at(trailing_angle);
  const Equilibrium undeformed =
      find_equilibrium(system, sliding_state(system, to(0.0604), ContactGeometry::undeformed));
  const Equilibrium subs_a =
      paper_equilibrium(paper_system_at(trailing_angle, ContactAssumption::subs_a), 0.0604);
  EXPECT_EQ(undeformed.contacts.at(0).positions.assumption, ContactAssumption::subs_a);
  EXPECT_EQ(undeformed.contacts[0].force, subs_a.contacts.at(0).force);
  EXPECT_EQ(undeformed.displacement[0], subs_a.displacement[0]);
  EXPECT_NEAR(undeformed.contacts[0].position, 0.0604, 1e-15);
}

TEST(Equilibrium, IsContinuousFromNodeToNode) {
  // From one side of a node to the other the slope jumps by what the sag bends one segment, less
  // than 5e-4, and λ by μ times that.
  const System system = paper_system_at(trailing_angle);
  double last = 0.0;
  for (int k = 0; k <= 400; ++k) {
    const Equilibrium equilibrium = paper_equilibrium(system, 0.070 + 1e-5 * k);
    const ContactEquilibrium& contact = equilibrium.contacts[0];
    EXPECT_GT(contact.projection.xi, -1e-3);
    EXPECT_LT(contact.projection.xi, 1.0 + 1e-3);
    if (k > 0) {
      EXPECT_NEAR(contact.force, last, paper_friction * 5e-4 * paper_load);
    }
    last = contact.force;
  }
}

TEST(Equilibrium, OnARigidMasterTheForceIsTheLoadWhereverTheBodyIs) {
  ModelParameters parameters = paper_model();
  parameters.substructures.erase("cantilever");
  parameters.contact->master = "rigid";
  parameters.contact->start = 0.0;
  const System system = make_model(parameters, {}).system;
  for (const double displacement : {-3.0, 0.0, 0.25}) {
    const Equilibrium equilibrium = find_equilibrium(system, sliding_state(system, displacement));
    ASSERT_EQ(equilibrium.status, EquilibriumStatus::converged) << equilibrium.failure;
    EXPECT_NEAR(equilibrium.contacts.at(0).force, paper_load, rigid_mode_error * paper_load);
    EXPECT_EQ(equilibrium.contacts[0].projection.normal, Eigen::Vector2d::UnitY());
  }
  const double there =
      find_equilibrium_at(system, 0, -2.0, sliding_state(system, 0.0)).contacts[0].position;
  EXPECT_NEAR(there, -2.0, 1e-12);
}

TEST(Equilibrium, WithoutContactsEachBodyBendsUnderItsLoadAlone) {
  System system = paper_system_at(trailing_angle);
  system.contacts.clear();
  system.bodies[1].loads.clear();
  system.bodies.pop_back();
  system.bodies[0].loads = {BodyLoad{system.surfaces[0].rows.back().y}};
  EquilibriumState state = sliding_state(system, 0.0);
  const Equilibrium equilibrium = find_equilibrium(system, state);
  ASSERT_EQ(equilibrium.status, EquilibriumStatus::converged) << equilibrium.failure;
  // Cantilever with an end load, slender: F L³/(3 E I), I = w h³/12; shear adds 0.1 %, the clamp's
  // hindered contraction and the mesh take away about as much.
  const double expected = -paper_load * 1e-3 / (3.0 * 2.38e9 * 0.020 * 8e-9 / 12.0);
  EXPECT_NEAR(moved(system, equilibrium, 0, system.surfaces[0].rows.back()).y(), expected,
              5e-3 * std::abs(expected));
}

TEST(Equilibrium, ABodyThatNothingHoldsIsNamed) {
  System system = paper_system_at(trailing_angle);
  system.contacts.clear();
  EXPECT_THAT(
      message_of<NumericalError>([&] { find_equilibrium(system, sliding_state(system, 0.0)); }),
      HasSubstr("the body 'oblique' is free to move"));

  // Pulled off its unilateral contact.
  const System lifted = paper_system_at(trailing_angle, ContactAssumption::film);
  EquilibriumState upwards = sliding_state(lifted, 0.0);
  upwards.drives[0].load = paper_load;
  EXPECT_THAT(message_of<NumericalError>([&] { find_equilibrium(lifted, upwards); }),
              HasSubstr("the body 'oblique' is free to move"));

  // Without any load it is in equilibrium, but free all the same.
  upwards.drives[0].load = 0.0;
  EXPECT_EQ(find_equilibrium(lifted, upwards).contacts[0].force, 0.0);
}

TEST(Equilibrium, AForceThatNothingDeterminesIsNamed) {
  System system = paper_system_at(trailing_angle);
  system.contacts.push_back(system.contacts[0]);
  system.contacts[0].name = system.contacts[1].name = "doubled";
  EXPECT_THAT(
      message_of<NumericalError>([&] { find_equilibrium(system, sliding_state(system, 0.0)); }),
      HasSubstr("the force of doubled is undetermined"));
}

TEST(Equilibrium, NumbersThatAreNotAreRefused) {
  System system = paper_system_at(trailing_angle);
  EquilibriumState state = sliding_state(system, 0.0);
  state.friction_factor = -1.0;
  EXPECT_THAT(message_of<std::invalid_argument>([&] { find_equilibrium(system, state); }),
              HasSubstr("the friction factor is negative"));
  system.bodies[0].modal.rows(system.surfaces[0].rows[30].y, 3) = std::nan("");
  EXPECT_THAT(
      message_of<NumericalError>([&] { find_equilibrium(system, sliding_state(system, 0.0)); }),
      HasSubstr("the equations are not finite"));
}

TEST(Equilibrium, ASlaveBeyondTheEndOfItsMasterIsReported) {
  for (const auto assumption : {ContactAssumption::subs_a, ContactAssumption::subs_b}) {
    const System system = paper_system_at(leading_angle, assumption);
    for (const double position : {-0.001, 0.1001}) {
      const Equilibrium lost = find_equilibrium(system, sliding_state(system, to(position)));
      EXPECT_EQ(lost.status, EquilibriumStatus::master_lost);
      EXPECT_THAT(lost.failure,
                  HasSubstr("beyond the end of the surface cantilever.top (0.1 m long)"));
    }
  }
  // On the very end it is still there, whatever rounding says.
  for (const double position : {0.0, 0.1}) {
    for (const double rounding : {-1e-16, 0.0, 1e-16}) {
      const System rigidly = paper_system_at(leading_angle, ContactAssumption::subs_a);
      EXPECT_EQ(find_equilibrium(rigidly, sliding_state(rigidly, to(position) + rounding)).status,
                EquilibriumStatus::converged);
    }
  }
  // Friction bends the leading tip forward by 0.04 mm, past the end.
  const System system = paper_system_at(leading_angle);
  const Equilibrium lost = find_equilibrium(system, sliding_state(system, to(0.09999)));
  EXPECT_EQ(lost.status, EquilibriumStatus::master_lost);
}

TEST(Equilibrium, NotConvergingIsReported) {
  const System system = paper_system_at(trailing_angle);
  const Equilibrium unfinished = find_equilibrium(system, sliding_state(system, to(0.0905)),
                                                  {.tolerance = 1e-12, .max_iterations = 1});
  EXPECT_EQ(unfinished.status, EquilibriumStatus::not_converged);
  EXPECT_EQ(unfinished.iterations, 1);
  EXPECT_GT(unfinished.residual, 1e-12);
  EXPECT_THAT(unfinished.failure, HasSubstr("the residual stays at"));

  const System block = make_paper_model(block_on_cantilever(ContactAssumption::film)).system;
  const Equilibrium halfway = find_equilibrium(block, sliding_state(block, 0.0), {.max_passes = 1});
  EXPECT_EQ(halfway.status, EquilibriumStatus::not_converged);
  EXPECT_THAT(halfway.failure, HasSubstr("still change after 1 passes"));
}

TEST(Equilibrium, OnACurvedMasterTheNormalIsThatOfTheSegmentArrivedAt) {
  for (const double angle : {trailing_angle, leading_angle}) {
    System system = paper_system_at(angle, ContactAssumption::subs_c);
    MasterSurface& surface = system.surfaces[0];
    for (std::size_t k = 0; k < surface.positions.size(); ++k)
      surface.positions[k].y() += 1e-4 * std::sin(0.3 * static_cast<double>(k));
    int moved_on = 0;
    for (int k = 0; k < 100; ++k) {
      const double displacement = to(0.060) + 1e-5 * k;
      const Equilibrium equilibrium = find_equilibrium(system, sliding_state(system, displacement));
      ASSERT_EQ(equilibrium.status, EquilibriumStatus::converged) << equilibrium.failure;
      const ContactEquilibrium& contact = equilibrium.contacts[0];
      const Projection prescribed =
          project(surface.undeformed_segment(contact.segment),
                  system.contacts[0].slave_position + Eigen::Vector2d(displacement, 0.0));
      // Positions of 0.1 m are rounded to 1e-17, 1e-14 of the segment.
      EXPECT_LT((contact.projection.tangent - prescribed.tangent).norm(), 1e-13);
      moved_on += prescribed.xi < 0.0 || prescribed.xi > 1.0 ? 1 : 0;
    }
    EXPECT_GT(moved_on, 0) << "the case shows nothing";
  }
}

}  // namespace
}  // namespace stridor
