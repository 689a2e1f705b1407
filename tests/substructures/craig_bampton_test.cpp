#include "substructures/reduction/craig_bampton.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <numeric>
#include <random>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include "core/errors.hpp"
#include "substructures/matrices/sparse_cholesky.hpp"
#include "substructures/reduction/modal_body.hpp"
#include "tests/support/full_model.hpp"
#include "tests/support/message_of.hpp"
#include "tests/support/paper_beams.hpp"
#include "tests/support/spring_chain.hpp"

namespace stridor {
namespace {

using test::eps;
using test::message_of;
using test::paper_cantilever;
using test::paper_oblique;
using testing::StartsWith;

BeamParameters coarse_beam(Support start, Support end) {
  BeamParameters beam = paper_oblique();
  beam.mesh = {6, 1};
  beam.supports = {start, end};
  return beam;
}

std::vector<int> all_dofs(const BodyMatrices& body) {
  std::vector<int> dofs(static_cast<std::size_t>(body.num_dofs()));
  std::iota(dofs.begin(), dofs.end(), 0);
  return dofs;
}

/// Both DoFs of the bottom corners: enough to hold a free beam.
std::vector<int> corner_interface(const BodyMatrices& body) {
  std::vector<int> dofs = test::point_dofs(body, "start_bottom");
  for (const int dof : test::point_dofs(body, "end_bottom")) dofs.push_back(dof);
  return dofs;
}

Eigen::VectorXd random_vector(Eigen::Index size, unsigned seed) {
  std::mt19937 generator(seed);
  std::uniform_real_distribution<double> uniform(-1.0, 1.0);
  Eigen::VectorXd vector(size);
  for (double& entry : vector) entry = uniform(generator);
  return vector;
}

/// Backward error of one reduction or dense eigenproblem: n eps of the largest eigenvalue, made
/// worse by the condition of the mass.
double spectrum_tolerance(const BodyMatrices& body, double largest) {
  return static_cast<double>(body.num_dofs()) * eps *
         test::condition_number(Eigen::MatrixXd(body.mass)) * largest;
}

TEST(CraigBampton, StaticInterfaceLoadIsExactWithZeroModes) {
  const BodyMatrices body = make_beam(paper_cantilever());
  const std::vector<int> interface = test::master_interface(body);
  const std::vector<int> watched = all_dofs(body);
  const ReducedBody reduced = make_craig_bampton(body, interface, 0, watched);
  ASSERT_EQ(reduced.size(), 200);
  EXPECT_EQ(reduced.num_interface, 200);
  const Eigen::VectorXd load = random_vector(200, 1);
  const Eigen::VectorXd recovered = reduced.rows * reduced.stiffness.ldlt().solve(load);

  Eigen::VectorXd full_load = Eigen::VectorXd::Zero(body.num_dofs());
  for (std::size_t i = 0; i < interface.size(); ++i)
    full_load(interface[i]) = load(static_cast<Eigen::Index>(i));
  const Eigen::VectorXd full = SparseCholesky(body.stiffness, "the beam").solve(full_load);
  // Forward error of either solution: eps times the condition of K.
  EXPECT_LE((recovered - full).norm(),
            eps * test::condition_number(Eigen::MatrixXd(body.stiffness)) * full.norm());
}

TEST(CraigBampton, StaticInterfaceLoadStaysExactWhateverModesAreKept) {
  const BodyMatrices body = make_beam(coarse_beam(Support::free, Support::clamped));
  const std::vector<int> interface = test::slave_interface(body);
  const std::vector<int> watched = all_dofs(body);
  const SparseCholesky factor(body.stiffness, "the beam");
  const Eigen::VectorXd load = random_vector(2, 2);
  Eigen::VectorXd full_load = Eigen::VectorXd::Zero(body.num_dofs());
  for (std::size_t i = 0; i < 2; ++i) full_load(interface[i]) = load(static_cast<Eigen::Index>(i));
  const Eigen::VectorXd full = factor.solve(full_load);
  const double tolerance = eps * test::condition_number(Eigen::MatrixXd(body.stiffness));
  for (const Eigen::Index num_modes : {0, 1, 5, 20}) {
    const ReducedBody reduced = make_craig_bampton(body, interface, num_modes, watched);
    const Eigen::VectorXd force = reduced.rows.transpose() * full_load;
    const Eigen::VectorXd recovered = reduced.rows * reduced.stiffness.ldlt().solve(force);
    EXPECT_LE((recovered - full).norm(), tolerance * full.norm()) << num_modes;
  }
}

TEST(CraigBampton, RowOfAnInteriorDoFRecoversTheStaticDeflection) {
  const BodyMatrices body = make_beam(coarse_beam(Support::clamped, Support::free));
  const std::vector<int> interface = test::point_dofs(body, "end_top");
  const int interior = test::point_dofs(body, "end_bottom")[1];
  const ReducedBody reduced = make_craig_bampton(body, interface, 0, std::vector<int>{interior});
  const Eigen::VectorXd full = SparseCholesky(body.stiffness, "the beam")
                                   .solve(Eigen::VectorXd::Unit(body.num_dofs(), interface[1]));
  const double recovered =
      (reduced.rows * reduced.stiffness.ldlt().solve(Eigen::Vector2d(0.0, 1.0)))(0);
  EXPECT_NEAR(recovered, full(interior),
              eps * test::condition_number(Eigen::MatrixXd(body.stiffness)) * full.norm());
}

TEST(CraigBampton, ChainIsReducedAsByHand) {
  // Three unit masses and four unit springs, the outer two kept: Ψ = (1/2, 1/2), φ = 1.
  const BodyMatrices body = test::chain_body(3);
  const ReducedBody reduced =
      make_craig_bampton(body, std::vector<int>{2, 0}, 1, std::vector<int>{0, 1, 2});
  Eigen::Matrix3d mass;
  mass << 1.25, 0.25, 0.5, 0.25, 1.25, 0.5, 0.5, 0.5, 1.0;
  Eigen::Matrix3d stiffness;
  stiffness << 1.5, -0.5, 0.0, -0.5, 1.5, 0.0, 0.0, 0.0, 2.0;
  Eigen::Matrix3d rows;
  rows << 0.0, 1.0, 0.0, 0.5, 0.5, 1.0, 1.0, 0.0, 0.0;
  EXPECT_LE((reduced.mass - mass).cwiseAbs().maxCoeff(), 8.0 * eps);
  EXPECT_LE((reduced.stiffness - stiffness).cwiseAbs().maxCoeff(), 8.0 * eps);
  EXPECT_LE((reduced.rows - rows).cwiseAbs().maxCoeff(), 8.0 * eps);
}

TEST(CraigBampton, MatricesAreTheFullOnesBetweenTheBasisVectors) {
  // With every DoF watched, `rows` is T: M = Tᵀ M T, K = Tᵀ K T, and so for the base inertia. The
  // 200 static modes of the second body are formed in several groups.
  const BodyMatrices oblique = make_beam(paper_oblique());
  const BodyMatrices cantilever = make_beam(paper_cantilever());
  const std::vector<std::pair<const BodyMatrices*, std::vector<int>>> cases{
      {&oblique, test::slave_interface(oblique)},
      {&cantilever, test::master_interface(cantilever)}};
  for (const auto& [full, interface] : cases) {
    const BodyMatrices& body = *full;
    const ReducedBody reduced = make_craig_bampton(body, interface, 20, all_dofs(body));
    const Eigen::MatrixXd& basis = reduced.rows;
    const Eigen::MatrixXd mass = basis.transpose() * body.mass * basis;
    const Eigen::MatrixXd stiffness = basis.transpose() * body.stiffness * basis;
    const double n = static_cast<double>(body.num_dofs());
    EXPECT_LE((reduced.mass - mass).norm(), n * eps * body.mass.norm() * basis.squaredNorm());
    EXPECT_LE((reduced.stiffness - stiffness).norm(),
              n * eps * body.stiffness.norm() * basis.squaredNorm());
    EXPECT_EQ(reduced.mass, reduced.mass.transpose());
    EXPECT_EQ(reduced.stiffness, reduced.stiffness.transpose());
    if (!body.follows_drive()) continue;
    EXPECT_LE((reduced.base_inertia - basis.transpose() * body.base_inertia).norm(),
              n * eps * body.base_inertia.norm() * basis.norm());
  }
}

TEST(CraigBampton, RigidMotionsKeepTheirMassAndGiveNoForce) {
  const BeamParameters beam = coarse_beam(Support::free, Support::free);
  const BodyMatrices body = make_beam(beam);
  const std::vector<int> interface = corner_interface(body);
  const double total = beam.material.density * beam.length * beam.thickness * beam.width;
  // The interior follows through Ψ, whose error is eps times the condition of K_ii.
  const double condition = test::condition_number(
      Eigen::MatrixXd(test::submatrix(body.stiffness, test::interior_dofs(body, interface))));
  for (const Eigen::Index num_modes : {0, 5}) {
    const ReducedBody reduced = make_craig_bampton(body, interface, num_modes, {});
    const auto reduce = [&](const Eigen::VectorXd& motion) {
      Eigen::VectorXd coordinates = Eigen::VectorXd::Zero(reduced.size());
      coordinates.head(4) = motion(interface);
      return coordinates;
    };
    for (const Eigen::VectorXd& motion :
         {test::rigid_motion(body, {1.0, 0.0}), test::rigid_motion(body, {0.0, 1.0}),
          test::rigid_motion(body, {0.0, 0.0}, 1.0)}) {
      const Eigen::VectorXd q = reduce(motion);
      const double expected = motion.dot(body.mass * motion);
      EXPECT_NEAR(q.dot(reduced.mass * q), expected, eps * condition * expected);
      EXPECT_LE((reduced.stiffness * q).norm(),
                eps * condition * reduced.stiffness.norm() * q.norm());
    }
    const Eigen::VectorXd x = reduce(test::rigid_motion(body, {1.0, 0.0}));
    EXPECT_NEAR(x.dot(reduced.mass * x), total, eps * condition * total);
  }
}

TEST(CraigBampton, BaseInertiaOfARigidMotionIsThatOfTheFullBody) {
  // A free beam that is told to follow: the whole of it is accelerated.
  const BeamParameters beam = coarse_beam(Support::free, Support::free);
  BodyMatrices body = make_beam(beam);
  const Eigen::VectorXd translation = test::rigid_motion(body, {1.0, 0.0});
  const Eigen::VectorXd rotation = test::rigid_motion(body, {0.0, 0.0}, 1.0);
  body.base_inertia = body.mass * translation;
  const std::vector<int> interface = corner_interface(body);
  const ReducedBody reduced = make_craig_bampton(body, interface, 5, {});
  ASSERT_EQ(reduced.base_inertia.size(), reduced.size());
  const double condition = test::condition_number(
      Eigen::MatrixXd(test::submatrix(body.stiffness, test::interior_dofs(body, interface))));
  const double total = beam.material.density * beam.length * beam.thickness * beam.width;
  EXPECT_NEAR(reduced.base_inertia.head(4).dot(translation(interface)), total,
              eps * condition * total);
  EXPECT_NEAR(reduced.base_inertia.head(4).dot(rotation(interface)),
              body.base_inertia.dot(rotation), eps * condition * total * beam.length);
}

TEST(CraigBampton, LiftingAGuidedBeamMeetsNoBaseInertia) {
  const BeamParameters beam = paper_oblique();
  const BodyMatrices body = make_beam(beam);
  const ReducedBody reduced = make_craig_bampton(body, test::slave_interface(body), 0, {});
  const double total = beam.material.density * beam.length * beam.thickness * beam.width;
  // Sum of C_y and A_y; the interior follows through Ψ.
  const double condition = test::condition_number(Eigen::MatrixXd(
      test::submatrix(body.stiffness, test::interior_dofs(body, test::slave_interface(body)))));
  EXPECT_NEAR(reduced.base_inertia(1) + reduced.base_inertia(2), 0.0, eps * condition * total);
}

TEST(CraigBampton, BodyThatDoesNotFollowHasNoBaseInertia) {
  const BodyMatrices body = make_beam(coarse_beam(Support::clamped, Support::free));
  EXPECT_EQ(make_craig_bampton(body, test::point_dofs(body, "end_top"), 0, {}).base_inertia.size(),
            0);
}

TEST(CraigBampton, AllModesKeptGivesTheFullSpectrum) {
  for (const auto& [start, end] :
       {std::pair{Support::free, Support::clamped}, {Support::free, Support::guided}}) {
    const BodyMatrices body = make_beam(coarse_beam(start, end));
    const std::vector<int> interface = test::slave_interface(body);
    const Eigen::Index num_interior = body.num_dofs() - static_cast<Eigen::Index>(interface.size());
    const ReducedBody reduced = make_craig_bampton(body, interface, num_interior, {});
    ASSERT_EQ(reduced.size(), body.num_dofs());
    const Eigen::VectorXd full =
        test::dense_spectrum(Eigen::MatrixXd(body.stiffness), Eigen::MatrixXd(body.mass));
    const Eigen::VectorXd kept = test::dense_spectrum(reduced.stiffness, reduced.mass);
    // Of one reduction and two eigenproblems.
    EXPECT_LE((kept - full).cwiseAbs().maxCoeff(), 3.0 * spectrum_tolerance(body, full.maxCoeff()));
  }
}

TEST(CraigBampton, FrequenciesLieAboveTheFullOnesAndFallAsModesAreAdded) {
  // Rayleigh-Ritz on growing subspaces.
  const BodyMatrices body = make_beam(coarse_beam(Support::free, Support::clamped));
  const std::vector<int> interface = test::slave_interface(body);
  const Eigen::VectorXd full =
      test::dense_spectrum(Eigen::MatrixXd(body.stiffness), Eigen::MatrixXd(body.mass));
  const double rounding = spectrum_tolerance(body, full.maxCoeff());
  Eigen::VectorXd previous;
  for (const Eigen::Index num_modes : {0, 2, 4, 8, 16, 32}) {
    const ReducedBody reduced = make_craig_bampton(body, interface, num_modes, {});
    const Eigen::VectorXd squares = test::dense_spectrum(reduced.stiffness, reduced.mass);
    for (Eigen::Index i = 0; i < squares.size(); ++i)
      EXPECT_GE(squares(i), full(i) - rounding) << num_modes << " modes, frequency " << i + 1;
    for (Eigen::Index i = 0; i < previous.size(); ++i)
      EXPECT_LE(squares(i), previous(i) + rounding) << num_modes << " modes, frequency " << i + 1;
    if (previous.size() > 0) {
      EXPECT_LT(squares(0), previous(0)) << num_modes;
    }
    previous = squares;
  }
}

TEST(CraigBampton, InterfaceDoFsComeFirstInTheGivenOrder) {
  const BodyMatrices body = make_beam(coarse_beam(Support::free, Support::clamped));
  std::vector<int> interface = test::point_dofs(body, "tip");
  const ReducedBody forward = make_craig_bampton(body, interface, 3, interface);
  Eigen::MatrixXd unit = Eigen::MatrixXd::Identity(2, 5);
  EXPECT_EQ(forward.rows, unit);
  std::swap(interface[0], interface[1]);
  const ReducedBody backward = make_craig_bampton(body, interface, 3, interface);
  EXPECT_EQ(backward.rows, unit);
  // Only the order of sums differs: n eps of the largest entry.
  const double rounding = static_cast<double>(body.num_dofs()) * eps;
  EXPECT_NEAR(backward.mass(0, 0), forward.mass(1, 1), rounding * forward.mass(1, 1));
  EXPECT_NEAR(backward.stiffness(1, 1), forward.stiffness(0, 0),
              rounding * body.stiffness.coeffs().abs().maxCoeff());
}

TEST(CraigBampton, HeldDoFHasARowOfZeros) {
  const BodyMatrices body = make_beam(coarse_beam(Support::free, Support::clamped));
  const std::vector<int> watched{BodyMatrices::held, 4, BodyMatrices::held};
  const ReducedBody reduced = make_craig_bampton(body, test::slave_interface(body), 3, watched);
  ASSERT_EQ(reduced.rows.rows(), 3);
  EXPECT_EQ(reduced.rows.row(0).cwiseAbs().maxCoeff(), 0.0);
  EXPECT_GT(reduced.rows.row(1).cwiseAbs().maxCoeff(), 0.0);
  EXPECT_EQ(reduced.rows.row(2).cwiseAbs().maxCoeff(), 0.0);
}

TEST(CraigBampton, DampingIsHandedOn) {
  const ReducedBody reduced =
      make_craig_bampton(make_beam(paper_oblique()), std::vector<int>{0, 1, 2}, 0, {});
  EXPECT_EQ(reduced.damping.alpha, 0.2);
  EXPECT_EQ(reduced.damping.beta, 4e-8);
  EXPECT_EQ(reduced.damping.alpha_start, 40.0);
  EXPECT_EQ(reduced.damping.hold, 0.2);
  EXPECT_EQ(reduced.damping.fade, 0.05);
}

TEST(CraigBampton, WithoutInteriorTheBodyIsUnchanged) {
  const BodyMatrices body = test::chain_body(4);
  const ReducedBody reduced = make_craig_bampton(body, all_dofs(body), 0, all_dofs(body));
  EXPECT_EQ(reduced.mass, Eigen::MatrixXd(body.mass));
  EXPECT_EQ(reduced.stiffness, Eigen::MatrixXd(body.stiffness));
  EXPECT_EQ(reduced.rows, Eigen::MatrixXd::Identity(4, 4));
}

TEST(CraigBampton, WithoutInterfaceTheModesAreThoseOfTheBody) {
  const BodyMatrices body = test::chain_body(10);
  const ReducedBody reduced = make_craig_bampton(body, {}, 4, {});
  EXPECT_EQ(reduced.num_interface, 0);
  EXPECT_EQ(reduced.mass, Eigen::MatrixXd::Identity(4, 4));
  for (int i = 0; i < 4; ++i)
    EXPECT_NEAR(reduced.stiffness(i, i), test::chain_omega_squared(10, i + 1), 40.0 * eps);
}

std::string refusal(const BodyMatrices& body, const std::vector<int>& interface,
                    Eigen::Index num_modes, const std::vector<int>& watched) {
  return message_of<std::invalid_argument>(
      [&] { make_craig_bampton(body, interface, num_modes, watched); });
}

TEST(CraigBampton, InterfaceDoFOutOfRangeThrows) {
  const BodyMatrices body = test::chain_body(4);
  EXPECT_EQ(refusal(body, {0, 4}, 0, {}),
            "make_craig_bampton: interface DoF 4 is out of range or doubled");
  EXPECT_EQ(refusal(body, {BodyMatrices::held}, 0, {}),
            "make_craig_bampton: interface DoF -1 is out of range or doubled");
}

TEST(CraigBampton, DoubledInterfaceDoFThrows) {
  EXPECT_EQ(refusal(test::chain_body(4), {1, 2, 1}, 0, {}),
            "make_craig_bampton: interface DoF 1 is out of range or doubled");
}

TEST(CraigBampton, NumberOfModesOutOfRangeThrows) {
  const BodyMatrices body = test::chain_body(4);
  EXPECT_EQ(refusal(body, {1}, 4, {}),
            "make_craig_bampton: 4 fixed-interface modes asked, 3 interior DoFs");
  EXPECT_EQ(refusal(body, {1}, -1, {}),
            "make_craig_bampton: -1 fixed-interface modes asked, 3 interior DoFs");
}

TEST(CraigBampton, WatchedDoFOutOfRangeThrows) {
  const BodyMatrices body = test::chain_body(4);
  EXPECT_EQ(refusal(body, {1}, 0, {4}), "make_craig_bampton: watched DoF 4 is out of range");
  EXPECT_EQ(refusal(body, {1}, 0, {-2}), "make_craig_bampton: watched DoF -2 is out of range");
}

TEST(CraigBampton, InterfaceThatLeavesARigidMotionThrows) {
  const BodyMatrices body = make_beam(coarse_beam(Support::free, Support::free));
  for (const std::vector<int>& interface :
       {std::vector<int>{}, test::point_dofs(body, "start_bottom")}) {
    EXPECT_THAT(message_of<NumericalError>([&] { make_craig_bampton(body, interface, 2, {}); }),
                StartsWith("the stiffness of the interior ("));
  }
}

TEST(CraigBampton, LiftingAFineSlenderBeamMeetsNoForce) {
  // What is left is the rounding of K_ii Ψ, eps |K| in each of n rows, which add up like noise.
  BeamParameters beam = paper_oblique();
  beam.mesh = {1000, 1};
  const BodyMatrices body = make_beam(beam);
  const ReducedBody reduced = make_craig_bampton(body, test::slave_interface(body), 0, {});
  const Eigen::Vector3d lift(0.0, 1.0, 1.0);
  const double rounding = eps * body.stiffness.coeffs().abs().maxCoeff();
  EXPECT_LE(std::abs(lift.dot(reduced.stiffness * lift)),
            std::sqrt(static_cast<double>(body.num_dofs())) * rounding);
}

TEST(CraigBampton, FrequenciesConvergeFromAboveAsTheMeshIsRefined) {
  // Twice as many elements each way; the corners of the clamp, where the stress is singular, let
  // the error of the frequencies fall by a half or more.
  std::vector<Eigen::VectorXd> omega;
  for (const int refinement : {1, 2, 4}) {
    BeamParameters beam = paper_cantilever();
    beam.mesh = {50 * refinement, refinement};
    const BodyMatrices body = make_beam(beam);
    std::vector<int> interface;
    const std::vector<int> all = test::master_interface(body);
    const auto stride = static_cast<std::size_t>(refinement);
    for (std::size_t node = stride - 1; node < all.size() / 2; node += stride) {
      interface.push_back(all[2 * node]);
      interface.push_back(all[2 * node + 1]);
    }
    ASSERT_EQ(interface.size(), 200u);
    omega.push_back(make_modal(make_craig_bampton(body, interface, 20, {})).omega.head(6));
  }
  for (Eigen::Index i = 0; i < 6; ++i) {
    const double first_step = omega[0](i) - omega[1](i);
    const double second_step = omega[1](i) - omega[2](i);
    EXPECT_GT(second_step, 0.0) << "mode " << i + 1;
    EXPECT_LE(second_step, 0.5 * first_step) << "mode " << i + 1;
    EXPECT_LE(first_step, 5e-3 * omega[0](i)) << "mode " << i + 1;
  }
}

TEST(CraigBampton, MassThatIsNotPositiveDefiniteThrows) {
  BodyMatrices body = test::chain_body(4);
  body.mass.coeffRef(2, 2) = -1.0;
  EXPECT_THAT(
      message_of<NumericalError>([&] { make_craig_bampton(body, std::vector<int>{0}, 2, {}); }),
      StartsWith("fixed-interface modes: "));
}

}  // namespace
}  // namespace stridor
