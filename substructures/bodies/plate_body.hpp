// Annular plates that may spin, as bodies of a scene.
#pragma once

#include <map>
#include <optional>
#include <string>
#include <vector>

#include "substructures/bodies/annular_plate.hpp"
#include "substructures/bodies/body_parameters.hpp"

namespace stridor {

/// A place on a plate, at rest in space.
struct PlatePointParameters {
  double radius = 0.0;  ///< m, between the edges
  double angle = 0.0;   ///< rad
  static const Schema& schema();
};

/// C = α M + β K of the material of a plate, constant in time.
struct PlateDampingParameters {
  double alpha = 0.0;  ///< 1/s, >= 0
  double beta = 0.0;   ///< s, >= 0
  static const Schema& schema();
};

/// An annular plate in the coordinates of its modes, as seen from space (AnnularPlate;
/// docs/theory.md, 10.1):
///
///   q̈ + (C + 2Ω S) q̇ + (diag(ω²) − Ω² SᵀS + Ω C S) q = f,  C = α + β diag(ω²)
///
/// Its damping acts on what a particle sees, q̇ + Ω S q. The body's frame is unrolled: y is the axis
/// of the plate, x the outer radius times the angle, z the radius beyond the outer one; FaceSeat
/// (models/face_seats.hpp) rolls it into space. Nodes on circles, for figures, and points move
/// along y only. Faces: `top`, of larger y, and `bottom`.
struct PlateBodyParameters : BodyParametersOf<PlateBodyParameters> {
  static constexpr const char* type_name = "annular_plate";

  AnnularPlateParameters plate;
  double spin = 0.0;  ///< Ω towards growing angles, rad/s, >= 0
  PlateDampingParameters damping;
  bool centrifugal = false;  ///< whether the stress of the rotation stiffens the plate
  std::map<std::string, PlatePointParameters> points;
  static const Schema& schema();

  BodyMatrices make() const override;
  bool has_face(const std::string& name) const override {
    return name == "top" || name == "bottom";
  }
  std::vector<DrawnElement> elements() const override;
  double num_slave_nodes(const std::string& /*name*/) const override { return 0.0; }
  ReductionSize reduction_size(double interface_nodes) const override;
  SizeKey size_key() const override;
};

}  // namespace stridor
