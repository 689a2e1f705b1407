#include "substructures/bodies/beam.hpp"

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
#include <utility>
#include <vector>

#include "substructures/bodies/beam_mesh.hpp"
#include "substructures/reduction/lowest_modes.hpp"
#include "tests/support/full_model.hpp"
#include "tests/support/message_of.hpp"
#include "tests/support/paper_beams.hpp"

namespace stridor {
namespace {

using test::dense_spectrum;
using test::eps;
using test::message_of;
using test::paper_cantilever;
using test::paper_oblique;
using test::rigid_motion;
using testing::Each;
using testing::ElementsAre;
using testing::SizeIs;

constexpr std::array<Support, 4> all_supports{Support::free, Support::clamped, Support::pinned,
                                              Support::guided};

/// Small oblique mesh with more than one element through the thickness.
BeamParameters small_beam(Support start = Support::free, Support end = Support::free,
                          double angle = 0.4) {
  BeamParameters beam = paper_oblique(angle);
  beam.mesh = {5, 2};
  beam.supports = {start, end};
  return beam;
}

/// Slender cantilever without lateral contraction, for which the clamp does not disturb bending.
BeamParameters slender_cantilever(int along, int through) {
  BeamParameters beam;
  beam.length = 0.1;
  beam.thickness = 0.005;
  beam.width = 0.01;
  beam.material = {2e11, 0.0, 7800.0};
  beam.mesh = {along, through};
  beam.supports = {Support::clamped, Support::free};
  return beam;
}

double area(const BeamParameters& beam) {
  return beam.thickness * beam.width;
}
double total_mass(const BeamParameters& beam) {
  return beam.material.density * beam.length * area(beam);
}
double bending_stiffness(const BeamParameters& beam) {
  return beam.material.youngs_modulus * beam.width * std::pow(beam.thickness, 3) / 12.0;
}
/// κ G A with the 5/6 of a parabolic shear stress.
double shear_stiffness(const BeamParameters& beam) {
  return 5.0 / 6.0 * beam.material.youngs_modulus / (2.0 * (1.0 + beam.material.poissons_ratio)) *
         area(beam);
}

/// Work-conjugate tip deflection under a unit force in y spread evenly over the face of the free
/// end: 1/6, 4/6, 1/6 on the nodes of every element.
double tip_compliance(const BeamParameters& beam) {
  const BodyMatrices body = make_beam(beam);
  const std::vector<int>& face = body.surfaces.at("end_face");
  Eigen::VectorXd force = Eigen::VectorXd::Zero(body.num_dofs());
  const double share = 1.0 / (6.0 * beam.mesh.through);
  for (std::size_t i = 0; i + 2 < face.size(); i += 2) {
    for (const auto& [node, weight] : {std::pair{i, 1.0}, {i + 1, 4.0}, {i + 2, 1.0}})
      force(body.node_dofs[static_cast<std::size_t>(face[node])][1]) += weight * share;
  }
  const SparseCholesky factor(body.stiffness, "the stiffness of the beam");
  return force.dot(factor.solve(force).col(0));
}

Eigen::Vector2d position(const BodyMatrices& body, int node) {
  return body.nodes.row(node).head<2>().transpose();
}
Eigen::Vector2d position(const BodyMatrices& body, const std::string& point) {
  return position(body, body.points.at(point));
}

TEST(Beam, MassOfARigidTranslationIsThatOfTheBeam) {
  for (const BeamParameters& beam : {small_beam(), [] {
                                       BeamParameters free = paper_oblique();
                                       free.supports = {};
                                       return free;
                                     }()}) {
    const BodyMatrices body = make_beam(beam);
    const Eigen::VectorXd x = rigid_motion(body, {1.0, 0.0});
    const Eigen::VectorXd y = rigid_motion(body, {0.0, 1.0});
    // A sum of all entries: at worst one rounding of the total per non-zero.
    const double tolerance = static_cast<double>(body.mass.nonZeros()) * eps * total_mass(beam);
    EXPECT_NEAR(x.dot(body.mass * x), total_mass(beam), tolerance);
    EXPECT_NEAR(y.dot(body.mass * y), total_mass(beam), tolerance);
    EXPECT_EQ(x.dot(body.mass * y), 0.0);
  }
}

TEST(Beam, MatricesAreSymmetric) {
  const BodyMatrices body = make_beam(small_beam(Support::pinned, Support::guided));
  const Eigen::MatrixXd mass(body.mass);
  const Eigen::MatrixXd stiffness(body.stiffness);
  // Element entries a, b and b, a come from products in a different order.
  EXPECT_LE((mass - mass.transpose()).cwiseAbs().maxCoeff(), 64.0 * eps * mass.maxCoeff());
  EXPECT_LE((stiffness - stiffness.transpose()).cwiseAbs().maxCoeff(),
            64.0 * eps * stiffness.maxCoeff());
}

TEST(Beam, TranslationGivesExactlyNoForce) {
  // Entries are multiples of 2^-53 of the largest; 64 bits add up a row of them without rounding.
  BeamParameters flat = small_beam();
  flat.mesh = {200, 1};  // elements of 0.4 x 1.5 mm
  for (const BeamParameters& beam : {small_beam(), flat}) {
    const BodyMatrices body = make_beam(beam);
    for (const Eigen::Vector2d& direction :
         {Eigen::Vector2d(1.0, 0.0), Eigen::Vector2d(0.0, 1.0)}) {
      const Eigen::VectorXd motion = rigid_motion(body, direction);
      std::vector<long double> force(static_cast<std::size_t>(body.num_dofs()), 0.0L);
      for (Eigen::Index column = 0; column < body.num_dofs(); ++column) {
        for (SparseMatrix::InnerIterator entry(body.stiffness, column); entry; ++entry)
          force[static_cast<std::size_t>(entry.row())] +=
              static_cast<long double>(entry.value()) * motion(column);
      }
      EXPECT_THAT(force, Each(0.0L));
    }
  }
}

TEST(Beam, MassHoldsNoEntryBetweenTheDirections) {
  const BodyMatrices body = make_beam(small_beam());
  std::vector<std::size_t> direction(static_cast<std::size_t>(body.num_dofs()));
  for (const auto& dofs : body.node_dofs) {
    for (std::size_t k = 0; k < 2; ++k) direction[static_cast<std::size_t>(dofs[k])] = k;
  }
  for (Eigen::Index column = 0; column < body.num_dofs(); ++column) {
    for (SparseMatrix::InnerIterator entry(body.mass, column); entry; ++entry) {
      EXPECT_EQ(direction[static_cast<std::size_t>(entry.row())],
                direction[static_cast<std::size_t>(column)]);
    }
  }
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

TEST(Beam, SupportsLeaveAsManyZeroFrequenciesAsRigidMotions) {
  const auto num_rigid = [](Support start, Support end) {
    const BodyMatrices body = make_beam(small_beam(start, end));
    const Eigen::VectorXd squares =
        dense_spectrum(Eigen::MatrixXd(body.stiffness), Eigen::MatrixXd(body.mass));
    // Rounding leaves eps times the largest; the first bending mode is far above.
    return (squares.array() < 1e-11 * squares.maxCoeff()).count();
  };
  EXPECT_EQ(num_rigid(Support::free, Support::free), 3);
  EXPECT_EQ(num_rigid(Support::pinned, Support::free), 1);
  EXPECT_EQ(num_rigid(Support::free, Support::guided), 1);
  EXPECT_EQ(num_rigid(Support::clamped, Support::free), 0);
  EXPECT_EQ(num_rigid(Support::pinned, Support::pinned), 0);
  EXPECT_EQ(num_rigid(Support::guided, Support::clamped), 0);
  EXPECT_EQ(num_rigid(Support::pinned, Support::guided), 0);
}

TEST(Beam, TipDeflectionIsThatOfTimoshenko) {
  // A finite element body is too stiff, so its compliance lies below. Four elements through the
  // thickness resolve the parabolic shear stress but for 1/4^4 of its part above the uniform one
  // (1/6 of the shear deflection). The clamped section cannot warp: over less than a thickness the
  // shear compliance lacks that same 1/6. What remains is bending: a linear curvature lies within
  // the element's ξ²η.
  const BeamParameters beam = slender_cantilever(40, 4);
  const double bending = std::pow(beam.length, 3) / (3.0 * bending_stiffness(beam));
  const double shear = beam.length / shear_stiffness(beam);
  const double compliance = tip_compliance(beam);
  EXPECT_LT(compliance, bending + shear);
  EXPECT_GT(compliance,
            bending + shear * (1.0 - beam.thickness / (6.0 * beam.length) - 1.0 / (6.0 * 256.0)));
  // Euler-Bernoulli alone is missed by the shear, 0.6 (h/L)² = 0.15 %: the test sees it.
  EXPECT_GT(compliance, bending * 1.001);
}

TEST(Beam, OneElementThroughTheThicknessHasUniformShear) {
  // Its strain is at most linear across the thickness; the best of that for a parabola is uniform,
  // so κ = 1 in place of 5/6, and no section warps.
  const BeamParameters beam = slender_cantilever(80, 1);
  const double bending = std::pow(beam.length, 3) / (3.0 * bending_stiffness(beam));
  const double shear = 5.0 / 6.0 * beam.length / shear_stiffness(beam);
  // A cubic deflection is interpolated by quadratics: relative error of order (element/length)².
  const double element = 1.0 / beam.mesh.along;
  EXPECT_NEAR(tip_compliance(beam), bending + shear, bending * element * element);
}

TEST(Beam, ClampStiffensABeamWithLateralContractionOnly) {
  // The clamp suppresses the contraction of its section: there the bending stiffness is at most
  // E/(1 − ν²), over a length below the thickness, on an arm L: 3 ν² h/L of the deflection.
  BeamParameters beam = slender_cantilever(40, 4);
  beam.material.poissons_ratio = 0.33;
  const double expected = std::pow(beam.length, 3) / (3.0 * bending_stiffness(beam)) +
                          beam.length / shear_stiffness(beam);
  const double compliance = tip_compliance(beam);
  EXPECT_LT(compliance, expected);
  EXPECT_GT(compliance, expected * (1.0 - 3.0 * 0.33 * 0.33 * beam.thickness / beam.length));
}

TEST(Beam, NestedMeshesSoftenMonotonically) {
  // Every coarse displacement field is contained in the finer ones (minimum of potential energy).
  double previous = 0.0;
  for (const auto& [along, through] : {std::pair{1, 1}, {2, 1}, {4, 1}, {8, 2}, {16, 2}, {32, 4}}) {
    const double compliance = tip_compliance(slender_cantilever(along, through));
    EXPECT_GT(compliance, previous) << along << "x" << through;
    previous = compliance;
  }
}

TEST(Beam, NestedMeshesLowerEveryFrequency) {
  Eigen::VectorXd previous = Eigen::VectorXd::Constant(4, 1e300);
  for (const auto& [along, through] : {std::pair{2, 1}, {4, 1}, {8, 2}, {16, 2}}) {
    const BodyMatrices body = make_beam(slender_cantilever(along, through));
    const Eigen::VectorXd squares =
        dense_spectrum(Eigen::MatrixXd(body.stiffness), Eigen::MatrixXd(body.mass)).head(4);
    for (int i = 0; i < 4; ++i) EXPECT_LT(squares(i), previous(i)) << along << "x" << through;
    previous = squares;
  }
}

/// First-order relative change of ω² of a cantilever mode by rotary inertia and shear:
/// r² ∫W'² / ∫W² and EI/(κGA) ∫W'''² / ∫W''², for W of Euler-Bernoulli with β L = root.
struct Correction {
  double rotary, shear;
};
Correction cantilever_correction(const BeamParameters& beam, double root) {
  const double ratio = (std::cosh(root) + std::cos(root)) / (std::sinh(root) + std::sin(root));
  std::array<double, 4> squares{};  // ∫ of the squared derivatives 0 to 3 over x/L, by midpoints
  constexpr int num_points = 20000;
  for (int i = 0; i < num_points; ++i) {
    const double z = root * (i + 0.5) / num_points;
    const std::array<double, 4> w{
        std::cosh(z) - std::cos(z) - ratio * (std::sinh(z) - std::sin(z)),
        std::sinh(z) + std::sin(z) - ratio * (std::cosh(z) - std::cos(z)),
        std::cosh(z) + std::cos(z) - ratio * (std::sinh(z) + std::sin(z)),
        std::sinh(z) - std::sin(z) - ratio * (std::cosh(z) + std::cos(z))};
    for (std::size_t k = 0; k < 4; ++k) squares[k] += w[k] * w[k];
  }
  const double beta = root / beam.length;
  const double radius_squared = beam.thickness * beam.thickness / 12.0;
  return {radius_squared * beta * beta * squares[1] / squares[0],
          bending_stiffness(beam) / shear_stiffness(beam) * beta * beta * squares[3] / squares[2]};
}

TEST(Beam, FirstFrequenciesAreEulerBernoulliWithRotaryInertiaAndShear) {
  // The mesh error falls with the fourth power of the element length; with 80 elements it is a
  // third of the tolerance at most.
  BeamParameters beam = slender_cantilever(80, 4);
  beam.thickness = 0.002;
  const BodyMatrices body = make_beam(beam);
  const SparseCholesky factor(body.stiffness, "the stiffness of the beam");
  const Modes modes = lowest_modes(factor, body.stiffness, body.mass, 4);
  const std::array<double, 4> roots{1.8751040687, 4.6940911330, 7.8547574382, 10.995540735};
  for (std::size_t i = 0; i < roots.size(); ++i) {
    const double beta = roots[i] / beam.length;
    const double euler_bernoulli =
        std::pow(beta, 4) * bending_stiffness(beam) / (beam.material.density * area(beam));
    const auto [rotary, shear] = cantilever_correction(beam, roots[i]);
    const double ratio = modes.omega_squared(static_cast<Eigen::Index>(i)) / euler_bernoulli;
    // The correction is of first order; the next is its square, of either sign. The clamped section
    // does not warp (shear h/L), and the parabola of the shear stress is resolved to 1/6 of 1/4^4.
    const double total = rotary + shear;
    const double tolerance = total * total + shear * (beam.thickness / beam.length + 1.0 / 1536.0);
    EXPECT_NEAR(ratio, 1.0 - total, tolerance) << "mode " << i + 1;
    EXPECT_LT(tolerance, 0.1 * total) << "the test would not see the correction";
  }
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

TEST(Beam, BaseInertiaIsTheMassOfTheUnsupportedMeshTimesTheUnitTranslation) {
  // All nodes follow the base, those of a clamp or a pin at the other end included.
  const BeamParameters free = small_beam();
  const BodyMatrices unsupported = make_beam(free);
  const Eigen::VectorXd moved = unsupported.mass * rigid_motion(unsupported, {1.0, 0.0});
  for (const Support start : {Support::free, Support::clamped, Support::pinned}) {
    const BodyMatrices body = make_beam(small_beam(start, Support::guided));
    ASSERT_EQ(body.base_inertia.size(), body.num_dofs());
    Eigen::VectorXd expected = Eigen::VectorXd::Zero(body.num_dofs());
    double of_held_nodes = 0.0;
    for (std::size_t node = 0; node < body.node_dofs.size(); ++node) {
      for (std::size_t k = 0; k < 2; ++k) {
        const int dof = body.node_dofs[node][k];
        const double entry = moved(unsupported.node_dofs[node][k]);
        (dof == BodyMatrices::held ? of_held_nodes : expected(dof)) += entry;
      }
    }
    const double tolerance = 64.0 * eps * total_mass(free);
    EXPECT_LE((body.base_inertia - expected).cwiseAbs().maxCoeff(), tolerance);
    EXPECT_NEAR(body.base_inertia.sum() + of_held_nodes, total_mass(free), 8.0 * tolerance);
    EXPECT_EQ(body.base_inertia(body.load_dof), 0.0);
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

TEST(Beam, TurningAFreeBeamChangesNoFrequency) {
  const auto spectrum = [](double angle) {
    const BodyMatrices body = make_beam(small_beam(Support::free, Support::free, angle));
    return dense_spectrum(Eigen::MatrixXd(body.stiffness), Eigen::MatrixXd(body.mass));
  };
  const BodyMatrices straight = make_beam(small_beam(Support::free, Support::free, 0.0));
  const Eigen::VectorXd reference = spectrum(0.0);
  // The entries of K are perturbed by rounding; the eigenvalues of M⁻¹ K by at most
  // |δK| / λ_min(M) <= n eps |K| cond(M) / |M|, and |K| / |M| is about the largest eigenvalue.
  const double tolerance = static_cast<double>(reference.size()) * eps *
                           test::condition_number(Eigen::MatrixXd(straight.mass)) *
                           reference.maxCoeff();
  EXPECT_LT(tolerance, 1e-3 * reference(3)) << "the test would not see the first bending mode";
  for (const double angle : {0.3, 0.5 * std::numbers::pi, 2.6, -2.0})
    EXPECT_LE((spectrum(angle) - reference).cwiseAbs().maxCoeff(), tolerance) << angle;
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
