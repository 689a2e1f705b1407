// Bodies given by their modes.
#include "substructures/bodies/modes_body.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <array>
#include <cmath>
#include <memory>
#include <numbers>
#include <vector>

#include "core/errors.hpp"
#include "substructures/bodies/realised_shape.hpp"
#include "tests/support/message_of.hpp"

namespace stridor {
namespace {

using namespace test;
using ::testing::AllOf;
using ::testing::HasSubstr;

constexpr double two_pi = 2.0 * std::numbers::pi;

/// A displacement as a row over the coordinates of a body.
Eigen::RowVectorXd row_of(const BodyMatrices& body, const std::string& port, std::size_t direction) {
  Eigen::RowVectorXd row = Eigen::RowVectorXd::Zero(body.num_dofs());
  for (const DofWeight& dof : body.displacement(body.points.at(port), direction))
    row(dof.dof) += dof.weight;
  return row;
}

ModesBodyParameters two_modes() {
  ModesBodyParameters body;
  body.frequencies = {100.0, 250.0};
  body.damping_ratios = {0.01, 0.03};
  body.modal_masses = {4.0, 9.0};
  body.ports["tip"] = {{0.1, 0.02}, std::nullopt, {}, {2.0, -3.0}, {}};
  body.ports["side"] = {{0.0, 0.0}, std::nullopt, {1.0, 0.0}, {0.0, 6.0}, {}};
  return body;
}

TEST(ModesBody, ShapesAreNormalisedToTheModalMasses) {
  const BodyMatrices body = two_modes().make();
  EXPECT_TRUE(body.is_modal);
  EXPECT_EQ(body.num_dofs(), 2);
  EXPECT_EQ(row_of(body, "tip", 1), Eigen::RowVector2d(1.0, -1.0));
  EXPECT_EQ(row_of(body, "side", 0), Eigen::RowVector2d(0.5, 0.0));
  EXPECT_EQ(row_of(body, "side", 1), Eigen::RowVector2d(0.0, 2.0));
  EXPECT_FALSE(body.moves(body.points.at("tip"), 0));
  const Eigen::Vector2d omega = two_pi * Eigen::Vector2d(100.0, 250.0);
  EXPECT_NEAR(body.stiffness.coeff(1, 1), omega(1) * omega(1), 1e-9 * omega(1) * omega(1));
  // Whatever form the damping takes, two modes have two ratios: α + β ω² = 2 ζ ω.
  const auto rate = [&](Eigen::Index i) {
    const double coupled = body.velocity.size() > 0 ? body.velocity.coeff(i, i) : 0.0;
    return body.damping.alpha + body.damping.beta * omega(i) * omega(i) + coupled;
  };
  EXPECT_NEAR(rate(0), 2.0 * 0.01 * omega(0), 1e-9 * omega(0));
  EXPECT_NEAR(rate(1), 2.0 * 0.03 * omega(1), 1e-9 * omega(1));
}

TEST(ModesBody, RigidMotionsAreThoseOfAFreeBody) {
  ModesBodyParameters given = two_modes();
  given.ports["tip"].x = {0.0, 0.0};
  given.rigid = RigidMotionParameters{2.0, {0.04, -0.01}, {5e-3}};
  const BodyMatrices body = given.make();
  ASSERT_EQ(body.num_dofs(), 5);
  // A force f at the tip accelerates it by (1/m + (arm)²/J) f beside the elastic part.
  const Eigen::RowVectorXd y = row_of(body, "tip", 1).tail(3);
  EXPECT_NEAR(y.squaredNorm(), 1.0 / 2.0 + 0.06 * 0.06 / 5e-3, 1e-14);
  const Eigen::RowVectorXd x = row_of(body, "tip", 0).tail(3);
  EXPECT_NEAR(x.squaredNorm(), 1.0 / 2.0 + 0.03 * 0.03 / 5e-3, 1e-14);
  EXPECT_NEAR(x.dot(y), -0.06 * 0.03 / 5e-3, 1e-14);
  EXPECT_EQ(body.stiffness.coeff(4, 4), 0.0);
  // Of a body in space six.
  given.rigid->inertia = {1e-3, 2e-3, 5e-3};
  EXPECT_EQ(given.make().num_dofs(), 8);
}

TEST(ModesBody, ResidualFlexibilityIsThatOfTheMatrixAtRest) {
  ModesBodyParameters given = two_modes();
  given.residual = ResidualParameters{{"tip.y", "side.x"}, {}, std::nullopt};
  const Eigen::Matrix2d F{{3e-6, 1e-6}, {1e-6, 2e-6}};
  given.residual_flexibility = std::make_shared<const SparseMatrix>(F.sparseView());
  const BodyMatrices body = given.make();
  ASSERT_EQ(body.num_dofs(), 4);
  Eigen::MatrixXd rows(2, 4);
  rows << row_of(body, "tip", 1), row_of(body, "side", 0);
  const Eigen::MatrixXd flexibility =
      rows * Eigen::MatrixXd(body.stiffness).inverse() * rows.transpose();
  const Eigen::MatrixXd of_modes = rows.leftCols(2) *
                                   Eigen::MatrixXd(body.stiffness).topLeftCorner(2, 2).inverse() *
                                   rows.leftCols(2).transpose();
  EXPECT_LT((flexibility - of_modes - F).norm(), 1e-12 * F.norm());
  // It vibrates at ten times the highest mode.
  EXPECT_NEAR(std::sqrt(body.stiffness.coeff(3, 3)), 10.0 * two_pi * 250.0, 1e-6);
  // A matrix of rank one makes one mode.
  given.residual_flexibility =
      std::make_shared<const SparseMatrix>(Eigen::Matrix2d{{1e-6, 2e-6}, {2e-6, 4e-6}}.sparseView());
  EXPECT_EQ(given.make().num_dofs(), 3);
}

ModalTest measured(bool is_complex) {
  ModalTest test;
  test.nodes[5] = {0.1, 0.0, 0.0};
  TestMode mode;
  mode.number = 2;
  mode.frequency = 100.0;
  mode.damping_ratio = 0.01;
  mode.modal_mass = 4.0;
  mode.is_complex = is_complex;
  const std::complex<double> turn = is_complex ? std::polar(1.0, 0.7) : 1.0;
  mode.shape[5] = {0.0, 2.0 * turn, 0.0};
  mode.shape[6] = {0.0, std::complex<double>(-1.0, is_complex ? 0.05 : 0.0) * turn, 0.0};
  mode.source = "a.uff:9";
  test.modes = {mode};
  return test;
}

ModesBodyParameters from_file(const ModalTest& test) {
  ModesBodyParameters body;
  body.file = "a.uff";
  body.test = std::make_shared<const ModalTest>(test);
  body.ports["tip"].node = 5;
  return body;
}

TEST(ModesBody, ModesOfAFileAreTakenAsTheyAre) {
  const BodyMatrices body = from_file(measured(false)).make();
  EXPECT_EQ(row_of(body, "tip", 1)(0), 1.0);
  EXPECT_FALSE(body.moves(0, 0));
  EXPECT_EQ(body.nodes(0, 0), 0.1);
  EXPECT_NEAR(std::sqrt(body.stiffness.coeff(0, 0)), two_pi * 100.0, 1e-10);
}

TEST(ModesBody, LinesOfAFileBringTheirNodesToBeDrawn) {
  ModalTest test = measured(false);
  test.nodes[6] = {0.2, 0.0, 0.0};
  test.nodes[7] = {0.3, 0.0, 0.0};
  test.nodes[9] = {0.2, 0.1, 0.0};
  test.lines = {{5, 6, 7, 9, 6}};
  // A triangle shares an edge with another.
  test.elements = {{ElementShape::tri3, {5, 6, 9}}, {ElementShape::tri3, {6, 9, 8}}};
  for (TestMode& mode : test.modes) {
    mode.shape[6] = {0.5, -2.0, 0.25};
    mode.shape[9] = {0.0, 1.0, 0.0};
    mode.shape[8] = {1.0, 0.0, 0.0};  // has no place
  }
  const ModesBodyParameters parameters = from_file(test);
  const BodyMatrices body = parameters.make();
  ASSERT_EQ(body.nodes.rows(), 3);  // 5 is the port; 7 has no values
  EXPECT_EQ(body.points.size(), 1u);
  EXPECT_EQ(body.nodes.row(1), Eigen::RowVector3d(0.2, 0.0, 0.0));
  EXPECT_EQ(body.nodes.row(2), Eigen::RowVector3d(0.2, 0.1, 0.0));
  using Lines = std::vector<std::vector<int>>;
  EXPECT_EQ(body.outlines, (Lines{{0, 1}, {2, 1}, {0, 1}, {1, 2}, {2, 0}}));
  const double scale = 1.0 / std::sqrt(test.modes[0].modal_mass);
  const std::array<double, 3> shape{0.5, -2.0, 0.25};
  for (const std::size_t direction : {0u, 1u, 2u}) {
    const DofSum sum = body.displacement(1, direction);
    ASSERT_EQ(sum.size(), test.modes.size());
    EXPECT_DOUBLE_EQ(sum[0].weight, scale * shape[direction]);
  }
  // What the port is stays as it is without the lines.
  ModalTest bare = test;
  bare.lines.clear();
  bare.elements.clear();
  EXPECT_EQ(row_of(body, "tip", 1), row_of(from_file(bare).make(), "tip", 1));
  EXPECT_EQ(from_file(bare).make().nodes.rows(), 1);
}

TEST(ModesBody, ComplexShapesAreTurnedToRealOnesOrRefused) {
  const ModalTest test = measured(true);
  const RealisedShape real = realise(test.modes[0]);
  // Turned by 0.01 rad, 0.02 and 0.04 of √5 are out of phase, to the second order.
  EXPECT_NEAR(real.complexity, 0.02, 1e-4);
  EXPECT_NEAR(std::abs(row_of(from_file(test).make(), "tip", 1)(0)), 1.0, 1e-3);
  EXPECT_THAT(from_file(test).warnings().at(0).message, HasSubstr("complex shapes"));
  ModesBodyParameters strict = from_file(test);
  strict.complexity = 0.01;
  EXPECT_THAT(message_of<ConfigError>([&] { strict.make(); }),
              AllOf(HasSubstr("mode 2 (a.uff:9) is complex"), HasSubstr("more than 1 %")));
}

TEST(ModesBody, WhatDoesNotFitIsRefused) {
  const auto message = [](const auto& change) {
    ModesBodyParameters body = two_modes();
    change(body);
    return message_of<ConfigError>([&] { body.make(); });
  };
  EXPECT_THAT(message([](auto& body) { body.ports["tip"].y = {1.0}; }),
              HasSubstr("has 1 numbers; expected one for each of the 2 modes"));
  EXPECT_THAT(message([](auto& body) { body.damping_ratios = {0.1, 1.5}; }),
              HasSubstr("mode 2 has the damping ratio 1.5"));
  EXPECT_THAT(message([](auto& body) { body.surfaces["tip"].points = {"tip", "side"}; }),
              HasSubstr("a port has this name already"));
  EXPECT_THAT(message([](auto& body) { body.surfaces["top"].points = {"tip", "sde"}; }),
              HasSubstr("did you mean 'side'?"));
  const auto residual = [&](std::vector<std::string> on, const Eigen::MatrixXd& F,
                            std::optional<double> frequency = std::nullopt) {
    return message([&](auto& body) {
      body.residual = ResidualParameters{std::move(on), {}, frequency};
      body.residual_flexibility = std::make_shared<const SparseMatrix>(F.sparseView());
    });
  };
  const Eigen::MatrixXd one = Eigen::MatrixXd::Identity(1, 1);
  EXPECT_THAT(residual({"tip.y", "side.x"}, one), HasSubstr("is 1 x 1; expected a row"));
  EXPECT_THAT(residual({"tip.x"}, one), HasSubstr("'tip' does not move along x"));
  EXPECT_THAT(residual({"tip"}, one), HasSubstr("not of the form"));
  EXPECT_THAT(residual({"top.y"}, one), HasSubstr("did you mean 'tip'"));
  EXPECT_THAT(residual({"tip.y"}, -one), HasSubstr("negative eigenvalue"));
  EXPECT_THAT(residual({"tip.y"}, one, 200.0), HasSubstr("must lie above the highest mode, 250 Hz"));
  EXPECT_THAT(residual({"tip.y", "side.x"}, Eigen::MatrixXd{{1.0, 2.0}, {0.0, 9.0}}),
              HasSubstr("must be symmetric"));

  const auto of_file = [](const auto& change) {
    ModalTest test = measured(false);
    ModesBodyParameters body = from_file(test);
    change(body, test);
    body.test = std::make_shared<const ModalTest>(test);
    return message_of<ConfigError>([&] { body.make(); });
  };
  EXPECT_THAT(of_file([](auto& body, auto&) { body.take = {3}; }),
              HasSubstr("the file has no mode 3 (there are: 2)"));
  EXPECT_THAT(of_file([](auto& body, auto&) { body.ports["tip"].node = 6; }),
              HasSubstr("the file has no place of a node 6"));
  EXPECT_THAT(of_file([](auto& body, auto& test) {
                test.modes[0].shape.erase(5);
                (void)body;
              }),
              HasSubstr("mode 2 (a.uff:9) has no values at node 5"));
  EXPECT_THAT(of_file([](auto&, auto& test) { test.modes[0].modal_mass = 0.0; }),
              AllOf(HasSubstr("mode 2 (a.uff:9) has the modal mass 0 kg"), HasSubstr("give the masses here")));
}

}  // namespace
}  // namespace stridor
