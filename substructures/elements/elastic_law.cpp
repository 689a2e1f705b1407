#include "substructures/elements/elastic_law.hpp"

#include <Eigen/Cholesky>
#include <Eigen/LU>
#include <cmath>
#include <stdexcept>

namespace stridor {
namespace {

using SolidLaw = Eigen::Matrix<double, 6, 6>;

/// Order of the components within a symmetric tensor.
constexpr std::array<std::array<int, 2>, 6> tensor_places{
    {{0, 0}, {1, 1}, {2, 2}, {0, 1}, {1, 2}, {2, 0}}};

/// Inverse of a symmetric matrix that must be positive definite.
template <class Matrix>
Matrix positive_inverse(const Matrix& matrix) {
  // Unit diagonal first: moduli may differ by many powers of ten.
  if (!matrix.allFinite() || !(matrix.diagonal().minCoeff() > 0.0))
    throw std::invalid_argument("ElasticLaw: elasticity is not positive definite");
  const auto scale = matrix.diagonal().cwiseSqrt().cwiseInverse().eval();
  const Matrix scaled = scale.asDiagonal() * matrix * scale.asDiagonal();
  const Eigen::LLT<Matrix> factor(scaled);
  // Beyond this the law is known to no digit.
  constexpr double least_pivot = 1e-7;
  const Matrix lower = factor.matrixL();
  if (factor.info() != Eigen::Success || !(lower.diagonal().minCoeff() > least_pivot))
    throw std::invalid_argument("ElasticLaw: elasticity is not positive definite");
  const Matrix inverse = factor.solve(Matrix::Identity().eval());
  const Matrix result = scale.asDiagonal() * inverse * scale.asDiagonal();
  return 0.5 * (result + result.transpose());
}

ElasticLaw::Matrix isotropic_law(const IsotropicElasticity& elasticity, PlaneState state) {
  const double modulus = elasticity.youngs_modulus;
  const double nu = elasticity.poissons_ratio;
  if (!(modulus > 0.0) || !std::isfinite(modulus) || !(nu > -1.0) || !(nu < 0.5))
    throw std::invalid_argument("ElasticLaw: elasticity is not positive definite");
  if (state == PlaneState::stress) {
    Eigen::Matrix3d law;
    law << 1, nu, 0, nu, 1, 0, 0, 0, 0.5 * (1 - nu);
    return law * (modulus / (1 - nu * nu));
  }
  const double shear = 0.5 * modulus / (1 + nu);
  const double lambda = modulus * nu / ((1 + nu) * (1 - 2 * nu));
  const Eigen::Index normal = state == PlaneState::none ? 3 : 2;
  const Eigen::Index all = state == PlaneState::none ? 6 : 3;
  ElasticLaw::Matrix law = ElasticLaw::Matrix::Zero(all, all);
  law.topLeftCorner(normal, normal).setConstant(lambda);
  law.diagonal().head(normal).array() += 2 * shear;
  law.diagonal().tail(all - normal).setConstant(shear);
  return law;
}

/// Strains in the axes of a material, of strains in those of the mesh; shears are doubled.
SolidLaw strain_turn(const Eigen::Matrix3d& axes) {
  SolidLaw turn;
  for (std::size_t a = 0; a < 6; ++a) {
    const auto [i, j] = tensor_places[a];
    for (std::size_t b = 0; b < 6; ++b) {
      const auto [k, l] = tensor_places[b];
      // ε'_ij = R_ki R_lj ε_kl; a shear ε_kl = γ/2 stands at kl and at lk.
      const double entry = k == l ? axes(k, i) * axes(k, j)
                                  : 0.5 * (axes(k, i) * axes(l, j) + axes(l, i) * axes(k, j));
      turn(static_cast<Eigen::Index>(a), static_cast<Eigen::Index>(b)) = i == j ? entry : 2 * entry;
    }
  }
  return turn;
}

SolidLaw orthotropic_compliance(const OrthotropicElasticity& elasticity) {
  const auto& [e1, e2, e3] = elasticity.youngs_moduli;
  const auto& [nu12, nu13, nu23] = elasticity.poissons_ratios;
  const auto& [g12, g13, g23] = elasticity.shear_moduli;
  SolidLaw compliance = SolidLaw::Zero();
  compliance.diagonal() << 1 / e1, 1 / e2, 1 / e3, 1 / g12, 1 / g23, 1 / g13;
  compliance(0, 1) = compliance(1, 0) = -nu12 / e1;
  compliance(0, 2) = compliance(2, 0) = -nu13 / e1;
  compliance(1, 2) = compliance(2, 1) = -nu23 / e2;
  return compliance;
}

ElasticLaw::Matrix orthotropic_law(const OrthotropicElasticity& elasticity, PlaneState state,
                                   const Eigen::Matrix3d& axes) {
  constexpr double rounding = 1e-9;  // of directions written with ten digits
  const double skew = (axes.transpose() * axes - Eigen::Matrix3d::Identity()).cwiseAbs().maxCoeff();
  if (!(skew <= rounding) || !(axes.determinant() > 0.0))
    throw std::invalid_argument("ElasticLaw: the axes of the material are no rotation");
  if (state != PlaneState::none && !(std::abs(axes(2, 2) - 1.0) <= rounding))
    throw std::invalid_argument("ElasticLaw: axis 3 of the material must be z in a plane");

  const SolidLaw compliance = orthotropic_compliance(elasticity);
  const SolidLaw solid = positive_inverse(compliance);
  const SolidLaw turn = strain_turn(axes);
  if (state == PlaneState::none) {
    const SolidLaw law = turn.transpose() * solid * turn;
    return 0.5 * (law + law.transpose());
  }
  // xx, yy, xy, which do not couple with the others in the axes of the material.
  const std::array<Eigen::Index, 3> in_plane{0, 1, 3};
  const Eigen::Matrix3d planar_turn = turn(in_plane, in_plane);
  const Eigen::Matrix3d planar =
      state == PlaneState::strain
          ? Eigen::Matrix3d(solid(in_plane, in_plane))
          : positive_inverse(Eigen::Matrix3d(compliance(in_plane, in_plane)));
  const Eigen::Matrix3d law = planar_turn.transpose() * planar * planar_turn;
  return 0.5 * (law + law.transpose());
}

}  // namespace

ElasticLaw::ElasticLaw(const IsotropicElasticity& elasticity, PlaneState state)
    : state_(state), matrix_(isotropic_law(elasticity, state)) {}

ElasticLaw::ElasticLaw(const OrthotropicElasticity& elasticity, PlaneState state,
                       const Eigen::Matrix3d& axes)
    : state_(state), matrix_(orthotropic_law(elasticity, state, axes)) {}

}  // namespace stridor
