// Rigid masses on springs and dampers.
#pragma once

#include <map>
#include <optional>
#include <string>
#include <vector>

#include "core/schema.hpp"
#include "substructures/bodies/body_parameters.hpp"
#include "substructures/bodies/spring_stiffness.hpp"

namespace stridor {

/// A mass that moves without turning; also the point of its name.
struct LumpedMassParameters {
  double mass = 0.0;       ///< kg, > 0
  std::vector<double> at;  ///< x, y and z (or x and y) in the frame of the body, m; empty: its origin
  static const Schema& schema();
};

/// A spring with a damper beside it.
struct LumpedSpringParameters {
  std::vector<std::string> at;  ///< one mass: to the ground; two: between them
  SpringMatrixParameters stiffness;
  std::optional<DamperMatrixParameters> damping;
  /// Of a stiffness and damping along one; default: from mass to mass, else x.
  std::optional<SpringDirectionParameters> direction;
  static const Schema& schema();
};

/// Proportional damping besides that of the springs, constant in time.
struct LumpedDampingParameters {
  double alpha = 0.0;  ///< 1/s, >= 0
  double beta = 0.0;   ///< s, >= 0
  static const Schema& schema();
};

/// M = diag(m), K = Σ B k Bᵀ and C = α M + β K + Σ B c Bᵀ over the springs with their matrices k and
/// c, 3 x 3; B picks the displacement of a spring's first mass less that of its second
/// (docs/theory.md, 1.6).
struct LumpedParameters : BodyParametersOf<LumpedParameters> {
  static constexpr const char* type_name = "lumped";

  std::map<std::string, LumpedMassParameters> masses;
  std::map<std::string, LumpedSpringParameters> springs;
  std::vector<std::string> directions{"x", "y"};  ///< in which the masses move
  LumpedDampingParameters damping;
  /// Mass on which the drive's load acts; the drive then moves the ground of the springs.
  std::optional<std::string> guided;
  static const Schema& schema();

  BodyMatrices make() const override;
};

}  // namespace stridor
