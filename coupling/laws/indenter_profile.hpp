// The shape of a rigid axisymmetric indenter.
#pragma once

#include <limits>
#include <optional>
#include <vector>

#include "core/schema.hpp"
#include "coupling/kinematics/monotone_cubic.hpp"

namespace stridor {

enum class ProfileShape { paraboloid, sphere, table };

struct ProfileParameters {
  ProfileShape shape = ProfileShape::paraboloid;
  double radius = 0.0;          ///< R, m: of curvature at the tip; the unit of length of a table
  std::vector<double> radii;    ///< of a table, m, ascending from 0
  std::vector<double> heights;  ///< of a table, m, above the tip, from 0, not descending
  static const Schema& schema();
};

/// Height f(r) of an axisymmetric indenter above its tip.
///
///   paraboloid  f = r²/(2R)
///   sphere      f = R − (R² − r²)^½
///   table       monotone cubic through points
class IndenterProfile {
 public:
  /// @throws std::invalid_argument if the radius is not > 0 or a table does not ascend from (0, 0)
  explicit IndenterProfile(const ProfileParameters& parameters);

  ProfileShape shape() const { return parameters_.shape; }
  double radius() const { return parameters_.radius; }
  /// The radius at which the indenter ends, m; infinite for a paraboloid.
  double reach() const;

  /// f(r), m; infinite beyond reach().
  double height(double r) const;
  /// f'(r), r < reach().
  double slope(double r) const;

  /// Radius a of the contact with an elastic half-space, whatever its modulus (Sneddon):
  /// δ = a ∫₀^{π/2} f'(a sin θ) dθ.
  /// @param indentation δ > 0, m
  /// @return nothing where the indenter is in contact up to its end
  /// @throws std::invalid_argument if δ is not > 0
  std::optional<double> elastic_contact_radius(double indentation) const;
  /// δ by the same equation, m.
  /// @param contact_radius a, within (0, reach()]
  double elastic_indentation(double contact_radius) const;
  /// Its force over the composite modulus, F/E* = 2 (a δ − ∫₀^a δ(s) ds), m², since dF/dδ = 2 E* a.
  /// @param contact_radius a, within (0, reach()]
  double elastic_force(double contact_radius) const;

 private:
  ProfileParameters parameters_;
  std::optional<MonotoneCubic> table_;
};

}  // namespace stridor
