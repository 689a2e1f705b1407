#include "solvers/face_contact_solver.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

namespace stridor {
namespace {

/// Contacts on bodies of random compliance, normals and tangents coupled.
class LinearAnswer : public FaceContactAnswer {
 public:
  LinearAnswer(int num_contacts, unsigned seed) : generator_(seed) {
    const int size = 3 * num_contacts;
    const Eigen::MatrixXd rows = Eigen::MatrixXd::NullaryExpr(size, 2 * size, [&] { return one(); });
    Eigen::MatrixXd flexibility = rows * rows.transpose() / (2.0 * size);
    flexibility.diagonal().array() += 0.3;
    compliance_ = flexibility;
    // Forces on the pad slow the face's velocity against it down.
    for (int k = 0; k < size; k += 3) compliance_.middleRows<2>(k + 1) *= -1.0;
    free_.setZero(size);
  }

  void move() {
    for (Eigen::Index k = 0; k < free_.size(); k += 3)
      free_.segment<3>(k) << one() - 0.5, 0.6 * one(), 0.6 * one();
  }
  /// A little.
  void drift() {
    for (double& value : free_) value += 1e-3 * one();
  }
  double see(const double* forces, double* seen) override {
    ++num_seen;
    Eigen::Map<Eigen::VectorXd>(seen, free_.size()) =
        free_ + compliance_ * Eigen::Map<const Eigen::VectorXd>(forces, free_.size());
    return 0.0;
  }
  const Compliance& compliance() const override { return compliance_; }

  int num_seen = 0;

 private:
  double one() { return std::uniform_real_distribution<double>(-1.0, 1.0)(generator_); }

  std::mt19937 generator_;
  Compliance compliance_;
  Eigen::VectorXd free_;
};

/// Laws of rigid contacts with friction 0.4.
void expect_laws(LinearAnswer& answer, const Eigen::VectorXd& forces, int seen[3]) {
  Eigen::VectorXd sees(forces.size());
  answer.see(forces.data(), sees.data());
  for (Eigen::Index k = 0; k < forces.size(); k += 3) {
    const double limit = 0.4 * forces(k);
    const Eigen::Vector2d friction = forces.segment<2>(k + 1), velocity = sees.segment<2>(k + 1);
    ASSERT_GE(forces(k), 0.0);
    ASSERT_GE(sees(k), -1e-11);
    ASSERT_NEAR(forces(k) * sees(k), 0.0, 1e-11);
    ASSERT_LE(friction.norm(), limit + 1e-11);
    ASSERT_NEAR((limit * velocity - velocity.norm() * friction).norm(), 0.0, 1e-11);
    ++seen[!(forces(k) > 0.0) ? 0 : velocity.norm() > 1e-9 ? 1 : 2];
  }
}

TEST(FaceContactSolver, FindsForcesThatKeepTheLaws) {
  int seen[3] = {0, 0, 0};
  for (unsigned seed = 1; seed <= 200; ++seed) {
    LinearAnswer answer(1 + static_cast<int>(seed % 10), seed);
    FaceContactSolver solver({0.4, std::nullopt, 1.0, true, false}, 1.0);
    answer.move();
    Eigen::VectorXd forces = Eigen::VectorXd::Zero(answer.compliance().rows());
    ASSERT_TRUE(solver.solve(answer, forces)) << seed;
    expect_laws(answer, forces, seen);
  }
  for (const int count : seen) EXPECT_GT(count, 50);
}

TEST(FaceContactSolver, WhatIsKeptChangesNoAnswerAndSavesIterations) {
  const FaceContactLaw law{0.4, std::nullopt, 1.0, true, false};
  int kept_seen = 0, fresh_seen = 0;
  for (unsigned seed = 1; seed <= 20; ++seed) {
    LinearAnswer answer(6, seed);
    FaceContactSolver kept(law, 1.0);
    answer.move();
    Eigen::VectorXd forces = Eigen::VectorXd::Zero(18);
    ASSERT_TRUE(kept.solve(answer, forces));
    for (int i = 0; i < 50; ++i) {
      answer.drift();
      answer.num_seen = 0;
      ASSERT_TRUE(kept.solve(answer, forces));
      kept_seen += answer.num_seen;
      Eigen::VectorXd fresh = Eigen::VectorXd::Zero(18);
      answer.num_seen = 0;
      ASSERT_TRUE(FaceContactSolver(law, 1.0).solve(answer, fresh));
      fresh_seen += answer.num_seen;
      ASSERT_LT((forces - fresh).norm(), 1e-10 * (1.0 + fresh.norm())) << seed << ' ' << i;
    }
  }
  EXPECT_LT(kept_seen, fresh_seen);
}

TEST(FaceContactSolver, GoesOnBitwiseFromItsState) {
  const FaceContactLaw law{0.4, std::nullopt, 1.0, true, false};
  LinearAnswer answer(5, 3);
  FaceContactSolver first(law, 1.0), second(law, 1.0);
  answer.move();
  Eigen::VectorXd forces = Eigen::VectorXd::Zero(15);
  ASSERT_TRUE(first.solve(answer, forces));
  State state;
  first.save(state, "solver/");
  second.load(state, "solver/");
  Eigen::VectorXd again = forces;
  for (int i = 0; i < 20; ++i) {
    answer.drift();
    ASSERT_TRUE(first.solve(answer, forces));
    ASSERT_TRUE(second.solve(answer, again));
    ASSERT_EQ(forces, again);
  }
}

}  // namespace
}  // namespace stridor
