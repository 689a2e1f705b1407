#include "substructures/reduction/modal_body.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <vector>

#include "core/errors.hpp"
#include "tests/support/full_model.hpp"
#include "tests/support/message_of.hpp"
#include "tests/support/paper_beams.hpp"

namespace stridor {
namespace {

using test::eps;
using test::message_of;
using testing::HasSubstr;

ReducedBody reduced_oblique(double angle = test::trailing_angle) {
  const BodyMatrices body = make_beam(test::paper_oblique(angle));
  const std::vector<int> interface = test::slave_interface(body);
  return make_craig_bampton(body, interface, 20, interface);
}

ReducedBody reduced_cantilever() {
  const BodyMatrices body = make_beam(test::paper_cantilever());
  const std::vector<int> interface = test::master_interface(body);
  return make_craig_bampton(body, interface, 20, interface);
}

double frequency(const ModalBody& body, Eigen::Index mode) {
  return body.omega(mode) / (2.0 * std::numbers::pi);
}

ReducedBody two_masses(double k11, double k22) {
  ReducedBody body;
  body.mass = Eigen::Matrix2d::Identity();
  body.stiffness = Eigen::Vector2d(k11, k22).asDiagonal();
  body.rows = Eigen::Matrix2d::Identity();
  return body;
}

ModalBody modal_oscillator(double omega, double alpha, double beta) {
  ModalBody body;
  body.omega = Eigen::VectorXd::Constant(1, omega);
  body.damping.alpha = alpha;
  body.damping.beta = beta;
  return body;
}

TEST(ModalBody, SizesAreThoseOfThePaper) {
  EXPECT_EQ(make_modal(reduced_oblique()).size(), 23);
  EXPECT_EQ(make_modal(reduced_cantilever()).size(), 220);
}

// The expected values are printed with a fixed number of decimals: half a unit in the last place.

TEST(ModalBody, CantileverHasTheFrequenciesOfThePaper) {
  const ModalBody body = make_modal(reduced_cantilever());
  const std::vector<double> expected{45.574,   285.114,  796.122,  1553.860, 2555.567,  3523.060,
                                     3794.164, 5261.685, 6949.361, 8847.934, 10568.911, 10947.959};
  for (std::size_t i = 0; i < expected.size(); ++i)
    EXPECT_NEAR(frequency(body, static_cast<Eigen::Index>(i)), expected[i], 0.0005) << i + 1;
}

TEST(ModalBody, ObliqueBeamHasTheFrequenciesOfThePaperOnWhicheverSideItLeans) {
  for (const double angle : {test::trailing_angle, test::leading_angle}) {
    const ModalBody body = make_modal(reduced_oblique(angle));
    const std::vector<double> expected{296.138, 1587.512, 4067.826, 7696.764};
    for (std::size_t i = 0; i < expected.size(); ++i)
      EXPECT_NEAR(frequency(body, static_cast<Eigen::Index>(i) + 1), expected[i], 0.0005) << i + 2;
    EXPECT_NEAR(frequency(body, 5), 12429.07, 0.005);
  }
}

TEST(ModalBody, RigidModeIsExactlyZero) {
  const ModalBody body = make_modal(reduced_oblique());
  EXPECT_EQ(body.omega(0), 0.0);
  EXPECT_GT(body.omega(1), 0.0);
  EXPECT_GT(make_modal(reduced_cantilever()).omega(0), 0.0);
}

TEST(ModalBody, LargestCircularFrequenciesAreThoseOfThePaper) {
  const double oblique = make_modal(reduced_oblique()).omega.maxCoeff();
  const double cantilever = make_modal(reduced_cantilever()).omega.maxCoeff();
  // One unit of the sixth digit: the smaller one comes out as 1483915.01, on the edge between two
  // roundings.
  EXPECT_NEAR(std::min(oblique, cantilever), 1.48391e6, 10.0);
  EXPECT_NEAR(std::max(oblique, cantilever), 6.07534e6, 5.0);
}

TEST(ModalBody, StepLimitsAreThoseOfThePaper) {
  ModalBody oblique = make_modal(reduced_oblique());
  ModalBody cantilever = make_modal(reduced_cantilever());
  EXPECT_NEAR(std::min(central_difference_limit(oblique), central_difference_limit(cantilever)),
              2.916e-7, 0.0005e-7);
  oblique.damping = {};
  cantilever.damping = {};
  EXPECT_NEAR(std::min(central_difference_limit(oblique), central_difference_limit(cantilever)),
              3.29e-7, 0.005e-7);
}

TEST(ModalBody, FrequenciesAscend) {
  for (const ModalBody& body : {make_modal(reduced_oblique()), make_modal(reduced_cantilever())}) {
    for (Eigen::Index i = 1; i < body.size(); ++i) EXPECT_GE(body.omega(i), body.omega(i - 1));
  }
}

TEST(ModalBody, ShapesDiagonaliseMassAndStiffness) {
  // With one row per coordinate, `rows` is Φ.
  for (ReducedBody reduced : {reduced_oblique(), reduced_cantilever()}) {
    const Eigen::Index n = reduced.size();
    reduced.rows = Eigen::MatrixXd::Identity(n, n);
    const ModalBody body = make_modal(reduced);
    const Eigen::MatrixXd& phi = body.rows;
    // Backward error of the Cholesky reduction of the pencil: n eps times the condition of M.
    const double tolerance = static_cast<double>(n) * eps * test::condition_number(reduced.mass);
    EXPECT_LE((phi.transpose() * reduced.mass * phi - Eigen::MatrixXd::Identity(n, n))
                  .cwiseAbs()
                  .maxCoeff(),
              tolerance);
    const Eigen::VectorXd squares = body.omega.cwiseAbs2();
    EXPECT_LE((phi.transpose() * reduced.stiffness * phi - Eigen::MatrixXd(squares.asDiagonal()))
                  .cwiseAbs()
                  .maxCoeff(),
              tolerance * squares.maxCoeff());
  }
}

TEST(ModalBody, StaticComplianceIsThatOfTheReducedBody) {
  // rows K⁻¹ rowsᵀ = Σ rows_i rows_iᵀ / ω_i²
  const ReducedBody reduced = reduced_cantilever();
  const ModalBody body = make_modal(reduced);
  const Eigen::MatrixXd expected =
      reduced.rows * reduced.stiffness.ldlt().solve(Eigen::MatrixXd(reduced.rows.transpose()));
  const Eigen::VectorXd flexibility = body.omega.cwiseAbs2().cwiseInverse();
  const Eigen::MatrixXd compliance = body.rows * flexibility.asDiagonal() * body.rows.transpose();
  // The lowest ω² carries the compliance and has the error n eps cond(M) ω_max². Coordinates in kg
  // and modal ones differ in scale, to which Cholesky is blind: the condition that counts is that
  // of M scaled to a unit diagonal.
  const Eigen::VectorXd scale = reduced.mass.diagonal().cwiseSqrt().cwiseInverse();
  const Eigen::MatrixXd scaled_mass = scale.asDiagonal() * reduced.mass * scale.asDiagonal();
  const double tolerance = static_cast<double>(reduced.size()) * eps *
                           test::condition_number(scaled_mass) *
                           std::pow(body.omega.maxCoeff() / body.omega(0), 2);
  EXPECT_LE((compliance - expected).norm(), tolerance * expected.norm());
  EXPECT_LT(tolerance, 1e-3);
}

TEST(ModalBody, BaseInertiaActsOnTheSameRowsAsBefore) {
  // The acceleration that a unit base acceleration causes: rows M⁻¹ base.
  const ReducedBody reduced = reduced_oblique();
  const ModalBody body = make_modal(reduced);
  const Eigen::VectorXd expected = reduced.rows * reduced.mass.ldlt().solve(reduced.base_inertia);
  EXPECT_LE((body.rows * body.base_inertia - expected).norm(),
            static_cast<double>(reduced.size()) * eps * test::condition_number(reduced.mass) *
                expected.norm());
  EXPECT_EQ(make_modal(reduced_cantilever()).base_inertia.size(), 0);
}

TEST(ModalBody, DampingIsHandedOn) {
  const ModalBody body = make_modal(reduced_oblique());
  EXPECT_EQ(body.damping.alpha_max(), 40.0);
  EXPECT_EQ(body.damping.alpha_at(1.0), 0.2);
  EXPECT_EQ(body.damping.beta, 4e-8);
}

TEST(ModalBody, FrequenciesBelowAMillionthOfTheLargestAreZero) {
  const ModalBody below = make_modal(two_masses(0.81e-12, 1.0));
  EXPECT_EQ(below.omega(0), 0.0);
  const ModalBody above = make_modal(two_masses(1.21e-12, 1.0));
  EXPECT_NEAR(above.omega(0), 1.1e-6, 1e-6 * 1e-3);  // ω² carries the rounding eps of the largest
  EXPECT_EQ(make_modal(two_masses(-0.81e-12, 1.0)).omega(0), 0.0);
}

TEST(ModalBody, NegativeStiffnessThrows) {
  EXPECT_THAT(message_of<NumericalError>([] { make_modal(two_masses(-0.5, 1.0)); }),
              HasSubstr("modal form: mode 1 has the negative stiffness -5.000e-01 1/s²"));
}

TEST(ModalBody, NegativeMassThrows) {
  ReducedBody body = two_masses(1.0, 2.0);
  body.mass(1, 1) = -1.0;
  EXPECT_EQ(message_of<NumericalError>([&] { make_modal(body); }),
            "modal form: the mass has a negative entry on its diagonal");
  body.mass(1, 1) = std::numeric_limits<double>::quiet_NaN();
  EXPECT_THAT(message_of<NumericalError>([&] { make_modal(body); }), HasSubstr("modal form"));
}

TEST(CentralDifferenceLimit, OfAnUndampedOscillatorIsTwoOverOmega) {
  EXPECT_DOUBLE_EQ(central_difference_limit(modal_oscillator(5.0, 0.0, 0.0)), 0.4);
}

TEST(CentralDifferenceLimit, OfADampedOscillatorSolvesItsQuadratic) {
  // h² ω² + 2 h c = 4: (−c + √(c² + 4 ω²))/ω².
  const double omega = 3.0;
  const double c = 0.7 + 0.05 * 9.0;
  const double h = central_difference_limit(modal_oscillator(omega, 0.7, 0.05));
  EXPECT_NEAR(h * h * omega * omega + 2.0 * h * c, 4.0, 16.0 * eps * 4.0);
  EXPECT_NEAR(h, (-c + std::sqrt(c * c + 4.0 * omega * omega)) / (omega * omega), 16.0 * eps * h);
}

TEST(CentralDifferenceLimit, OfADampedRigidModeIsTwoOverC) {
  EXPECT_DOUBLE_EQ(central_difference_limit(modal_oscillator(0.0, 8.0, 1e-3)), 0.25);
}

TEST(CentralDifferenceLimit, OfNothingIsInfinite) {
  EXPECT_EQ(central_difference_limit(modal_oscillator(0.0, 0.0, 1e-3)),
            std::numeric_limits<double>::infinity());
  EXPECT_EQ(central_difference_limit(ModalBody{}), std::numeric_limits<double>::infinity());
}

TEST(CentralDifferenceLimit, IsThatOfTheLargestDampingOfTheSchedule) {
  ModalBody body = modal_oscillator(3.0, 0.2, 0.0);
  const double calm = central_difference_limit(body);
  body.damping.alpha_start = 4.0;
  EXPECT_EQ(central_difference_limit(body),
            central_difference_limit(modal_oscillator(3.0, 4.0, 0.0)));
  EXPECT_LT(central_difference_limit(body), calm);
}

TEST(CentralDifferenceLimit, IsTheSmallestOfAllModes) {
  ModalBody body = modal_oscillator(1.0, 0.0, 0.0);
  body.omega.resize(3);
  body.omega << 0.0, 2.0, 10.0;
  EXPECT_DOUBLE_EQ(central_difference_limit(body), 0.2);
}

/// Largest |u| of u_{n+1} = (2 − h²ω² − hc) u_n − (1 − hc) u_{n−1} from u_0 = u_1 = 1, up to the
/// step at which it exceeds 1e6.
double largest_motion(double omega, double c, double step) {
  double before = 1.0;
  double now = 1.0;
  double largest = 1.0;
  for (int n = 0; n < 100'000 && largest < 1e6; ++n) {
    const double next =
        (2.0 - step * step * omega * omega - step * c) * now - (1.0 - step * c) * before;
    before = now;
    now = next;
    largest = std::max(largest, std::abs(now));
  }
  return largest;
}

TEST(CentralDifferenceLimit, SeparatesStableFromUnstableSteps) {
  // A thousandth below the limit the undamped motion reaches 1/√(1 − 0.999²) = 22.4 (its phase per
  // step is almost π), damped ones less; a thousandth above it grows by at least 1e-3 / (1 + |1 −
  // hc|) per step and passes 1e6 well within 1e5 steps.
  struct Case {
    double omega, alpha, beta;
  };
  for (const auto& [omega, alpha, beta] : {Case{3.0, 0.0, 0.0},
                                           {3.0, 0.5, 0.0},
                                           {3.0, 0.0, 0.3},
                                           {3.0, 40.0, 0.1},
                                           {6.07534e6, 40.0, 4e-8}}) {
    const double limit = central_difference_limit(modal_oscillator(omega, alpha, beta));
    const double c = alpha + beta * omega * omega;
    EXPECT_LT(largest_motion(omega, c, 0.999 * limit), 25.0) << omega << ", " << c;
    EXPECT_GE(largest_motion(omega, c, 1.001 * limit), 1e6) << omega << ", " << c;
  }
}

// --- residual flexibility
// ------------------------------------------------------------------------------

/// A chain of six masses, each watched, on a base that moves.
ReducedBody watched_chain() {
  ReducedBody body;
  body.mass = Eigen::VectorXd::LinSpaced(6, 1.0, 2.0).asDiagonal();
  body.stiffness = Eigen::VectorXd::Constant(6, 300.0).asDiagonal();
  body.stiffness.diagonal(1).setConstant(-100.0);
  body.stiffness.diagonal(-1).setConstant(-100.0);
  body.damping.alpha = 0.3;
  body.damping.beta = 2e-4;
  body.rows = Eigen::MatrixXd::Identity(6, 6);
  body.base_inertia = body.mass.diagonal();
  return body;
}

TEST(StaticResidual, AndTheKeptModesTogetherAnswerLoadsAsTheWholeBody) {
  const ReducedBody body = watched_chain();
  const ModalBody all = make_modal(body);
  const ModalBody kept = with_static_residual(all, 0.5 * (all.omega(2) + all.omega(3)));
  ASSERT_EQ(kept.size(), 3);
  EXPECT_EQ(kept.residual.num_modes, 3);
  EXPECT_EQ(kept.residual.beta, 2e-4);
  const Eigen::MatrixXd flexibility = body.stiffness.inverse();
  const Eigen::MatrixXd by_kept =
      kept.rows * kept.omega.array().square().inverse().matrix().asDiagonal();
  // Rounding of a flexibility of 1e-2.
  EXPECT_LT((by_kept * kept.rows.transpose() + kept.residual.flexibility - flexibility).norm(),
            1e-16);
  EXPECT_LT((by_kept * kept.shapes.transpose() + kept.residual.shapes - flexibility).norm(), 1e-16);
  const Eigen::VectorXd by_base = flexibility * body.base_inertia;
  EXPECT_LT((by_kept * kept.base_inertia + kept.residual.base_rows - by_base).norm(), 1e-15);
  EXPECT_LT((by_kept * kept.base_inertia + kept.residual.base_shapes - by_base).norm(), 1e-15);
}

TEST(StaticResidual, LeavesABodyAloneThatHasNoHigherModes) {
  const ModalBody all = make_modal(watched_chain());
  const ModalBody kept = with_static_residual(all, all.omega(5));
  EXPECT_EQ(kept.size(), 6);
  EXPECT_EQ(kept.residual.num_modes, 0);
  EXPECT_EQ(kept.residual.flexibility.size(), 0);
}

TEST(StaticResidual, RefusesACutoffOfNothingAndASecondCut) {
  const ModalBody all = make_modal(watched_chain());
  const auto message = [](const ModalBody& body, double cutoff) -> std::string {
    try {
      with_static_residual(body, cutoff);
    } catch (const std::invalid_argument& error) {
      return error.what();
    }
    return "";
  };
  EXPECT_EQ(message(all, 0.0), "with_static_residual: cutoff must be positive");
  EXPECT_EQ(message(all, std::nan("")), "with_static_residual: cutoff must be positive");
  EXPECT_EQ(message(with_static_residual(all, all.omega(2)), 1.0),
            "with_static_residual: the body has a residual already");
}

}  // namespace
}  // namespace stridor
