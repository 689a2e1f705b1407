#include "substructures/elements/elastic_law.hpp"

#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <cmath>
#include <stdexcept>
#include <vector>

#include "tests/support/constants.hpp"
#include "tests/support/message_of.hpp"

namespace stridor {
namespace {

using test::eps;
using test::message_of;

constexpr IsotropicElasticity steel{210e9, 0.3};
/// Carbon fibre in epoxy: moduli that differ by a factor of twenty.
constexpr OrthotropicElasticity laminate{{140e9, 10e9, 9e9}, {0.3, 0.28, 0.45}, {5e9, 5.5e9, 3e9}};

OrthotropicElasticity as_orthotropic(const IsotropicElasticity& law) {
  const double e = law.youngs_modulus;
  const double nu = law.poissons_ratio;
  const double shear = 0.5 * e / (1.0 + nu);
  return {{e, e, e}, {nu, nu, nu}, {shear, shear, shear}};
}

Eigen::Matrix3d some_axes() {
  return (Eigen::AngleAxisd(0.7, Eigen::Vector3d(1, 2, -1).normalized()) *
          Eigen::AngleAxisd(-1.9, Eigen::Vector3d::UnitY()))
      .toRotationMatrix();
}

Eigen::Matrix3d about_z(double angle) {
  return Eigen::AngleAxisd(angle, Eigen::Vector3d::UnitZ()).toRotationMatrix();
}

Eigen::Matrix<double, 6, 1> as_strains(const Eigen::Matrix3d& tensor) {
  Eigen::Matrix<double, 6, 1> strains;
  strains << tensor(0, 0), tensor(1, 1), tensor(2, 2), 2 * tensor(0, 1), 2 * tensor(1, 2),
      2 * tensor(2, 0);
  return strains;
}

Eigen::Matrix3d as_stress(const Eigen::Matrix<double, 6, 1>& s) {
  Eigen::Matrix3d tensor;
  tensor << s(0), s(3), s(5), s(3), s(1), s(4), s(5), s(4), s(2);
  return tensor;
}

/// An inverse and two turns of 6 x 6: dozens of operations, with the ratio of the moduli.
double law_rounding(const ElasticLaw& law) {
  return 1000.0 * eps * law.matrix().cwiseAbs().maxCoeff();
}

TEST(ElasticLaw, UniaxialStressGivesYoungsModulusAndPoissonsRatio) {
  const Eigen::Matrix<double, 6, 6> compliance =
      ElasticLaw(steel, PlaneState::none).matrix().inverse();
  for (int i = 0; i < 6; ++i) {
    for (int j = 0; j < 6; ++j) {
      const double expected = i == j ? (i < 3 ? 1.0 : 2.0 * 1.3) : i < 3 && j < 3 ? -0.3 : 0.0;
      EXPECT_NEAR(compliance(i, j) * 210e9, expected, 100.0 * eps) << i << j;
    }
  }
}

TEST(ElasticLaw, PlaneStressIsTheVolumeWithoutStressAcross) {
  for (const double nu : {-0.5, 0.0, 0.3, 0.49}) {
    const IsotropicElasticity law{70e9, nu};
    const Eigen::Matrix<double, 6, 6> compliance =
        ElasticLaw(law, PlaneState::none).matrix().inverse();
    const std::array<int, 3> in_plane{0, 1, 3};
    const Eigen::Matrix3d expected = Eigen::Matrix3d(compliance(in_plane, in_plane)).inverse();
    const ElasticLaw planar(law, PlaneState::stress);
    EXPECT_EQ(planar.dimension(), 2);
    EXPECT_LE((planar.matrix() - expected).cwiseAbs().maxCoeff(), law_rounding(planar));
  }
}

TEST(ElasticLaw, PlaneStrainIsTheVolumeWithoutStrainAcross) {
  const ElasticLaw solid(steel, PlaneState::none);
  const ElasticLaw planar(steel, PlaneState::strain);
  const std::array<int, 3> in_plane{0, 1, 3};
  EXPECT_EQ(planar.matrix(), Eigen::Matrix3d(solid.matrix()(in_plane, in_plane)));
}

TEST(ElasticLaw, OrthotropicOfEqualModuliIsIsotropicInAnyAxes) {
  for (const PlaneState state : {PlaneState::none, PlaneState::stress, PlaneState::strain}) {
    const ElasticLaw isotropic(steel, state);
    const Eigen::Matrix3d axes = state == PlaneState::none ? some_axes() : about_z(0.4);
    const ElasticLaw orthotropic(as_orthotropic(steel), state, axes);
    EXPECT_LE((orthotropic.matrix() - isotropic.matrix()).cwiseAbs().maxCoeff(),
              law_rounding(isotropic));
  }
}

TEST(ElasticLaw, ComplianceHoldsTheNineConstants) {
  const Eigen::Matrix<double, 6, 6> compliance =
      ElasticLaw(laminate, PlaneState::none).matrix().inverse();
  Eigen::Matrix<double, 6, 6> expected = Eigen::Matrix<double, 6, 6>::Zero();
  expected.diagonal() << 1 / 140e9, 1 / 10e9, 1 / 9e9, 1 / 5e9, 1 / 3e9, 1 / 5.5e9;
  expected(0, 1) = expected(1, 0) = -0.3 / 140e9;
  expected(0, 2) = expected(2, 0) = -0.28 / 140e9;
  expected(1, 2) = expected(2, 1) = -0.45 / 10e9;
  EXPECT_LE((compliance - expected).cwiseAbs().maxCoeff(),
            1000.0 * eps * expected.cwiseAbs().maxCoeff());
}

TEST(ElasticLaw, TurnedAxesTurnStressAndStrain) {
  const Eigen::Matrix3d axes = some_axes();
  const ElasticLaw straight(laminate, PlaneState::none);
  const ElasticLaw turned(laminate, PlaneState::none, axes);
  for (int i = 0; i < 3; ++i) {
    for (int j = 0; j <= i; ++j) {
      Eigen::Matrix3d strain = Eigen::Matrix3d::Zero();
      strain(i, j) = strain(j, i) = 1.0;
      const Eigen::Matrix3d in_axes = axes.transpose() * strain * axes;
      const Eigen::Matrix3d expected =
          axes * as_stress(straight.matrix() * as_strains(in_axes)) * axes.transpose();
      const Eigen::Matrix3d stress = as_stress(turned.matrix() * as_strains(strain));
      EXPECT_LE((stress - expected).cwiseAbs().maxCoeff(), law_rounding(straight));
    }
  }
}

TEST(ElasticLaw, PlanarOrthotropicIsTheVolumeTurnedAboutZ) {
  const std::array<int, 3> in_plane{0, 1, 3};
  const ElasticLaw solid(laminate, PlaneState::none, about_z(0.6));
  const ElasticLaw strain(laminate, PlaneState::strain, about_z(0.6));
  EXPECT_LE(
      (strain.matrix() - Eigen::Matrix3d(solid.matrix()(in_plane, in_plane))).cwiseAbs().maxCoeff(),
      law_rounding(solid));
  const Eigen::Matrix<double, 6, 6> compliance = solid.matrix().inverse();
  const ElasticLaw stress(laminate, PlaneState::stress, about_z(0.6));
  EXPECT_LE((stress.matrix() - Eigen::Matrix3d(compliance(in_plane, in_plane)).inverse())
                .cwiseAbs()
                .maxCoeff(),
            law_rounding(solid));
}

constexpr auto indefinite = "ElasticLaw: elasticity is not positive definite";

TEST(ElasticLaw, IndefiniteIsotropicElasticityThrows) {
  for (const PlaneState state : {PlaneState::none, PlaneState::stress, PlaneState::strain}) {
    for (const IsotropicElasticity& law : {IsotropicElasticity{0.0, 0.3},
                                           {-1.0, 0.3},
                                           {1.0, 0.5},
                                           {1.0, -1.0},
                                           {test::not_a_number, 0.3},
                                           {1.0, test::not_a_number},
                                           {test::infinity, 0.3}}) {
      EXPECT_EQ(message_of<std::invalid_argument>([&] { ElasticLaw(law, state); }), indefinite);
    }
  }
}

TEST(ElasticLaw, IndefiniteOrthotropicElasticityThrows) {
  for (int k = 0; k < 9; ++k) {
    OrthotropicElasticity law = laminate;
    const auto at = static_cast<std::size_t>(k % 3);
    if (k < 3) law.youngs_moduli[at] = -1e9;
    if (k >= 3 && k < 6) law.shear_moduli[at] = 0.0;
    // |ν_ij| < √(E_i/E_j) is needed at least.
    if (k >= 6) law.poissons_ratios[at] = 4.0;
    EXPECT_EQ(message_of<std::invalid_argument>([&] { ElasticLaw(law, PlaneState::none); }),
              indefinite)
        << k;
  }
  EXPECT_EQ(message_of<std::invalid_argument>([] {
              OrthotropicElasticity law = as_orthotropic(steel);
              law.poissons_ratios = {0.5, 0.5, 0.5};
              ElasticLaw(law, PlaneState::none);
            }),
            indefinite);
}

TEST(ElasticLaw, AxesThatAreNoRotationThrow) {
  for (const Eigen::Matrix3d& axes :
       std::vector<Eigen::Matrix3d>{2.0 * Eigen::Matrix3d::Identity(), -Eigen::Matrix3d::Identity(),
                                    Eigen::Matrix3d::Constant(test::not_a_number)}) {
    EXPECT_EQ(
        message_of<std::invalid_argument>([&] { ElasticLaw(laminate, PlaneState::none, axes); }),
        "ElasticLaw: the axes of the material are no rotation");
  }
}

TEST(ElasticLaw, PlanarAxesThatTurnZThrow) {
  EXPECT_EQ(message_of<std::invalid_argument>(
                [] { ElasticLaw(laminate, PlaneState::stress, some_axes()); }),
            "ElasticLaw: axis 3 of the material must be z in a plane");
}

}  // namespace
}  // namespace stridor
