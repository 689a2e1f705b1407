// Points, springs and motion across that a scene adds to the mesh of a beam.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>

#include "core/errors.hpp"
#include "substructures/bodies/beam.hpp"
#include "substructures/reduction/craig_bampton.hpp"
#include "tests/support/brake_pad.hpp"
#include "tests/support/message_of.hpp"

namespace stridor {
namespace {

using test::message_of;
using ::testing::HasSubstr;

/// The pad of brake_pad_test.cpp as a beam of a scene, with contact points at 10, 30 and 43 mm from
/// the start of its axis; the last one between nodes.
BeamParameters pad_beam() {
  BeamParameters beam;
  beam.length = 0.06;
  beam.thickness = 0.015;
  beam.width = 0.04;
  beam.material = {1e10, 0.3, 2500.0};
  beam.mesh = {6, 2};
  beam.across = AcrossMotion::rigid;
  beam.springs["backing"].on = "top";
  SpringMatrixParameters& stiffness = beam.springs["backing"].stiffness;
  stiffness.xx = 4e7;
  stiffness.yy = 1e8;
  stiffness.zz = 6e7;
  stiffness.xy = 2e7;
  beam.points = {{"a", {"bottom", 0.05}}, {"b", {"bottom", 0.03}}, {"c", {"bottom", 0.017}}};
  return beam;
}

struct ReducedPad {
  BodyMatrices body;
  ReducedBody reduced;
  Eigen::MatrixXd T;
};

/// Reduced to the nodes at the points, and the motion across.
ReducedPad reduce(const BeamParameters& beam, int num_modes) {
  ReducedPad pad;
  pad.body = beam.make();
  std::vector<int> interface, all;
  for (const auto& [name, node] : pad.body.points) {
    if (!beam.points.contains(name)) continue;
    for (const std::size_t direction : {0, 1, 2}) {
      for (const DofWeight& dof : pad.body.displacement(node, direction)) {
        if (std::find(interface.begin(), interface.end(), dof.dof) == interface.end())
          interface.push_back(dof.dof);
      }
    }
  }
  for (int dof = 0; dof < pad.body.num_dofs(); ++dof) all.push_back(dof);
  pad.reduced = make_craig_bampton(pad.body, interface, num_modes, all);
  pad.T = pad.reduced.rows;
  return pad;
}

Eigen::VectorXd omegas_of(const Eigen::MatrixXd& stiffness, const Eigen::MatrixXd& mass) {
  return Eigen::GeneralizedSelfAdjointEigenSolver<Eigen::MatrixXd>(stiffness, mass,
                                                                   Eigen::EigenvaluesOnly)
      .eigenvalues()
      .cwiseSqrt();
}

Eigen::VectorXd dense_sum(const BodyMatrices& body, const DofSum& sum) {
  Eigen::VectorXd all = Eigen::VectorXd::Zero(body.num_dofs());
  for (const DofWeight& dof : sum) all(dof.dof) += dof.weight;
  return all;
}

TEST(BeamAdditions, MakeAnElasticPad) {
  constexpr int num_modes = 12;
  const ReducedPad beam = reduce(pad_beam(), num_modes);
  ElasticPadParameters elastic;
  elastic.length = 0.06;
  elastic.thickness = 0.015;
  elastic.width = 0.04;
  elastic.material = {1e10, 0.3, 2500.0};
  elastic.mesh = {6, 2};
  elastic.reduction.fixed_interface_modes = num_modes;
  const PadBody pad = make_elastic_pad(elastic, {6e7, 4e7, 1e8, 2e7}, {-0.02, 0.0, 0.013});
  ASSERT_EQ(beam.reduced.size(), pad.size());
  const Eigen::VectorXd found = omegas_of(beam.reduced.stiffness, beam.reduced.mass);
  const Eigen::VectorXd expected = omegas_of(pad.stiffness, pad.mass);
  for (Eigen::Index i = 0; i < found.size(); ++i)
    EXPECT_NEAR(found(i), expected(i), 1e-9 * expected(i)) << i;

  // Static response of each point along each direction to loads on the back and on every point.
  const auto solver = pad.stiffness.ldlt();
  const auto beam_solver = beam.reduced.stiffness.ldlt();
  const auto sum = [&](const DofSum& part) -> Eigen::VectorXd {
    return beam.T.transpose() * dense_sum(beam.body, part);
  };
  std::vector<std::pair<Eigen::VectorXd, Eigen::VectorXd>> loads{
      {-sum(beam.body.load("top.y").value()), pad.pushed},
      {-sum(beam.body.load("backing.y").value()), pad.advanced}};
  std::vector<std::pair<Eigen::VectorXd, Eigen::VectorXd>> rows;
  const std::vector<std::string> names{"a", "b", "c"};
  for (std::size_t i = 0; i < names.size(); ++i) {
    const int node = beam.body.points.at(names[i]);
    const PadPoint& point = pad.points[i];
    rows.emplace_back(sum(beam.body.displacement(node, 0)), point.circumferential);
    rows.emplace_back(sum(beam.body.displacement(node, 1)), point.normal);
    rows.emplace_back(sum(beam.body.displacement(node, 2)), point.radial);
  }
  loads.insert(loads.end(), rows.begin(), rows.end());
  for (const auto& [load, pad_load] : loads) {
    const Eigen::VectorXd q = beam_solver.solve(load);
    const Eigen::VectorXd pad_q = solver.solve(pad_load);
    for (const auto& [row, pad_row] : rows)
      EXPECT_NEAR(row.dot(q), pad_row.dot(pad_q), 1e-9 * pad_q.cwiseAbs().maxCoeff());
  }
}

TEST(BeamAdditions, LoadsAreEvenAndGroundEndsCarryTheBodyAlong) {
  const BodyMatrices body = pad_beam().make();
  for (const std::string surface : {"top", "bottom", "start_face", "end_face"}) {
    for (const std::string axis : {"x", "y", "z"}) {
      // 1 N in all; moments about the middle of a surface vanish.
      const DofSum load = body.load(surface + "." + axis).value();
      double force = 0.0;
      for (const DofWeight& dof : load) force += dof.weight;
      EXPECT_NEAR(force, 1.0, 1e-14) << surface << axis;
    }
  }
  double moment = 0.0;
  const DofSum top = body.load("top.y").value();
  for (const DofWeight& dof : top) {
    for (std::size_t node = 0; node < body.node_dofs.size(); ++node) {
      if (body.node_dofs[node][1] == dof.dof)
        moment += dof.weight * (body.nodes(static_cast<Eigen::Index>(node), 0) - 0.03);
    }
  }
  EXPECT_NEAR(moment, 0.0, 1e-15);
  // K u of a translation is what the springs exert when their ground ends move as much.
  for (const std::size_t axis : {0, 1, 2}) {
    Eigen::VectorXd u = Eigen::VectorXd::Zero(body.num_dofs());
    for (int node = 0; node < static_cast<int>(body.nodes.rows()); ++node) {
      if (body.dependent.contains(node)) continue;
      for (const DofWeight& dof : body.displacement(node, axis)) u(dof.dof) = 1.0;
    }
    const std::string name = std::string("backing.") + "xyz"[axis];
    const Eigen::VectorXd expected = dense_sum(body, body.load(name).value());
    const Eigen::VectorXd force = body.stiffness * u;
    EXPECT_LT((force - expected).cwiseAbs().maxCoeff(), 1e-9 * 1e8) << name;
  }
}

TEST(BeamAdditions, PointsStandWhereTheyAreSaidTo) {
  const BodyMatrices body = pad_beam().make();
  const auto place = [&](const std::string& name) -> Eigen::Vector2d {
    return body.nodes.row(body.points.at(name)).head<2>();
  };
  EXPECT_LT((place("a") - Eigen::Vector2d(0.01, -0.0075)).norm(), 1e-15);
  EXPECT_LT((place("b") - Eigen::Vector2d(0.03, -0.0075)).norm(), 1e-15);
  EXPECT_LT((place("c") - Eigen::Vector2d(0.043, -0.0075)).norm(), 1e-15);
  EXPECT_FALSE(body.dependent.contains(body.points.at("b")));  // a node
  // Between nodes a field of second order is exact.
  const auto field = [](double x) { return 2.0 - 30.0 * x + 700.0 * x * x; };
  double value = 0.0;
  for (const DofWeight& dof : body.displacement(body.points.at("c"), 1)) {
    for (std::size_t node = 0; node < body.node_dofs.size(); ++node) {
      if (body.node_dofs[node][1] == dof.dof)
        value += dof.weight * field(body.nodes(static_cast<Eigen::Index>(node), 0));
    }
  }
  EXPECT_NEAR(value, field(0.043), 1e-13);
}

TEST(BeamAdditions, ASpringAtAPointActsAlongItsDirection) {
  BeamParameters beam = pad_beam();
  beam.across = AcrossMotion::held;
  beam.springs = {{"prop", {"tip", 5e6, {}, SpringDirectionParameters(0.3)}}};
  const BodyMatrices body = beam.make();
  beam.springs.clear();
  const Eigen::MatrixXd added = Eigen::MatrixXd(body.stiffness) - beam.make().stiffness;
  const auto& dofs = body.node_dofs[static_cast<std::size_t>(body.points.at("tip"))];
  Eigen::VectorXd d = Eigen::VectorXd::Zero(body.num_dofs());
  d(dofs[0]) = std::cos(0.3);
  d(dofs[1]) = std::sin(0.3);
  EXPECT_LT((added - 5e6 * d * d.transpose()).cwiseAbs().maxCoeff(), 1e-5);  // of 1e10
}

TEST(BeamAdditions, RefusesWhatIsNotThere) {
  const auto failure = [](const auto& change) {
    BeamParameters beam = pad_beam();
    change(beam);
    return message_of<ConfigError>([&] { beam.make(); });
  };
  EXPECT_THAT(failure([](BeamParameters& beam) { beam.points["a"].on = "botom"; }),
              HasSubstr("points.a.on: there is no surface 'botom', did you mean 'bottom'?"));
  EXPECT_THAT(failure([](BeamParameters& beam) { beam.points["a"].at = 0.061; }),
              HasSubstr("points.a.at: 0.061 m lies beyond the surface 'bottom' of 0.06 m"));
  EXPECT_THAT(failure([](BeamParameters& beam) { beam.points["tip"] = {"top", 0.0}; }),
              HasSubstr("points.tip: 'tip' is a point or surface of every beam"));
  EXPECT_THAT(failure([](BeamParameters& beam) { beam.springs["backing"].on = "d"; }),
              HasSubstr("springs.backing.on: there is no surface or point 'd'"));
  EXPECT_THAT(failure([](BeamParameters& beam) { beam.springs["top"] = beam.springs["backing"]; }),
              HasSubstr("springs.top: 'top' is a surface"));
  const auto problems = [](const Schema& schema, const void* object) {
    std::vector<Problem> found;
    for (const auto& check : schema.checks) check(object, found);
    return found;
  };
  BeamParameters held = pad_beam();
  held.supports.start = Support::clamped;
  ASSERT_EQ(problems(BeamParameters::schema(), &held).size(), 1U);
  EXPECT_EQ(problems(BeamParameters::schema(), &held)[0].key, "across");
  SpringMatrixParameters spring;
  EXPECT_EQ(problems(SpringMatrixParameters::schema(), &spring).size(), 1U);  // empty
  spring.xx = spring.yy = 1.0;
  spring.xy = 1.0;
  EXPECT_TRUE(problems(SpringMatrixParameters::schema(), &spring).empty());
  spring.xy = 1.001;
  EXPECT_THAT(problems(SpringMatrixParameters::schema(), &spring).at(0).message,
              HasSubstr("negative in some direction"));
  spring.along = 1.0;
  EXPECT_THAT(problems(SpringMatrixParameters::schema(), &spring).at(0).message,
              HasSubstr("does not go with a number along a direction"));
}

}  // namespace
}  // namespace stridor
