// Numerical settings of the boundary elements behind a viscoelastic normal law.
#pragma once

#include <cstdint>

#include "core/schema.hpp"

namespace stridor {

/// Numerical settings of a SlidingContact.
struct SlidingContactParameters {
  std::int64_t grid = 128;        ///< N, cells a side of the window, even, 16 to 4096
  double window = 1.1;            ///< half-width of the window over the elastic contact radius, > 1
  double tolerance = 1e-7;        ///< residual displacement over the indentation, in (0, 0.1)
  std::int64_t max_rounds = 100;  ///< sets of contact cells that are tried, ≥ 1
  static const Schema& schema();
};

}  // namespace stridor
