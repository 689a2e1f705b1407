#include "substructures/bodies/beam.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <array>
#include <cmath>
#include <numbers>
#include <utility>
#include <vector>

#include "substructures/reduction/lowest_modes.hpp"
#include "tests/support/full_model.hpp"
#include "tests/support/paper_beams.hpp"

namespace stridor {
namespace {

using test::dense_spectrum;
using test::eps;
using test::paper_oblique;
using test::rigid_motion;
using test::small_beam;
using testing::Each;

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

}  // namespace
}  // namespace stridor
