#include "substructures/bodies/lumped_body.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <cmath>
#include <numbers>

#include "core/errors.hpp"
#include "tests/support/message_of.hpp"

namespace stridor {
namespace {

using test::message_of;
using ::testing::ElementsAre;
using ::testing::HasSubstr;

/// The oscillator of Papangelo, Putignano and Hoffmann: two springs and an inclined one.
LumpedParameters oscillator(double inclined, double angle) {
  LumpedParameters body;
  body.masses["center"].mass = 2.0;
  body.springs["horizontal"] = {{"center"}, 50.0, 0.4, 0.0};
  body.springs["vertical"] = {{"center"}, 70.0, 0.4, std::numbers::pi / 2.0};
  body.springs["inclined"] = {{"center"}, inclined, 0.0, angle};
  return body;
}

TEST(LumpedBody, AddsItsSpringsAlongTheirDirections) {
  const double angle = 0.7;
  const BodyMatrices body = oscillator(30.0, angle).make();
  const double c = std::cos(angle);
  const double s = std::sin(angle);
  const Eigen::Matrix2d expected{{50.0 + 30.0 * c * c, 30.0 * s * c},
                                 {30.0 * s * c, 70.0 + 30.0 * s * s}};
  EXPECT_TRUE(Eigen::MatrixXd(body.stiffness).isApprox(expected, 1e-14));
  EXPECT_EQ(Eigen::MatrixXd(body.mass), Eigen::MatrixXd(2.0 * Eigen::Matrix2d::Identity()));
  EXPECT_EQ(body.points.at("center"), 0);
  EXPECT_FALSE(body.follows_drive());
}

TEST(LumpedBody, FindsProportionalDampingAndKeepsWhatIsNone) {
  // Equal dampers on equal masses are α M.
  const BodyMatrices proportional = oscillator(30.0, 0.7).make();
  EXPECT_NEAR(proportional.damping.alpha, 0.2, 1e-12);
  EXPECT_NEAR(proportional.damping.beta, 0.0, 1e-12);
  EXPECT_EQ(proportional.velocity.size(), 0);
  LumpedParameters given = oscillator(30.0, 0.7);
  given.springs["vertical"].damping = 0.1;
  given.damping.alpha = 3.0;
  const BodyMatrices coupled = given.make();
  EXPECT_TRUE(Eigen::MatrixXd(coupled.velocity)
                  .isApprox(Eigen::MatrixXd(Eigen::Vector2d(6.4, 6.1).asDiagonal()), 1e-14));
  EXPECT_EQ(coupled.circulatory.nonZeros(), 0);
}

TEST(LumpedBody, ChainHasTheFrequenciesOfItsClosedForm) {
  // n masses between two walls: ω_j = 2 (k/m)^½ sin(j π/(2 (n + 1))).
  constexpr int n = 5;
  LumpedParameters chain;
  chain.directions = {"x"};
  for (int i = 0; i < n; ++i) chain.masses["m" + std::to_string(i)] = {0.5, {0.1 * i, 0.0}};
  for (int i = 0; i + 1 < n; ++i)
    chain.springs["k" + std::to_string(i)] = {
        {"m" + std::to_string(i), "m" + std::to_string(i + 1)}, 200.0, 0.0, {}};
  chain.springs["left"] = {{"m0"}, 200.0, 0.0, {}};
  chain.springs["right"] = {{"m4"}, 200.0, 0.0, {}};
  const BodyMatrices body = chain.make();
  ASSERT_EQ(body.num_dofs(), n);
  EXPECT_EQ(body.node_dofs[3][1], BodyMatrices::held);
  const Eigen::GeneralizedSelfAdjointEigenSolver<Eigen::MatrixXd> modes(
      Eigen::MatrixXd(body.stiffness), Eigen::MatrixXd(body.mass));
  for (int j = 1; j <= n; ++j) {
    const double omega =
        2.0 * std::sqrt(200.0 / 0.5) * std::sin(j * std::numbers::pi / (2.0 * (n + 1)));
    EXPECT_NEAR(std::sqrt(modes.eigenvalues()(j - 1)), omega, 1e-12 * omega);
  }
}

TEST(LumpedBody, SpringBetweenMassesPointsFromOneToTheOther) {
  LumpedParameters body;
  body.masses["a"] = {1.0, {0.0, 0.0}};
  body.masses["b"] = {1.0, {3.0, 4.0}};
  body.springs["rod"] = {{"a", "b"}, 25.0, 0.0, {}};
  const Eigen::Vector2d d(0.6, 0.8);
  const Eigen::Matrix2d block = 25.0 * d * d.transpose();
  Eigen::Matrix4d expected;
  expected << block, -block, -block, block;
  EXPECT_TRUE(Eigen::MatrixXd(body.make().stiffness).isApprox(expected, 1e-14));
}

TEST(LumpedBody, TellsWhereItsSpringsAre) {
  LumpedParameters body;
  body.masses["a"] = {1.0, {0.0, 0.0}};
  body.masses["b"] = {1.0, {3.0, 4.0}};
  body.springs["down"] = {{"b"}, 25.0, 0.0, SpringDirectionParameters(-0.5 * std::numbers::pi)};
  body.springs["rod"] = {{"a", "b"}, 25.0, 0.0, {}};
  const std::vector<BodySpring> springs = body.make().springs;
  ASSERT_EQ(springs.size(), 2U);
  EXPECT_EQ(springs[0].at, Eigen::Vector3d(3.0, 4.0, 0.0));
  EXPECT_FALSE(springs[0].other);
  EXPECT_TRUE(springs[0].along.isApprox(Eigen::Vector3d(0.0, -1.0, 0.0), 1e-15));
  EXPECT_EQ(springs[1].at, Eigen::Vector3d(0.0, 0.0, 0.0));
  EXPECT_EQ(springs[1].other, Eigen::Vector3d(3.0, 4.0, 0.0));
}

TEST(LumpedBody, GuidedOneFollowsTheDriveWithAllItsMasses) {
  LumpedParameters body = oscillator(0.0, 0.0);
  body.masses["rider"].mass = 3.0;
  body.guided = "center";
  const BodyMatrices made = body.make();
  EXPECT_TRUE(made.follows_drive());
  EXPECT_EQ(made.load_dof, 1);
  EXPECT_EQ(made.base_inertia, Eigen::Vector4d(2.0, 0.0, 3.0, 0.0));
}

TEST(LumpedBody, MovesInSpace) {
  LumpedParameters body;
  body.directions = {"x", "z", "y"};
  body.masses["a"] = {2.0, {}};
  body.masses["b"] = {3.0, {0.3, 0.0, 0.4}};
  body.damping.beta = 1e-3;
  LumpedSpringParameters& ground = body.springs["ground"];
  ground.at = {"a"};
  ground.stiffness.xx = 4.0;
  ground.stiffness.yy = 9.0;
  ground.stiffness.zz = 7.0;
  ground.stiffness.xy = 5.0;
  ground.stiffness.zx = -1.0;
  body.springs["link"] = {{"a", "b"}, 10.0, {}, {}};
  const BodyMatrices made = body.make();
  ASSERT_EQ(made.num_dofs(), 6);
  EXPECT_EQ(made.node_dofs[0], (std::array{0, 1}));
  EXPECT_EQ(made.across, (std::vector{2, 5}));
  const Eigen::Vector3d d(0.6, 0.0, 0.8);
  const Eigen::Matrix3d link = 10.0 * d * d.transpose();
  Eigen::Matrix3d k;
  k << 4.0, 5.0, -1.0, 5.0, 9.0, 0.0, -1.0, 0.0, 7.0;
  Eigen::MatrixXd K(6, 6);
  K << k + link, -link, -link, link;
  EXPECT_LT((Eigen::MatrixXd(made.stiffness) - K).cwiseAbs().maxCoeff(), 1e-14);
  EXPECT_EQ(made.damping.beta, 1e-3);
  // The ground end of the spring, moved along x, y or z, carries the mass along.
  for (const std::size_t axis : {0, 1, 2}) {
    Eigen::Vector3d load = Eigen::Vector3d::Zero();
    for (const DofWeight& dof : made.loads.at(std::string("ground.") + "xyz"[axis]))
      load(dof.dof) += dof.weight;
    EXPECT_EQ(load, k.col(static_cast<Eigen::Index>(axis)));
  }
  EXPECT_FALSE(made.loads.contains("link.x"));  // it has no ground end
  EXPECT_EQ(made.load("b.z").value().front().dof, 5);
}

TEST(LumpedBody, SpringsActAlongVectors) {
  LumpedParameters body;
  body.directions = {"x", "y", "z"};
  body.masses["a"] = {2.0, {}};
  LumpedSpringParameters& spring = body.springs["s"];
  spring.at = {"a"};
  spring.stiffness = 50.0;
  spring.damping.emplace(4.0);
  spring.direction.emplace();
  spring.direction->vector = {0.0, 3.0, 4.0};
  const BodyMatrices made = body.make();
  const Eigen::Vector3d d(0.0, 0.6, 0.8);
  const Eigen::Matrix3d K = 50.0 * d * d.transpose();
  EXPECT_LT((Eigen::MatrixXd(made.stiffness) - K).cwiseAbs().maxCoeff(), 1e-14);
  // 4 d dᵀ is 0.08 K: proportional.
  EXPECT_NEAR(made.damping.beta, 0.08, 1e-15);
  body.directions = {"y"};
  EXPECT_NEAR(body.make().stiffness.coeff(0, 0), 18.0, 1e-13);
  std::vector<Problem> problems;
  spring.direction->vector = {0.0, 0.0};
  for (const auto& check : SpringDirectionParameters::schema().checks)
    check(&*spring.direction, problems);
  ASSERT_EQ(problems.size(), 1U);
  EXPECT_THAT(problems[0].message, HasSubstr("not all of them 0"));
}

TEST(LumpedBody, RefusesWhatIsNotThere) {
  LumpedParameters body = oscillator(0.0, 0.0);
  body.springs["vertical"].at = {"centre"};
  EXPECT_THAT(message_of<ConfigError>([&] { body.make(); }),
              HasSubstr("springs.vertical.at: there is no mass 'centre', did you mean 'center'?"));
  body = oscillator(0.0, 0.0);
  body.springs["vertical"].at = {"center", "center"};
  EXPECT_THAT(message_of<ConfigError>([&] { body.make(); }),
              HasSubstr("springs.vertical.at: must be two different masses"));
  body = oscillator(0.0, 0.0);
  body.masses["rider"].mass = 3.0;
  body.springs["vertical"] = {{"center", "rider"}, 1.0, 0.0, {}};
  EXPECT_THAT(message_of<ConfigError>([&] { body.make(); }),
              HasSubstr("springs.vertical.direction: missing: the two masses stand at one place"));
  body = oscillator(0.0, 0.0);
  body.directions = {"x"};
  body.guided = "center";
  EXPECT_THAT(message_of<ConfigError>([&] { body.make(); }),
              HasSubstr("guided: needs a mass that moves in y"));
  std::vector<Problem> problems;
  body.directions = {"x", "x", "w"};
  for (const auto& check : LumpedParameters::schema().checks) check(&body, problems);
  std::vector<std::string> keys;
  for (const Problem& problem : problems) keys.push_back(problem.key);
  EXPECT_THAT(keys, ElementsAre("directions.1", "directions.2"));
}

TEST(Substructure, IsCopiedWithWhatItHolds) {
  Substructure one = oscillator(1.0, 0.0);
  Substructure other = one;
  other.get<LumpedParameters>().masses["center"].mass = 9.0;
  EXPECT_EQ(one.get<LumpedParameters>().masses["center"].mass, 2.0);
  EXPECT_STREQ(one->type(), "lumped");
  EXPECT_EQ(Substructure::types()[one.type_index()].name, "lumped");
}

TEST(Substructure, EveryTypeIsRegisteredUnderItsOwnName) {
  for (const Substructure::Type& type : Substructure::types()) {
    Substructure made;
    const void* keys = type.emplace(made);
    EXPECT_EQ(type.name, made->type());
    EXPECT_EQ(keys, made.object());
    EXPECT_EQ(&type.schema(), &made->keys());
  }
}

}  // namespace
}  // namespace stridor
