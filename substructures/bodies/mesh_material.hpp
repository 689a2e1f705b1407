// Materials of bodies from meshes, as scenes describe them.
#pragma once

#include <Eigen/Core>
#include <optional>
#include <vector>

#include "core/schema.hpp"
#include "substructures/bodies/beam.hpp"
#include "substructures/elements/material_axes.hpp"
#include "substructures/elements/solid_element.hpp"

namespace stridor {

/// Moduli of a material with three planes of symmetry.
struct OrthotropicParameters {
  std::vector<double> youngs_moduli;    ///< E_1, E_2, E_3, Pa, > 0
  std::vector<double> poissons_ratios;  ///< ν_12, ν_13, ν_23
  std::vector<double> shear_moduli;     ///< G_12, G_13, G_23, Pa, > 0
  static const Schema& schema();
};

/// A line in the frame of the mesh.
struct AxisParameters {
  std::vector<double> point;      ///< m; empty: the origin
  std::vector<double> direction;  ///< of any length; empty: z
  static const Schema& schema();

  /// @param turn from the frame of the mesh to that of the body, about z
  AxisOfRevolution axis(const Eigen::Matrix2d& turn) const;
};

/// Where the axes 1, 2 and 3 of a material point, in the frame of the mesh.
struct MaterialAxesParameters {
  std::optional<double> angle;           ///< of axis 1 about z, rad
  std::vector<double> first, second;     ///< axis 1, and a vector in the plane of axes 1 and 2
  std::optional<AxisParameters> around;  ///< 1 radial, 2 tangential, 3 along it
  static const Schema& schema();
};

/// C = α M + β K of the elements of one material.
struct MaterialDampingParameters {
  double alpha = 0.0;  ///< α, 1/s, >= 0
  double beta = 0.0;   ///< β, s, >= 0
  static const Schema& schema();
};

/// Isotropic or orthotropic, with damping of its own.
struct MeshMaterialParameters {
  std::optional<double> youngs_modulus;  ///< E, Pa, > 0
  std::optional<double> poissons_ratio;  ///< ν, in (−1, 0.5)
  double density = 0.0;                  ///< ρ, kg/m³, > 0
  std::optional<OrthotropicParameters> orthotropic;
  std::optional<MaterialAxesParameters> axes;
  std::optional<MaterialDampingParameters> damping;
  double loss_factor = 0.0;  ///< η, >= 0

  MeshMaterialParameters() = default;
  MeshMaterialParameters(double modulus, double ratio, double mass_density)
      : youngs_modulus(modulus), poissons_ratio(ratio), density(mass_density) {}
  MeshMaterialParameters(
      const MaterialParameters& isotropic)  // NOLINT(google-explicit-constructor)
      : MeshMaterialParameters(isotropic.youngs_modulus, isotropic.poissons_ratio,
                               isotropic.density) {}
  static const Schema& schema();

  /// @param turn      from the frame of the mesh to that of the body, about z
  /// @param thickness of planar elements, m
  /// @throws ConfigError with key paths below the material
  ElementSection section(PlaneState state, const Eigen::Matrix2d& turn, double thickness) const;
};

}  // namespace stridor
