// Supports, points and surfaces of beams, and beams that are refused.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <array>
#include <cmath>
#include <map>
#include <numbers>
#include <set>
#include <stdexcept>
#include <string>
#include <tuple>
#include <vector>

#include "substructures/bodies/beam.hpp"
#include "substructures/bodies/beam_mesh.hpp"
#include "tests/support/full_model.hpp"
#include "tests/support/message_of.hpp"
#include "tests/support/paper_beams.hpp"

namespace stridor {
namespace {

using test::eps;
using test::message_of;
using test::paper_cantilever;
using test::paper_oblique;
using test::rigid_motion;
using test::small_beam;
using testing::Each;
using testing::ElementsAre;
using testing::SizeIs;

constexpr std::array<Support, 4> all_supports{Support::free, Support::clamped, Support::pinned,
                                              Support::guided};

Eigen::Vector2d position(const BodyMatrices& body, int node) {
  return body.nodes.row(node).head<2>().transpose();
}
Eigen::Vector2d position(const BodyMatrices& body, const std::string& point) {
  return position(body, body.points.at(point));
}

TEST(Beam, RigidMotionsThatTheSupportsAllowGiveNoForce) {
  const auto force = [](const BodyMatrices& body, const Eigen::VectorXd& motion) {
    return (body.stiffness * motion).cwiseAbs().maxCoeff();
  };
  // Rows of up to 16 x 4 entries, each with a few dozen roundings of its own.
  const auto tolerance = [](const BodyMatrices& body, const Eigen::VectorXd& motion) {
    return 64.0 * 64.0 * eps * body.stiffness.coeffs().abs().maxCoeff() *
           motion.cwiseAbs().maxCoeff();
  };
  const BodyMatrices unsupported = make_beam(small_beam());
  for (const Eigen::VectorXd& motion :
       {rigid_motion(unsupported, {1.0, 0.0}), rigid_motion(unsupported, {0.0, 1.0}),
        rigid_motion(unsupported, {0.0, 0.0}, 1.0)}) {
    EXPECT_LE(force(unsupported, motion), tolerance(unsupported, motion));
  }
  const BodyMatrices pinned = make_beam(small_beam(Support::free, Support::pinned));
  const Eigen::VectorXd turn = rigid_motion(pinned, {0.0, 0.0}, 1.0, position(pinned, "end"));
  EXPECT_LE(force(pinned, turn), tolerance(pinned, turn));
  const BodyMatrices guided = make_beam(small_beam(Support::free, Support::guided));
  const Eigen::VectorXd lift = rigid_motion(guided, {0.0, 1.0});
  EXPECT_LE(force(guided, lift), tolerance(guided, lift));
}

TEST(Beam, NumberOfDoFsFollowsTheSupports) {
  // 5 x 2 elements: 6 full columns of 5 nodes and 5 of 3.
  const int num_nodes = 6 * 5 + 5 * 3;
  const auto removed = [](Support support) {
    switch (support) {
      case Support::free:
        return 0;
      case Support::pinned:
        return 2;
      case Support::clamped:
        return 2 * 5;
      case Support::guided:
        return 2 * 5 - 1;
    }
    return -1;
  };
  for (const Support start : all_supports) {
    for (const Support end : all_supports) {
      if (start == Support::guided && end == Support::guided) continue;
      const BodyMatrices body = make_beam(small_beam(start, end));
      EXPECT_EQ(body.nodes.rows(), num_nodes);
      EXPECT_THAT(body.node_dofs, SizeIs(static_cast<std::size_t>(num_nodes)));
      const int expected = 2 * num_nodes - removed(start) - removed(end);
      EXPECT_EQ(body.num_dofs(), expected);
      EXPECT_EQ(body.mass.cols(), expected);
      EXPECT_EQ(body.stiffness.rows(), expected);
      EXPECT_EQ(body.stiffness.cols(), expected);
      std::set<int> used;
      for (const auto& dofs : body.node_dofs) used.insert(dofs.begin(), dofs.end());
      used.erase(BodyMatrices::held);
      EXPECT_THAT(used, SizeIs(static_cast<std::size_t>(expected)));
      EXPECT_EQ(*used.begin(), 0);
      EXPECT_EQ(*used.rbegin(), expected - 1);
    }
  }
}

TEST(Beam, ClampHoldsEveryNodeOfItsEnd) {
  const BodyMatrices body = make_beam(small_beam(Support::free, Support::clamped));
  for (const int node : body.surfaces.at("end_face")) {
    EXPECT_THAT(body.node_dofs[static_cast<std::size_t>(node)],
                Each(static_cast<int>(BodyMatrices::held)));
  }
}

TEST(Beam, PinHoldsTheNodeOnTheAxisOnly) {
  const BodyMatrices body = make_beam(small_beam(Support::pinned, Support::free));
  for (const int node : body.surfaces.at("start_face")) {
    const bool is_pin = node == body.points.at("start");
    for (const int dof : body.node_dofs[static_cast<std::size_t>(node)])
      EXPECT_EQ(dof == BodyMatrices::held, is_pin) << node;
  }
  EXPECT_EQ(position(body, "start"), Eigen::Vector2d::Zero());
}

TEST(Beam, GuidedNodesShareOneVerticalDisplacementWhichCarriesTheLoad) {
  for (const auto& [start, end, face] : {std::tuple{Support::guided, Support::free, "start_face"},
                                         std::tuple{Support::free, Support::guided, "end_face"}}) {
    const BodyMatrices body = make_beam(small_beam(start, end));
    EXPECT_TRUE(body.follows_drive());
    std::set<int> guided;
    for (const int node : body.surfaces.at(face)) {
      EXPECT_THAT(body.node_dofs[static_cast<std::size_t>(node)],
                  ElementsAre(static_cast<int>(BodyMatrices::held), body.load_dof));
      guided.insert(node);
    }
    for (std::size_t node = 0; node < body.node_dofs.size(); ++node) {
      if (guided.contains(static_cast<int>(node))) continue;
      EXPECT_NE(body.node_dofs[node][0], body.load_dof);
      EXPECT_NE(body.node_dofs[node][1], body.load_dof);
    }
  }
}

TEST(Beam, OnlyAGuidedBeamFollowsTheDrive) {
  for (const Support start : {Support::free, Support::clamped, Support::pinned}) {
    const BodyMatrices body = make_beam(small_beam(start, Support::free));
    EXPECT_FALSE(body.follows_drive());
    EXPECT_EQ(body.load_dof, static_cast<int>(BodyMatrices::held));
    EXPECT_EQ(body.base_inertia.size(), 0);
  }
}

TEST(Beam, MatricesAreThoseOfTheUnsupportedMeshWithTheSupportsApplied) {
  // With S the map from supported to unsupported DoFs, M = Sᵀ M_free S, and the same for K.
  const BodyMatrices unsupported = make_beam(small_beam());
  for (const Support start : all_supports) {
    for (const Support end : all_supports) {
      if (start == Support::guided && end == Support::guided) continue;
      const BodyMatrices body = make_beam(small_beam(start, end));
      Eigen::MatrixXd map = Eigen::MatrixXd::Zero(unsupported.num_dofs(), body.num_dofs());
      for (std::size_t node = 0; node < body.node_dofs.size(); ++node) {
        for (std::size_t k = 0; k < 2; ++k) {
          const int dof = body.node_dofs[node][k];
          if (dof != BodyMatrices::held) map(unsupported.node_dofs[node][k], dof) = 1.0;
        }
      }
      // Shared DoFs add up entries of five nodes.
      const Eigen::MatrixXd mass = map.transpose() * unsupported.mass * map;
      EXPECT_LE((mass - Eigen::MatrixXd(body.mass)).cwiseAbs().maxCoeff(),
                32.0 * eps * mass.cwiseAbs().maxCoeff());
      const Eigen::MatrixXd stiffness = map.transpose() * unsupported.stiffness * map;
      EXPECT_LE((stiffness - Eigen::MatrixXd(body.stiffness)).cwiseAbs().maxCoeff(),
                32.0 * eps * unsupported.stiffness.coeffs().abs().maxCoeff());
    }
  }
}

TEST(Beam, BothEndsGuidedThrows) {
  EXPECT_EQ(message_of<std::invalid_argument>(
                [] { make_beam(small_beam(Support::guided, Support::guided)); }),
            "make_beam: both ends are guided");
}

TEST(Beam, DegenerateDimensionsThrow) {
  BeamParameters beam = small_beam();
  beam.thickness = 0.0;
  EXPECT_EQ(message_of<std::invalid_argument>([&] { make_beam(beam); }),
            "element 1 (quad8) is degenerate or turned inside out");
}

TEST(Beam, AxisRunsFromTheOriginAtTheGivenAngle) {
  for (const double angle : {0.0, 0.4, 2.6, -1.0}) {
    const BeamParameters beam = small_beam(Support::free, Support::free, angle);
    const BodyMatrices body = make_beam(beam);
    const Eigen::Vector2d axis{std::cos(angle), std::sin(angle)};
    const Eigen::Vector2d left{-std::sin(angle), std::cos(angle)};
    const double half = 0.5 * beam.thickness;
    const double tolerance = 4.0 * eps * beam.length;
    EXPECT_LE((position(body, "start")).norm(), tolerance);
    EXPECT_LE((position(body, "end") - beam.length * axis).norm(), tolerance);
    EXPECT_LE((position(body, "start_top") - half * left).norm(), tolerance);
    EXPECT_LE((position(body, "start_bottom") + half * left).norm(), tolerance);
    EXPECT_LE((position(body, "end_top") - beam.length * axis - half * left).norm(), tolerance);
    EXPECT_LE((position(body, "end_bottom") - beam.length * axis + half * left).norm(), tolerance);
  }
}

TEST(Beam, TipIsTheLowestCorner) {
  const BodyMatrices trailing = make_beam(paper_oblique(test::trailing_angle));
  EXPECT_EQ(trailing.points.at("tip"), trailing.points.at("start_bottom"));
  EXPECT_EQ(position(trailing, "tip").y(), trailing.nodes.col(1).minCoeff());
  const BodyMatrices leading = make_beam(paper_oblique(test::leading_angle));
  EXPECT_EQ(leading.points.at("tip"), leading.points.at("start_top"));
  EXPECT_EQ(position(leading, "tip").y(), leading.nodes.col(1).minCoeff());
}

TEST(Beam, TipOfAnUprightBeamIsTheBottomCorner) {
  const BodyMatrices upright =
      make_beam(small_beam(Support::free, Support::free, 0.5 * std::numbers::pi));
  EXPECT_EQ(position(upright, "start_top").y(), position(upright, "start_bottom").y());
  EXPECT_EQ(upright.points.at("tip"), upright.points.at("start_bottom"));
}

TEST(Beam, FreeEndIsTheTopCornerOfTheOneFreeEnd) {
  const BodyMatrices cantilever = make_beam(paper_cantilever());
  EXPECT_EQ(cantilever.points.at("free_end"), cantilever.points.at("end_top"));
  EXPECT_EQ(position(cantilever, "free_end"), Eigen::Vector2d(0.1, 0.001));
  const BodyMatrices oblique = make_beam(paper_oblique());
  EXPECT_EQ(oblique.points.at("free_end"), oblique.points.at("start_top"));
}

TEST(Beam, WithoutExactlyOneFreeEndThereIsNoFreeEnd) {
  EXPECT_FALSE(make_beam(small_beam()).points.contains("free_end"));
  EXPECT_FALSE(
      make_beam(small_beam(Support::pinned, Support::clamped)).points.contains("free_end"));
}

TEST(Beam, SurfacesRunAlongTheirEdgeWithTheBodyOnTheRight) {
  for (const double angle : {0.0, test::trailing_angle, test::leading_angle, 1.5, -2.0}) {
    const BeamParameters beam = small_beam(Support::free, Support::free, angle);
    const BodyMatrices body = make_beam(beam);
    const Eigen::Vector2d axis{std::cos(angle), std::sin(angle)};
    const Eigen::Vector2d left{-std::sin(angle), std::cos(angle)};
    const std::map<std::string, Eigen::Vector2d> outward{
        {"top", left}, {"bottom", -left}, {"start_face", -axis}, {"end_face", axis}};
    ASSERT_THAT(body.surfaces, SizeIs(4));
    for (const auto& [name, nodes] : body.surfaces) {
      const bool is_long = name == "top" || name == "bottom";
      const std::size_t num_segments = is_long ? 10 : 4;
      const double spacing = (is_long ? beam.length : beam.thickness) / double(num_segments);
      ASSERT_THAT(nodes, SizeIs(num_segments + 1)) << name;
      for (std::size_t i = 0; i + 1 < nodes.size(); ++i) {
        const Eigen::Vector2d along = position(body, nodes[i + 1]) - position(body, nodes[i]);
        const Eigen::Vector2d turned_left{-along.y(), along.x()};
        EXPECT_LE((turned_left - spacing * outward.at(name)).norm(), 16.0 * eps * beam.length)
            << name << " segment " << i << " angle " << angle;
      }
      // No node of the body lies beyond the edge.
      for (Eigen::Index node = 0; node < body.nodes.rows(); ++node) {
        const Eigen::Vector2d from_edge =
            body.nodes.row(node).head<2>().transpose() - position(body, nodes.front());
        EXPECT_LE(from_edge.dot(outward.at(name)), 16.0 * eps * beam.length) << name;
      }
    }
  }
}

TEST(Beam, MasterSurfaceOfThePaperIsExactlyHorizontalWithNodesAMillimetreApart) {
  const BodyMatrices body = make_beam(paper_cantilever());
  const std::vector<int>& top = body.surfaces.at("top");
  ASSERT_THAT(top, SizeIs(101));
  for (std::size_t i = 0; i < top.size(); ++i) {
    EXPECT_EQ(position(body, top[i]).y(), 0.001);
    EXPECT_NEAR(position(body, top[i]).x(), 0.001 * static_cast<double>(i), 4.0 * eps * 0.1);
  }
  EXPECT_THAT(test::master_interface(body), SizeIs(200));
}

TEST(Beam, SchemaRefusesTwoGuidedEnds) {
  const SupportParameters supports{Support::guided, Support::guided};
  std::vector<Problem> problems;
  for (const auto& check : SupportParameters::schema().checks) check(&supports, problems);
  ASSERT_THAT(problems, SizeIs(1));
  EXPECT_EQ(problems[0].text(),
            "end: both ends are guided; the drive can hold one end of a body only");
}

TEST(Beam, SchemaRefusesMeshesBeyondTenMillionElements) {
  const auto problems_of = [](MeshParameters mesh) {
    std::vector<Problem> problems;
    for (const auto& check : MeshParameters::schema().checks) check(&mesh, problems);
    return problems;
  };
  EXPECT_THAT(problems_of({1'000'000, 10}), SizeIs(0));
  const std::vector<Problem> problems = problems_of({1'000'000, 11});
  ASSERT_THAT(problems, SizeIs(1));
  EXPECT_EQ(problems[0].text(), "along: along x through must not exceed 1e7 elements");
}

TEST(BeamElements, CoverTheBeamOnceEachWithItsMiddleNodesHalfway) {
  BeamParameters parameters = paper_cantilever();
  parameters.mesh = {5, 3};
  const BodyMatrices body = make_beam(parameters);
  const auto elements = beam_elements(parameters.mesh);
  ASSERT_EQ(elements.size(), 15u);
  double area = 0.0;
  std::vector<int> uses(static_cast<std::size_t>(body.nodes.rows()), 0);
  for (const auto& e : elements) {
    for (std::size_t side = 0; side < 4; ++side) {
      const auto from = body.nodes.row(e[side]);
      const auto to = body.nodes.row(e[(side + 1) % 4]);
      EXPECT_LT((body.nodes.row(e[4 + side]) - 0.5 * (from + to)).norm(), 1e-15);
      area += 0.5 * (from(0) * to(1) - from(1) * to(0));
    }
    for (const int node : e) ++uses[static_cast<std::size_t>(node)];
  }
  EXPECT_NEAR(area, parameters.length * parameters.thickness, 1e-15);
  for (const int count : uses) EXPECT_TRUE(count == 1 || count == 2 || count == 4) << count;
}

}  // namespace
}  // namespace stridor
