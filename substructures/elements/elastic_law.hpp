// Linear elasticity of volumes, plane stress and plane strain.
#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>

namespace stridor {

struct IsotropicElasticity {
  double youngs_modulus = 0.0;  ///< E, Pa, > 0
  double poissons_ratio = 0.0;  ///< ν, in (−1, 0.5)
};

/// Three planes of symmetry. ν_ij is the contraction along j over the extension along i under a
/// stress along i, so ν_ij/E_i = ν_ji/E_j.
struct OrthotropicElasticity {
  std::array<double, 3> youngs_moduli{};    ///< E_1, E_2, E_3, Pa, > 0
  std::array<double, 3> poissons_ratios{};  ///< ν_12, ν_13, ν_23
  std::array<double, 3> shear_moduli{};     ///< G_12, G_13, G_23, Pa, > 0
};

/// What a body in a plane has across it; `none` is a volume.
enum class PlaneState : std::uint8_t {
  none,
  stress,  ///< no stress across the plane
  strain,  ///< no strain across the plane
};

/// Symmetric positive definite elasticity D, σ = D ε, in the axes of the mesh.
///
/// Components come as xx, yy, zz, xy, yz, zx in a volume and xx, yy, xy in a plane; shears are
/// γ = 2 ε.
class ElasticLaw {
 public:
  using Matrix = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, 0, 6, 6>;

  /// @throws std::invalid_argument unless the law is positive definite
  ElasticLaw(const IsotropicElasticity& elasticity, PlaneState state);
  /// @param axes the axes 1, 2, 3 of the material as columns, a rotation; in a plane axis 3 is z
  /// @throws std::invalid_argument unless the law is positive definite, or if `axes` is no rotation
  ///   or, in a plane, turns z
  ElasticLaw(const OrthotropicElasticity& elasticity, PlaneState state,
             const Eigen::Matrix3d& axes = Eigen::Matrix3d::Identity());

  /// D, Pa: 6 x 6 of volumes, 3 x 3 of planar bodies.
  const Matrix& matrix() const { return matrix_; }
  PlaneState state() const { return state_; }
  /// Of the elements that it is for: 2 or 3.
  int dimension() const { return state_ == PlaneState::none ? 3 : 2; }

 private:
  PlaneState state_;
  Matrix matrix_;
};

}  // namespace stridor
