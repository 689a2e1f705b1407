// Rigid masses on springs and dampers.
#pragma once

#include <map>
#include <optional>
#include <string>
#include <vector>

#include "core/schema.hpp"
#include "substructures/body_parameters.hpp"

namespace stridor {

/// A mass that moves without turning; also the point of its name.
struct LumpedMassParameters {
  double mass = 0.0;       ///< kg, > 0
  std::vector<double> at;  ///< x and y in the frame of the body, m; empty: its origin
  static const Schema& schema();
};

/// A spring with a damper beside it, along one direction.
struct LumpedSpringParameters {
  std::vector<std::string> at;      ///< one mass: to the ground; two: between them
  double stiffness = 0.0;           ///< N/m, >= 0
  double damping = 0.0;             ///< N s/m, >= 0
  std::optional<double> direction;  ///< against +x, rad; default: from mass to mass, else 0
  static const Schema& schema();
};

/// Proportional damping besides that of the springs, constant in time.
struct LumpedDampingParameters {
  double alpha = 0.0;  ///< 1/s, >= 0
  double beta = 0.0;   ///< s, >= 0
  static const Schema& schema();
};

/// M = diag(m), K = Σ k d dᵀ and C = α M + β K + Σ c d dᵀ over the springs, d the unit vector along
/// a spring with the opposite sign at its second mass (docs/theory.md, 1.6).
struct LumpedParameters : BodyParametersOf<LumpedParameters> {
  static constexpr const char* type_name = "lumped";

  std::map<std::string, LumpedMassParameters> masses;
  std::map<std::string, LumpedSpringParameters> springs;
  std::vector<std::string> moves{"x", "y"};  ///< directions in which the masses move
  LumpedDampingParameters damping;
  /// Mass on which the drive's load acts; the drive then moves the ground of the springs.
  std::optional<std::string> guided;
  static const Schema& schema();

  BodyMatrices make() const override;
};

}  // namespace stridor
