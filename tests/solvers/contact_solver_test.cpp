#include "solvers/contact/contact_solver.hpp"
#include "tests/support/constants.hpp"

#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <cmath>
#include <limits>
#include <random>
#include <vector>

namespace stridor {
namespace {

using test::eps;
constexpr double nan = std::numeric_limits<double>::quiet_NaN();

/// What the solver is given, and what follows from its forces.
struct Case {
  Eigen::MatrixXd delassus;
  std::vector<LocalProblem> contacts;

  int size() const { return static_cast<int>(contacts.size()); }
  LocalProblem& operator[](int i) { return contacts[static_cast<std::size_t>(i)]; }
  const LocalProblem& operator[](int i) const { return contacts[static_cast<std::size_t>(i)]; }

  ContactAnswer solve(ContactSolverParameters parameters = {}) {
    ContactSolver solver(size(), parameters);
    solver.delassus() = delassus;
    return solver.solve(contacts);
  }

  Eigen::VectorXd forces() const {
    Eigen::VectorXd result(2 * size());
    for (int i = 0; i < size(); ++i)
      result.segment(2 * i, 2) << (*this)[i].normal, (*this)[i].tangential;
    return result;
  }
  /// Penetration and slip of every contact at the end of the step.
  Eigen::VectorXd remaining() const {
    Eigen::VectorXd free(2 * size());
    for (int i = 0; i < size(); ++i)
      free.segment(2 * i, 2) << (*this)[i].penetration, (*this)[i].slip;
    return free - delassus * forces();
  }
};

/// Random numbers that are the same in every run.
class Draw {
 public:
  explicit Draw(unsigned seed) : generator_(seed) {}
  double uniform(double low, double high) {
    return std::uniform_real_distribution<double>(low, high)(generator_);
  }
  double normal() { return std::normal_distribution<double>()(generator_); }

  /// Symmetric positive definite with eigenvalues of order 1: every principal minor is positive.
  Eigen::MatrixXd compliance(int n) {
    Eigen::MatrixXd a(2 * n, 2 * n);
    for (double& entry : a.reshaped()) entry = normal();
    return a * a.transpose() / (2.0 * n) + Eigen::MatrixXd::Identity(2 * n, 2 * n);
  }

  Case unilateral(int n, double largest_friction) {
    Case result{compliance(n), std::vector<LocalProblem>(static_cast<std::size_t>(n))};
    for (LocalProblem& contact : result.contacts) {
      contact.is_unilateral = true;
      contact.penetration = normal();
      contact.slip = normal();
      contact.sliding_friction = contact.sticking_friction = uniform(0.0, largest_friction);
    }
    return result;
  }

  Case bilateral(int n, double largest_friction) {
    Case result = unilateral(n, largest_friction);
    for (LocalProblem& contact : result.contacts) {
      contact.is_unilateral = false;
      contact.direction = normal() < 0.0 ? -1.0 : 1.0;
    }
    return result;
  }

 private:
  std::mt19937 generator_;
};

/// The last sweep of forces of order 1 moved none by more than 1e-12; with a contraction of 0.9 or
/// better per sweep they are within 1e-11 of the answer, times compliances of order 10.
constexpr double settled = 1e-10;

/// Gap, Coulomb's cone and the sense of friction, contact by contact.
void expect_laws_hold(const Case& answer) {
  const Eigen::VectorXd remaining = answer.remaining();
  for (int i = 0; i < answer.size(); ++i) {
    const LocalProblem& contact = answer[i];
    const double penetration = remaining(2 * i);
    const double slip = remaining(2 * i + 1);
    const double limit = contact.sliding_friction * contact.normal;
    switch (contact.state) {
      case ContactState::open:
        EXPECT_EQ(contact.normal, 0.0) << i;
        EXPECT_EQ(contact.tangential, 0.0) << i;
        EXPECT_LE(penetration, settled) << i;
        break;
      case ContactState::stick:
        EXPECT_GT(contact.normal, 0.0) << i;
        EXPECT_NEAR(penetration, 0.0, settled) << i;
        EXPECT_NEAR(slip, 0.0, settled) << i;
        EXPECT_LE(std::abs(contact.tangential), contact.sticking_friction * contact.normal) << i;
        break;
      case ContactState::slip:
        EXPECT_GT(contact.normal, 0.0) << i;
        EXPECT_NEAR(penetration, 0.0, settled) << i;
        EXPECT_NEAR(std::abs(contact.tangential), limit, 2.0 * eps * limit) << i;
        EXPECT_GE(contact.tangential * slip, -settled) << i;
        break;
    }
  }
}

TEST(ContactSolver, RandomContactsObeyTheLaws) {
  Draw draw(20240611);
  int num_open = 0;
  int num_stick = 0;
  int num_slip = 0;
  for (const int n : {1, 2, 3, 8, 20}) {
    for (int trial = 0; trial < 50; ++trial) {
      Case problem = draw.unilateral(n, 0.8);
      ASSERT_EQ(problem.solve().status, ContactStatus::converged) << n << ' ' << trial;
      expect_laws_hold(problem);
      for (const LocalProblem& contact : problem.contacts) {
        num_open += contact.state == ContactState::open;
        num_stick += contact.state == ContactState::stick;
        num_slip += contact.state == ContactState::slip;
      }
    }
  }
  // 1700 contacts, and every state among them.
  EXPECT_GT(num_open, 300);
  EXPECT_GT(num_stick, 100);
  EXPECT_GT(num_slip, 300);
}

/// Two forces that give penetration 1 and slip s by hand: W = [[2, 1/2], [1/2, 1]], det W = 7/4.
Case by_hand(double penetration, double slip, double sliding, double sticking) {
  Case problem{Eigen::Matrix2d{{2.0, 0.5}, {0.5, 1.0}}, std::vector<LocalProblem>(1)};
  problem[0].is_unilateral = true;
  problem[0].penetration = penetration;
  problem[0].slip = slip;
  problem[0].sliding_friction = sliding;
  problem[0].sticking_friction = sticking;
  return problem;
}

void expect_single(Case problem, ContactState state, double normal, double tangential) {
  const ContactAnswer answer = problem.solve();
  EXPECT_EQ(answer.status, ContactStatus::converged);
  EXPECT_EQ(answer.sweeps, 1);
  EXPECT_EQ(problem[0].state, state);
  // A handful of operations on numbers of order 1.
  EXPECT_NEAR(problem[0].normal, normal, 8.0 * eps);
  EXPECT_NEAR(problem[0].tangential, tangential, 8.0 * eps);
}

TEST(ContactSolver, OneContactEqualsTheFormula) {
  // Stick: W λ = (1, 0.2), so λ = (0.9, −0.1)/1.75.
  expect_single(by_hand(1.0, 0.2, 0.3, 0.3), ContactState::stick, 0.9 / 1.75, -0.1 / 1.75);
  // Slip forwards: λ_n = 1/(2 + 0.3 / 2), λ_t = 0.3 λ_n; backwards with −0.3.
  expect_single(by_hand(1.0, 2.0, 0.3, 0.3), ContactState::slip, 1.0 / 2.15, 0.3 / 2.15);
  expect_single(by_hand(1.0, -2.0, 0.3, 0.3), ContactState::slip, 1.0 / 1.85, -0.3 / 1.85);
  // Without penetration there is no force, whatever the slip.
  expect_single(by_hand(-0.1, 2.0, 0.3, 0.3), ContactState::open, 0.0, 0.0);
  expect_single(by_hand(0.0, 2.0, 0.3, 0.3), ContactState::open, 0.0, 0.0);
  // Without friction: λ_n = 1/2.
  expect_single(by_hand(1.0, 2.0, 0.0, 0.0), ContactState::slip, 0.5, 0.0);
}

TEST(ContactSolver, AContactSticksUpToItsStaticFrictionAndSlidesWithTheOther) {
  // Sticking takes λ_t/λ_n = (2 s − 0.5)/(1 − 0.5 s): 0.4375 for s = 0.42, 0.5094 for s = 0.45.
  const double normal = (1.0 - 0.5 * 0.42) / 1.75;
  const double tangential = (2.0 * 0.42 - 0.5) / 1.75;
  expect_single(by_hand(1.0, 0.42, 0.3, 0.5), ContactState::stick, normal, tangential);
  expect_single(by_hand(1.0, 0.45, 0.3, 0.5), ContactState::slip, 1.0 / 2.15, 0.3 / 2.15);
}

TEST(ContactSolver, OneBilateralContactTakesAForceOfEitherSign) {
  for (const double penetration : {1.0, -1.0}) {
    for (const double direction : {1.0, -1.0}) {
      Case problem = by_hand(penetration, 5.0, 0.3, 0.3);
      problem[0].is_unilateral = false;
      problem[0].direction = direction;
      const double normal = penetration / (2.0 + direction * 0.15);
      expect_single(problem, ContactState::slip, normal, direction * 0.3 * normal);
    }
  }
}

TEST(ContactSolver, BilateralContactsSolveTheDenseSystem) {
  // λ_t = χ μ λ_n for all: (B_C W B_Eᵀ) λ_n = penetration.
  Draw draw(7);
  for (const int n : {2, 5, 12}) {
    Case problem = draw.bilateral(n, 0.5);
    Eigen::MatrixXd operator_(n, n);
    Eigen::VectorXd right(n);
    for (int i = 0; i < n; ++i) {
      right(i) = problem[i].penetration;
      for (int j = 0; j < n; ++j) {
        operator_(i, j) = problem.delassus(2 * i, 2 * j) + problem[j].direction *
                                                               problem[j].sliding_friction *
                                                               problem.delassus(2 * i, 2 * j + 1);
      }
    }
    const Eigen::VectorXd expected = operator_.fullPivLu().solve(right);
    ASSERT_EQ(problem.solve().status, ContactStatus::converged);
    for (int i = 0; i < n; ++i) {
      // Two factorisations of matrices with condition numbers of order 10.
      EXPECT_NEAR(problem[i].normal, expected(i), 1e-12);
      EXPECT_EQ(problem[i].tangential,
                problem[i].direction * problem[i].sliding_friction * problem[i].normal);
      EXPECT_EQ(problem[i].state, ContactState::slip);
    }
  }
}

TEST(ContactSolver, BilateralAndUnilateralContactsMix) {
  Draw draw(11);
  for (int trial = 0; trial < 20; ++trial) {
    Case problem = draw.unilateral(6, 0.5);
    problem[1].is_unilateral = problem[4].is_unilateral = false;
    problem[4].direction = -1.0;
    ASSERT_EQ(problem.solve().status, ContactStatus::converged);
    const Eigen::VectorXd remaining = problem.remaining();
    for (const int i : {1, 4}) {
      EXPECT_NEAR(remaining(2 * i), 0.0, settled);
      EXPECT_EQ(problem[i].tangential,
                problem[i].direction * problem[i].sliding_friction * problem[i].normal);
    }
    for (const int i : {0, 2, 3, 5}) {
      EXPECT_GE(problem[i].normal, 0.0);
      EXPECT_LE(remaining(2 * i), settled);
      EXPECT_NEAR(problem[i].normal * remaining(2 * i), 0.0, settled);
    }
  }
}

TEST(ContactSolver, TheGuessDoesNotChangeTheAnswer) {
  Draw draw(13);
  for (int trial = 0; trial < 20; ++trial) {
    Case cold = draw.unilateral(10, 0.5);
    Case warm = cold;
    for (LocalProblem& contact : warm.contacts) {
      contact.normal = draw.uniform(0.0, 10.0);
      contact.tangential = draw.normal();
      contact.state = ContactState::stick;
    }
    ASSERT_EQ(cold.solve().status, ContactStatus::converged);
    ASSERT_EQ(warm.solve().status, ContactStatus::converged);
    EXPECT_LT((warm.forces() - cold.forces()).cwiseAbs().maxCoeff(), settled);
    // From its own answer it stops at once: one sweep, at most one more where that one rounds.
    EXPECT_LE(cold.solve().sweeps, 2);
  }
}

TEST(ContactSolver, TheOrderOfTheContactsDoesNotMatter) {
  Draw draw(17);
  for (int trial = 0; trial < 20; ++trial) {
    constexpr int n = 10;
    Case problem = draw.unilateral(n, 0.5);
    Case reversed = problem;
    const auto other = [](int i) { return n - 1 - i; };
    for (int i = 0; i < n; ++i) {
      reversed[other(i)] = problem[i];
      for (int j = 0; j < n; ++j)
        reversed.delassus.block(2 * other(i), 2 * other(j), 2, 2) =
            problem.delassus.block(2 * i, 2 * j, 2, 2);
    }
    ASSERT_EQ(problem.solve().status, ContactStatus::converged);
    ASSERT_EQ(reversed.solve().status, ContactStatus::converged);
    for (int i = 0; i < n; ++i) {
      EXPECT_NEAR(reversed[other(i)].normal, problem[i].normal, settled);
      EXPECT_NEAR(reversed[other(i)].tangential, problem[i].tangential, settled);
      EXPECT_EQ(reversed[other(i)].state, problem[i].state);
    }
  }
}

/// W_nt = −2 turns friction along +t into an approach: W_nn + χ μ W_nt = 1 − 2 χ μ.
Case painleve(double slip, double friction) {
  Case problem{Eigen::Matrix2d{{1.0, -2.0}, {-2.0, 5.0}}, std::vector<LocalProblem>(1)};
  problem[0].is_unilateral = true;
  problem[0].penetration = 1.0;
  problem[0].slip = slip;
  problem[0].sliding_friction = problem[0].sticking_friction = friction;
  return problem;
}

TEST(ContactSolver, BilateralSlidingJamsExactlyWhereFrictionTurnsTheForceIntoAnApproach) {
  for (const double friction : {0.5, 0.6}) {
    Case problem = painleve(10.0, friction);
    problem[0].is_unilateral = false;
    problem[0].direction = 1.0;
    EXPECT_EQ(problem.solve().status, ContactStatus::jammed) << friction;
    problem[0].direction = -1.0;
    EXPECT_EQ(problem.solve().status, ContactStatus::converged) << friction;
  }
  Case below = painleve(10.0, 0.49);
  below[0].is_unilateral = false;
  EXPECT_EQ(below.solve().status, ContactStatus::converged);
  EXPECT_NEAR(below[0].normal, 1.0 / 0.02, 50.0 * 50.0 * eps);  // 1 − 0.98, divided by
}

TEST(ContactSolver, AUnilateralContactSticksWhereSlidingWouldJam) {
  // With W positive definite the stick trial lies in the cone whenever W_nn + χ μ W_nt ≤ 0: from
  // λ_t > μ λ_n would follow a negative penetration.
  Case sticking = painleve(10.0, 0.6);
  ASSERT_EQ(sticking.solve().status, ContactStatus::converged);
  EXPECT_EQ(sticking[0].state, ContactState::stick);
  EXPECT_NEAR(sticking[0].normal, 25.0, 200.0 * eps);      // (5 + 2 · 10)/det, det = 1
  EXPECT_NEAR(sticking[0].tangential, 12.0, 200.0 * eps);  // (10 + 2)/det
  Draw draw(31);
  for (int trial = 0; trial < 2000; ++trial) {
    Case problem = draw.unilateral(1, 20.0);
    problem.delassus = draw.compliance(1);
    problem.delassus(0, 1) = problem.delassus(1, 0) =
        draw.uniform(-0.95, 0.95) * std::sqrt(problem.delassus(0, 0) * problem.delassus(1, 1));
    ASSERT_EQ(problem.solve().status, ContactStatus::converged) << trial;
    expect_laws_hold(problem);
  }
}

TEST(ContactSolver, TheContactThatJamsIsNamed) {
  Case problem{Eigen::MatrixXd::Identity(6, 6), std::vector<LocalProblem>(3)};
  for (LocalProblem& contact : problem.contacts) contact.penetration = 1.0;
  const Case jam = painleve(10.0, 0.6);
  problem.delassus.block(2, 2, 2, 2) = jam.delassus;
  problem[1] = jam[0];
  for (const bool is_mixed : {false, true}) {
    problem[1].is_unilateral = false;
    problem[2].is_unilateral = is_mixed;
    const ContactAnswer answer = problem.solve();
    EXPECT_EQ(answer.status, ContactStatus::jammed);
    EXPECT_EQ(answer.contact, 1);
  }
}

TEST(ContactSolver, ContactsThatJamTogetherAreFound) {
  // Each alone is free, W_nn = 1 and W_nt = 0, but the friction of one pushes the other back:
  // B_C W B_Eᵀ = [[1, a], [a, 1]] has lost its positive determinant for a > 1.
  const auto coupled = [](double a) {
    Case problem{Eigen::MatrixXd::Identity(4, 4), std::vector<LocalProblem>(2)};
    problem.delassus(1, 1) = problem.delassus(3, 3) = 10.0;
    problem.delassus(0, 3) = problem.delassus(3, 0) = a;
    problem.delassus(2, 1) = problem.delassus(1, 2) = a;
    for (LocalProblem& contact : problem.contacts) {
      contact.penetration = 1.0;
      contact.sliding_friction = 1.0;
    }
    return problem;
  };
  EXPECT_EQ(coupled(0.99).solve().status, ContactStatus::converged);
  EXPECT_EQ(coupled(1.01).solve().status, ContactStatus::jammed);
}

/// n bilateral contacts whose sliding operator is S: unit compliances, friction makes the rest.
Case with_sliding_operator(const Eigen::MatrixXd& S) {
  const Eigen::Index n = S.rows();
  Case problem{Eigen::MatrixXd::Zero(2 * n, 2 * n),
               std::vector<LocalProblem>(static_cast<std::size_t>(n))};
  for (Eigen::Index i = 0; i < n; ++i) {
    problem.delassus(2 * i, 2 * i) = 1.0;
    problem.delassus(2 * i + 1, 2 * i + 1) = 100.0;
    for (Eigen::Index j = 0; j < n; ++j)
      problem.delassus(2 * i, 2 * j + 1) = S(i, j) - (i == j ? 1.0 : 0.0);
  }
  for (LocalProblem& contact : problem.contacts) {
    contact.penetration = 1.0;
    contact.sliding_friction = 1.0;
  }
  return problem;
}

/// All principal minors by determinants.
bool is_free_of_jamming(const Eigen::MatrixXd& S) {
  for (unsigned set = 1; set < (1u << S.rows()); ++set) {
    std::vector<Eigen::Index> members;
    for (Eigen::Index i = 0; i < S.rows(); ++i)
      if ((set >> i) & 1u) members.push_back(i);
    if (!(Eigen::MatrixXd(S(members, members)).determinant() > 0.0)) return false;
  }
  return true;
}

TEST(ContactSolver, PairsThatJamApartFromEachOtherAreFound) {
  // Two pairs without a common body, each [[1, 1.2], [1.2, 1]]: their determinants cancel in sign.
  const Eigen::Matrix2d pair{{1.0, 1.2}, {1.2, 1.0}};
  Eigen::MatrixXd S = Eigen::MatrixXd::Zero(4, 4);
  for (const Eigen::Index i : {Eigen::Index{0}, Eigen::Index{1}}) {
    S.setZero();
    // Side by side, and interleaved.
    const std::vector<Eigen::Index> first =
        i == 0 ? std::vector<Eigen::Index>{0, 1} : std::vector<Eigen::Index>{0, 2};
    const std::vector<Eigen::Index> second =
        i == 0 ? std::vector<Eigen::Index>{2, 3} : std::vector<Eigen::Index>{1, 3};
    S(first, first) = pair;
    S(second, second) = pair;
    ASSERT_GT(S.determinant(), 0.0);
    EXPECT_EQ(with_sliding_operator(S).solve().status, ContactStatus::jammed);
    S(second, second) = 0.5 * pair + 0.5 * Eigen::Matrix2d::Identity();
    EXPECT_EQ(with_sliding_operator(S).solve().status, ContactStatus::jammed);
    S(first, first) = S(second, second);
    EXPECT_EQ(with_sliding_operator(S).solve().status, ContactStatus::converged);
  }
}

TEST(ContactSolver, BilateralContactsJamExactlyWhereAPrincipalMinorIsNotPositive) {
  Draw draw(41);
  int num_jammed = 0;
  int missed_by_determinant = 0;
  for (int trial = 0; trial < 2000; ++trial) {
    const Eigen::Index n = 2 + trial % 6;
    Eigen::MatrixXd S(n, n);
    for (double& entry : S.reshaped())
      entry = 1.2 * draw.normal() / std::sqrt(static_cast<double>(n));
    S.diagonal().setOnes();
    // Some act on few others only.
    if (trial % 3 == 0) S.topRightCorner(n / 2, n - n / 2).setZero();
    if (trial % 3 == 0) S.bottomLeftCorner(n - n / 2, n / 2).setZero();
    const bool is_free = is_free_of_jamming(S);
    num_jammed += is_free ? 0 : 1;
    missed_by_determinant += !is_free && S.determinant() > 0.0 ? 1 : 0;
    ASSERT_EQ(with_sliding_operator(S).solve().status,
              is_free ? ContactStatus::converged : ContactStatus::jammed)
        << trial << '\n'
        << S;
  }
  EXPECT_GT(num_jammed, 300);
  EXPECT_LT(num_jammed, 1700);
  EXPECT_GT(missed_by_determinant, 100);
}

TEST(ContactSolver, GroupsOfManyContactsAreTestedInPart) {
  // Thirteen in a row: one pair jams, and the last entry with a leading minor.
  Eigen::MatrixXd S = Eigen::MatrixXd::Identity(13, 13);
  S.diagonal(1).setConstant(0.1);
  S.diagonal(-1).setConstant(0.1);
  EXPECT_EQ(with_sliding_operator(S).solve().status, ContactStatus::converged);
  Eigen::MatrixXd pair = S;
  pair(7, 8) = pair(8, 7) = 1.1;
  EXPECT_EQ(with_sliding_operator(pair).solve().status, ContactStatus::jammed);
  // Three that jam by turns, no two of them: the determinant is 1 − 2³ and a little.
  Eigen::MatrixXd three = S;
  three(0, 1) = three(1, 2) = three(2, 0) = -2.0;
  three(1, 0) = three(2, 1) = three(0, 2) = 0.0;
  EXPECT_EQ(with_sliding_operator(three).solve().status, ContactStatus::jammed);
}

TEST(ContactSolver, WithoutPenetrationNoForceIsTakenWhereOthersWouldDo) {
  // Sticking would do as well: λ = W⁻¹ (−0.1, 10) = (19.5, 9.8), within the cone.
  Case problem = painleve(10.0, 0.6);
  problem[0].penetration = -0.1;
  const Eigen::Vector2d stick = problem.delassus.inverse() * Eigen::Vector2d(-0.1, 10.0);
  ASSERT_GT(stick(0), 0.0);
  ASSERT_LT(std::abs(stick(1)), 0.6 * stick(0));
  ASSERT_EQ(problem.solve().status, ContactStatus::converged);
  EXPECT_EQ(problem[0].state, ContactState::open);
  EXPECT_EQ(problem[0].normal, 0.0);
  EXPECT_EQ(problem[0].tangential, 0.0);
}

TEST(ContactSolver, ManyStiffContactsNeitherUnderflowNorJam) {
  // The determinant of 200 compliances of 1e-12 m/N is 1e-2400.
  Draw draw(19);
  constexpr int n = 200;
  Case problem{1e-12 * draw.compliance(n), std::vector<LocalProblem>(n)};
  Eigen::VectorXd penetration(n);
  Eigen::MatrixXd normals(n, n);
  for (int i = 0; i < n; ++i) {
    penetration(i) = problem[i].penetration = 1e-12 * draw.normal();
    for (int j = 0; j < n; ++j) normals(i, j) = problem.delassus(2 * i, 2 * j);
  }
  const Eigen::VectorXd expected = normals.llt().solve(penetration);
  ASSERT_EQ(problem.solve().status, ContactStatus::converged);
  for (int i = 0; i < n; ++i) EXPECT_NEAR(problem[i].normal, expected(i), 1e-11);
  for (LocalProblem& contact : problem.contacts) contact.is_unilateral = true;
  ASSERT_EQ(problem.solve().status, ContactStatus::converged);
}

TEST(ContactSolver, RunningOutOfSweepsIsReturnedWithTheContact) {
  // Contacts 2 and 3 push each other, 0 and 1 stand alone and are right after the first sweep.
  Case problem{Eigen::MatrixXd::Identity(8, 8), std::vector<LocalProblem>(4)};
  problem.delassus(4, 6) = problem.delassus(6, 4) = 0.9;
  for (LocalProblem& contact : problem.contacts) {
    contact.is_unilateral = true;
    contact.penetration = 1.0;
  }
  Case given = problem;
  const ContactAnswer answer = problem.solve({1e-12, 3});
  EXPECT_EQ(answer.status, ContactStatus::not_converged);
  EXPECT_EQ(answer.sweeps, 3);
  EXPECT_GE(answer.contact, 2);
  // With sweeps enough it settles: both carry 1/1.9.
  const ContactAnswer patient = given.solve();
  EXPECT_EQ(patient.status, ContactStatus::converged);
  EXPECT_GT(patient.sweeps, 3);
  EXPECT_NEAR(given[3].normal, 1.0 / 1.9, settled);
}

TEST(ContactSolver, AProblemThatCyclesIsNotCalledSettled) {
  // W of a real step is positive definite. On [[1, 3], [−3, 1]] a sweep multiplies the error of the
  // second force by −9 until λ_n ≥ 0 throws it back, though there is an answer, (0.1, 1.3).
  Case problem{Eigen::MatrixXd::Identity(4, 4), std::vector<LocalProblem>(2)};
  problem.delassus(0, 2) = 3.0;
  problem.delassus(2, 0) = -3.0;
  for (LocalProblem& contact : problem.contacts) {
    contact.is_unilateral = true;
    contact.penetration = 1.0;
  }
  problem[0].penetration = 4.0;
  EXPECT_EQ(problem.solve().status, ContactStatus::not_converged);
}

TEST(ContactSolver, NotANumberIsNeverAFiniteAnswer) {
  for (const int n : {1, 4}) {
    for (const bool is_unilateral : {true, false}) {
      Draw draw(23);
      Case problem = draw.unilateral(n, 0.3);
      for (LocalProblem& contact : problem.contacts) contact.is_unilateral = is_unilateral;
      problem[n - 1].penetration = nan;
      const ContactAnswer answer = problem.solve();
      EXPECT_TRUE(answer.status != ContactStatus::converged || !problem.forces().allFinite())
          << n << ' ' << is_unilateral;
      if (is_unilateral) {
        EXPECT_EQ(answer.contact, n - 1);
      }
    }
  }
}

TEST(ContactSolver, ContactsThatDoNotTouchTakeOneSweep) {
  Draw draw(29);
  Case problem = draw.unilateral(5, 0.3);
  for (LocalProblem& contact : problem.contacts) contact.penetration = -1.0;
  const ContactAnswer answer = problem.solve();
  EXPECT_EQ(answer.status, ContactStatus::converged);
  EXPECT_EQ(answer.sweeps, 1);
  EXPECT_EQ(problem.forces().norm(), 0.0);
}

}  // namespace
}  // namespace stridor
