// Smooth functions in the place of the sign of the slip velocity.
#pragma once

#include <cmath>
#include <numbers>

namespace stridor {

/// Regularised friction, for comparison with set-valued friction, which it only resembles: friction
/// −s(v/v_ε) F instead of −sign(v) F, with no sticking but creep at |v| < v_ε.
///
///   tanh          s(u) = tanh u
///   linear        s(u) = u for |u| < 1, else ±1
///   square_root   s(u) = u/(1 + u²)^½
///   atan          s(u) = (2/π) arctan u
struct RegularisedSign {
  enum class Kind { none, tanh, linear, square_root, atan };

  Kind kind = Kind::none;  ///< none: the sign itself, set-valued at rest
  double speed = 1.0;      ///< v_ε > 0

  bool is_set_valued() const { return kind == Kind::none; }

  struct Value {
    double value = 1.0;  ///< in [0, 1]
    double slope = 0.0;  ///< by |v|
  };
  /// s and its derivative by |v|, at |v|.
  Value at(double magnitude) const {
    const double u = magnitude / speed;
    switch (kind) {
      case Kind::none:
        return {};
      case Kind::tanh: {
        const double s = std::tanh(u);
        return {s, (1.0 - s * s) / speed};
      }
      case Kind::linear:
        return u < 1.0 ? Value{u, 1.0 / speed} : Value{};
      case Kind::square_root: {
        const double root = std::sqrt(1.0 + u * u);
        return {u / root, 1.0 / (root * root * root * speed)};
      }
      case Kind::atan:
        return {2.0 * std::numbers::inv_pi * std::atan(u),
                2.0 * std::numbers::inv_pi / ((1.0 + u * u) * speed)};
    }
    return {};
  }
};

}  // namespace stridor
