// Rayleigh damping of one body, with the schedule by which its start-up is calmed.
#pragma once

#include <optional>

#include "core/schema.hpp"

namespace stridor {

/// C = α(t) M + β K (docs/theory.md, 1.1).
///
/// α is `alpha_start` until `hold`, falls linearly to `alpha` over the next `fade` seconds and
/// stays there. Without `alpha_start` it is `alpha` throughout.
struct RayleighDamping {
  double alpha = 0.0;                 ///< α, 1/s, >= 0
  double beta = 0.0;                  ///< β, s, >= 0
  std::optional<double> alpha_start;  ///< α before the fade, 1/s
  double hold = 0.0;                  ///< s
  double fade = 0.0;                  ///< s

  static const Schema& schema();

  double alpha_at(double time) const;
  /// Largest α over all times.
  double alpha_max() const;
  /// From this time on α no longer changes.
  double constant_from() const { return alpha_start ? hold + fade : 0.0; }
};

}  // namespace stridor
