#include "solvers/eigenvalues/pencil.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <Eigen/LU>
#include <cmath>
#include <numbers>
#include <random>

#include "solvers/eigenvalues/dense_eigenvalues.hpp"
#include "solvers/eigenvalues/eigenvector.hpp"
#include "solvers/eigenvalues/linear_pencil.hpp"
#include "solvers/eigenvalues/residual_modes.hpp"
#include "solvers/eigenvalues/secular_eigenvalues.hpp"
#include "tests/support/full_model.hpp"
#include "tests/support/message_of.hpp"
#include "tests/support/paper_model.hpp"
#include "tests/support/pencils.hpp"

namespace stridor {
namespace {

using test::eps;
using test::message_of;
using ::testing::HasSubstr;
using Complex = std::complex<double>;

Pencil valid_pencil() {
  return test::random_pencil(1, 12, 2, test::ContactTerms::with_stiffness_and_damping);
}

TEST(Pencil, RefusesWhatDoesNotFitTogether) {
  const auto message_after = [](auto&& change) {
    Pencil pencil = valid_pencil();
    change(pencil);
    return message_of<std::invalid_argument>([&] { check_pencil(pencil); });
  };
  EXPECT_EQ(message_after([](Pencil&) {}), "<no exception>");
  EXPECT_EQ(message_after([](Pencil& p) { p.damping.conservativeResize(11); }),
            "pencil: damping is 11 x 1 instead of 12 x 1");
  EXPECT_EQ(message_after([](Pencil& p) { p.ports.conservativeResize(12, 11); }),
            "pencil: ports is 12 x 11 instead of 12 x 12");
  EXPECT_EQ(message_after([](Pencil& p) { p.compatibility.conservativeResize(2, 6); }),
            "pencil: compatibility is 2 x 6 instead of 2 x 12");
  EXPECT_EQ(message_after([](Pencil& p) { p.equilibrium.conservativeResize(1, 12); }),
            "pencil: equilibrium is 1 x 12 instead of 2 x 12");
  EXPECT_EQ(message_after([](Pencil& p) { p.port_stiffness.conservativeResize(12, 6); }),
            "pencil: port_stiffness is 12 x 6 instead of 12 x 12");
  EXPECT_EQ(message_after([](Pencil& p) { p.port_damping.conservativeResize(6, 12); }),
            "pencil: port_damping is 6 x 12 instead of 12 x 12");
  EXPECT_EQ(message_after([](Pencil& p) { p.omega(3) = std::nan(""); }),
            "pencil: omega is not finite");
  EXPECT_EQ(message_after([](Pencil& p) { p.ports(3, 3) = INFINITY; }),
            "pencil: ports is not finite");
  EXPECT_EQ(message_after([](Pencil& p) { p.omega(3) = -1.0; }), "pencil: omega is negative");
  EXPECT_EQ(message_after([](Pencil& p) {
              p = test::constrained_modes(Eigen::Vector2d(1, 2), Eigen::Vector2d::Zero(),
                                          Eigen::Matrix2d::Identity(), Eigen::Matrix2d::Identity());
            }),
            "pencil: 2 constraints leave nothing of 2 modes");
}

TEST(LinearPencil, RefusesWhatDoesNotFitTogether) {
  const auto message_after = [](auto&& change) {
    LinearSystem system;
    system.mass = system.position = Eigen::Matrix2d::Identity();
    system.velocity = Eigen::Matrix2d::Zero();
    system.gaps = system.forces = Eigen::MatrixXd::Ones(1, 2);
    change(system);
    return message_of<std::invalid_argument>([&] { make_pencil(system); });
  };
  EXPECT_EQ(message_after([](LinearSystem&) {}), "<no exception>");
  EXPECT_EQ(message_after([](LinearSystem& s) { s.velocity.conservativeResize(2, 1); }),
            "linear system: the velocity matrix is 2 x 1 instead of 2 x 2");
  EXPECT_EQ(message_after([](LinearSystem& s) { s.forces.resize(2, 2); }),
            "linear system: the matrix of forces is 2 x 2 instead of 1 x 2");
  EXPECT_EQ(message_after([](LinearSystem& s) { s.position(0, 1) = NAN; }),
            "linear system: the position matrix is not finite");
  const std::string indefinite =
      "linear system: the mass matrix is not symmetric positive definite";
  EXPECT_EQ(message_after([](LinearSystem& s) { s.mass(0, 1) = 0.1; }), indefinite);
  EXPECT_EQ(message_after([](LinearSystem& s) { s.mass(1, 1) = -1.0; }), indefinite);
}

TEST(Pencil, EigenvectorsSolveTheRightAndTheLeftProblem) {
  for (const auto terms : {test::ContactTerms::rows_only, test::ContactTerms::with_stiffness,
                           test::ContactTerms::with_stiffness_and_damping}) {
    const Pencil pencil = test::random_pencil(7, 20, 2, terms);
    const Eigen::MatrixXd gap_rows = pencil.compatibility * pencil.ports;
    const Eigen::MatrixXd force_rows = pencil.equilibrium * pencil.ports;
    const Eigen::MatrixXd allowed = Eigen::FullPivLU<Eigen::MatrixXd>(gap_rows).kernel();
    for (const Eigenvalue& eigenvalue : secular_eigenvalues(pencil, SpectrumWindow::all())) {
      const Eigenvector vector = eigenvector(pencil, eigenvalue.s);
      EXPECT_EQ(eigenvector(pencil, modal_rows(pencil), eigenvalue.s).right, vector.right);
      const Eigen::MatrixXcd P = test::dynamic_stiffness(pencil, eigenvalue.s);
      // Entries of P reach 1e6 and the eigenvalue is known to 1e-15 or so; the condition of the
      // problem takes a few digits.
      const double tolerance = 1e-10 * P.norm();
      EXPECT_NEAR(vector.right.norm(), 1.0, 10 * eps);
      EXPECT_LT((P * vector.right + force_rows.transpose() * vector.force).norm(), tolerance);
      EXPECT_LT((gap_rows * vector.right).norm(), 1e-11 * gap_rows.norm());
      EXPECT_LT((vector.left.adjoint() * P * allowed).norm(), tolerance * allowed.norm());
      EXPECT_LT((force_rows * vector.left).norm(), 1e-11 * force_rows.norm());
      EXPECT_LT(relative_residual(pencil, eigenvalue.s, vector.right), 1e-11);
    }
  }
}

TEST(Pencil, EigenvectorsOfManyCoupledModesSolveBothProblems) {
  // Forty modes from 100 to 1e5 rad/s that gyroscopic and circulatory terms couple, two constraints.
  constexpr Eigen::Index n = 40;
  std::mt19937 generator(5);
  std::uniform_real_distribution<double> uniform(-1.0, 1.0);
  const auto random = [&](Eigen::Index rows, Eigen::Index cols) -> Eigen::MatrixXd {
    return Eigen::MatrixXd::NullaryExpr(rows, cols, [&] { return uniform(generator); });
  };
  LinearSystem system;
  system.mass = Eigen::MatrixXd::Identity(n, n);
  const Eigen::MatrixXd gyroscopic = random(n, n), circulatory = random(n, n);
  system.velocity = 200.0 * split(gyroscopic).skew;
  system.position = 1e4 * split(circulatory).skew;
  for (Eigen::Index i = 0; i < n; ++i) {
    const double omega = 100.0 * std::pow(1e3, static_cast<double>(i) / (n - 1));
    system.position(i, i) += omega * omega;
    system.velocity(i, i) += 1e-3 * omega;
  }
  system.gaps = random(2, n);
  system.forces = system.gaps + 0.2 * random(2, n);
  const Pencil pencil = make_pencil(system);
  const Eigen::MatrixXd gap_rows = pencil.compatibility * pencil.ports;
  const Eigen::MatrixXd force_rows = pencil.equilibrium * pencil.ports;
  const Eigen::MatrixXd allowed = Eigen::FullPivLU<Eigen::MatrixXd>(gap_rows).kernel();
  const std::vector<Eigenvalue> eigenvalues = dense_eigenvalues(pencil);
  ASSERT_GE(eigenvalues.size(), 38U);
  for (const Eigenvalue& one : eigenvalues) {
    const Eigenvector vector = eigenvector(pencil, one.s);
    EXPECT_LT(relative_residual(pencil, one.s, vector.right), 1e-9) << one.s;
    const Eigen::MatrixXcd P = test::dynamic_stiffness(pencil, one.s);
    const Eigen::VectorXd scale = (pencil.omega.array() + std::abs(one.s)).inverse();
    const Eigen::VectorXcd left = (vector.left.adjoint() * P * allowed).transpose();
    const double terms = (vector.left.cwiseAbs().transpose() * P.cwiseAbs() * allowed.cwiseAbs()).norm();
    EXPECT_LT(left.norm(), 1e-9 * terms) << one.s;
    EXPECT_LT((force_rows * vector.left).norm(), 1e-9 * force_rows.norm()) << one.s;
    const Eigen::VectorXcd rest = P * vector.right + force_rows.transpose() * vector.force;
    EXPECT_LT(rest.cwiseProduct(scale.cast<std::complex<double>>()).norm(),
              1e-9 * (P.cwiseAbs() * vector.right.cwiseAbs()).cwiseProduct(scale).norm());
  }
}

TEST(Pencil, RelativeResidualSeesAWrongEigenvalueAndAWrongVector) {
  const Pencil pencil = valid_pencil();
  const Eigenvalue eigenvalue = secular_eigenvalues(pencil, SpectrumWindow::lowest(3)).back();
  const Eigenvector vector = eigenvector(pencil, eigenvalue.s);
  EXPECT_LT(relative_residual(pencil, eigenvalue.s, vector.right), 1e-12);
  EXPECT_GT(relative_residual(pencil, eigenvalue.s * (1.0 + 1e-6), vector.right), 1e-8);
  Eigen::VectorXcd other = vector.right;
  other(0) += 1e-6;
  EXPECT_GT(relative_residual(pencil, eigenvalue.s, other), 1e-8);
}

TEST(Pencil, ModalAssuranceIsOneForTheSameShapeAndZeroForOrthogonalOnes) {
  const Eigen::VectorXcd a = Eigen::Vector3cd(Complex(1, 2), 0, Complex(0, 1));
  EXPECT_NEAR(modal_assurance(a, Complex(0, -3) * a), 1.0, 4 * eps);
  EXPECT_EQ(modal_assurance(a, Eigen::Vector3cd(0, 1, 0)), 0.0);
  // |aᴴb|² = |conj(1 + 2j)|² = 5 for the unit vector b; aᴴa = 6.
  EXPECT_NEAR(modal_assurance(a, Eigen::Vector3cd(1, 0, 0)), 5.0 / 6.0, 4 * eps);
}

TEST(Pencil, ResidualModesKeepFlexibilityItsDampingAndItsInertia) {
  Pencil pencil = test::random_pencil(3, 40, 1, test::ContactTerms::rows_only);
  // Proportional damping, and a port that nothing moves.
  pencil.damping = 0.2 + 1e-3 * pencil.omega.array().square();
  pencil.ports.row(4).setZero();
  const double cutoff = 30.0;
  const Pencil reduced = with_residual_modes(pencil, cutoff);
  const auto num_kept = (pencil.omega.array() <= cutoff).count();
  ASSERT_EQ(reduced.num_modes(), num_kept + 5);
  EXPECT_GT(reduced.omega.tail(5).minCoeff(), cutoff);

  const auto moment = [&](const Pencil& of, const Eigen::ArrayXd& factor) {
    const Eigen::VectorXd weight = (of.omega.array() > cutoff).select(factor, 0.0);
    return Eigen::MatrixXd(of.ports * weight.asDiagonal() * of.ports.transpose());
  };
  const auto expect_same = [&](auto&& factor) {
    const Eigen::MatrixXd full = moment(pencil, factor(pencil));
    EXPECT_LT((moment(reduced, factor(reduced)) - full).norm(), 1e-11 * full.norm());
  };
  expect_same([](const Pencil& of) { return of.omega.array().pow(-2.0).eval(); });
  expect_same([](const Pencil& of) { return of.omega.array().pow(-4.0).eval(); });
  expect_same(
      [](const Pencil& of) { return (of.damping.array() * of.omega.array().pow(-4.0)).eval(); });
}

TEST(Pencil, ResidualModesRejectACutOffWithoutMeaning) {
  const Pencil pencil = valid_pencil();
  EXPECT_EQ(message_of<std::invalid_argument>([&] { with_residual_modes(pencil, 0.0); }),
            "pencil: the cut-off must be positive, is 0 rad/s");
  // Nothing above it: the pencil itself.
  EXPECT_EQ(with_residual_modes(pencil, 1e9).omega, pencil.omega);
}

class PaperPencil : public ::testing::Test {
 protected:
  static Pencil at(double position, double angle = test::trailing_angle, double friction = 0.3) {
    const System& system = angle == test::trailing_angle ? trailing().system : leading().system;
    Pencil pencil = make_modal_pencil(system);
    place_undeformed(pencil, system, position - 0.030, friction, 1.0);
    return pencil;
  }
  static const Model& trailing() {
    static const Model model = test::make_paper_model(test::paper_model());
    return model;
  }
  static const Model& leading() {
    static const Model model = test::make_paper_model(test::paper_model(test::leading_angle));
    return model;
  }
};

TEST_F(PaperPencil, RowsAreThoseOfTheSlidingContact) {
  // 48.3 mm: segment 48 of 1 mm, ξ = 0.3; the normal is +y and the tangent +x.
  const Pencil pencil = at(0.0483);
  ASSERT_EQ(pencil.num_modes(), 243);
  ASSERT_EQ(pencil.num_constraints(), 1);
  const ContactRows rows = make_rows({0.3, {1, 0}, {0, 1}, weights_at({}, 0.3).value}, 0.3, 1.0);
  const double xi_rounding = 1e-10;
  for (int i = 0; i < 2; ++i) {
    const auto entry = static_cast<std::size_t>(i);
    EXPECT_NEAR(pencil.compatibility(0, i), rows.compatibility.slave[entry], xi_rounding);
    EXPECT_NEAR(pencil.equilibrium(0, i), rows.equilibrium.slave[entry], xi_rounding);
  }
  for (int i = 0; i < 4; ++i) {
    const auto entry = static_cast<std::size_t>(i);
    EXPECT_NEAR(pencil.compatibility(0, 2 + i), rows.compatibility.master[entry], xi_rounding);
    EXPECT_NEAR(pencil.equilibrium(0, 2 + i), rows.equilibrium.master[entry], xi_rounding);
  }
  // Ports are rows of the bodies, zero for the modes of the other one.
  const System& system = trailing().system;
  const ModalBody& first = system.bodies[0].modal;
  const MasterSurface& surface = system.surfaces[0];
  const bool master_first = surface.body == 0;
  const PointRows& watched = master_first ? surface.rows[48] : system.contacts[0].slave_rows;
  const int port = master_first ? 2 : 0;
  EXPECT_EQ(pencil.ports.row(port).head(first.size()), first.rows.row(watched.x));
  EXPECT_EQ(pencil.ports.row(port + 1).head(first.size()), first.rows.row(watched.y));
  EXPECT_EQ(pencil.ports.row(port).tail(243 - first.size()).norm(), 0.0);
}

TEST_F(PaperPencil, DampingIsThatAtTheEndOfTheSchedule) {
  const Pencil pencil = at(0.048);
  // Rigid mode of the oblique beam, ω = 0 and α = 0.2 once the start-up is over.
  Eigen::Index rigid = 0;
  EXPECT_EQ(pencil.omega.minCoeff(&rigid), 0.0);
  EXPECT_EQ(pencil.damping(rigid), 0.2);
}

TEST_F(PaperPencil, LinearBetweenTwoNodes) {
  const Pencil left = at(0.0481);
  const Pencil right = at(0.0489);
  const Pencil middle = at(0.0485);
  EXPECT_EQ(left.ports, right.ports);
  // ξ of positions of 0.1 m on segments of 1 mm is rounded to 100 eps.
  EXPECT_LT((0.5 * (left.equilibrium + right.equilibrium) - middle.equilibrium).norm(), 1e3 * eps);
}

TEST_F(PaperPencil, BeyondTheMasterIsRefused) {
  EXPECT_THAT(message_of<std::invalid_argument>([] { at(0.1001); }),
              HasSubstr("contact 'contact' is beyond the end of its master at a drive displacement "
                        "of 0.0701 m"));
  EXPECT_THAT(message_of<std::invalid_argument>([] { at(-0.0001); }),
              HasSubstr("is beyond the end of its master"));
}

TEST_F(PaperPencil, SeventyModesWithResidualGiveTheSpectrumOfAll) {
  for (const double angle : {test::trailing_angle, test::leading_angle}) {
    const Pencil full = at(0.048, angle);
    Eigen::VectorXd sorted = full.omega;
    std::sort(sorted.begin(), sorted.end());
    const Pencil reduced = with_residual_modes(full, 0.5 * (sorted(69) + sorted(70)));
    EXPECT_EQ(reduced.num_modes(), 76);
    const auto window = SpectrumWindow::below(12e3);
    const auto expected = secular_eigenvalues(full, window);
    const auto found = secular_eigenvalues(reduced, window);
    ASSERT_EQ(found.size(), expected.size());
    for (std::size_t i = 0; i < found.size(); ++i) {
      // The static residual alone gives 1e-5 of |s| and 2 % of the growth.
      EXPECT_LT(std::abs(found[i].s - expected[i].s), 1e-6 * std::abs(expected[i].s));
      EXPECT_NEAR(found[i].growth(), expected[i].growth(), 1e-4 * std::abs(expected[i].growth()));
    }
  }
}

}  // namespace
}  // namespace stridor
