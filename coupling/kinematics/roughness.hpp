// Random roughness of a master surface.
#pragma once

#include <cstdint>
#include <vector>

namespace stridor {

class Schema;

/// Parameters of the roughness of a master in a scene.
struct RoughnessParameters {
  double rms = 0.0;                 ///< of the height, m, ≥ 0
  double correlation_length = 0.0;  ///< ℓ of the autocorrelation exp(−(d/ℓ)²), m, > 0
  std::int64_t seed = 0;            ///< ≥ 0; another seed, another surface of the same kind
  static const Schema& schema();
};

/// Height and slope of a rough surface at one place.
struct RoughnessHeight {
  double value = 0.0;  ///< z, m, out of the master
  double slope = 0.0;  ///< dz/ds
};

/// A random profile z(s) over the arc length of the undeformed master, stationary and Gaussian with
/// mean zero (docs/theory.md, 2.6):
///
///   ⟨z(s) z(s + d)⟩ = rms² exp(−(d/ℓ)²),   ⟨z'²⟩ = 2 rms²/ℓ²
///
/// A twice continuously differentiable cubic spline with knots ℓ/8 apart, whose coefficients are
/// white noise smoothed by a Gaussian. The noise of a knot is a function of seed and number of the
/// knot alone, in integer arithmetic: profiles are the same on every machine but for rounding, and
/// a longer master continues a shorter one.
class Roughness {
 public:
  /// A surface without: z = 0.
  Roughness() = default;
  /// @param length of the master, m, > 0
  /// @throws std::invalid_argument if the correlation length is not positive or below
  ///         length/max_correlation_lengths
  Roughness(const RoughnessParameters& parameters, double length);

  /// Knots grow with the length of the master by the correlation length: 8 bytes each.
  static constexpr double max_correlation_lengths = 1e6;

  bool is_smooth() const { return coefficients_.empty(); }
  /// @param arc along the undeformed master from its first node, m; beyond the ends the spline goes
  ///            on with its last piece
  /// Cost: some twenty operations.
  RoughnessHeight at(double arc) const {
    if (is_smooth()) return {};
    return height_at(arc);
  }

 private:
  RoughnessHeight height_at(double arc) const;

  double knots_per_metre_ = 0.0;
  std::vector<double> coefficients_;  ///< of cubic B-splines, the first one a knot before s = 0
};

}  // namespace stridor
