// Where a scene has the viscoelastic laws of its contacts evaluated.
#pragma once

#include <vector>

#include "core/schema.hpp"

namespace stridor {

/// Speeds and indentations, or loads, at which contacts are computed; all dimensionless.
struct SlidingPoints {
  std::vector<double> speeds;        ///< v̂ = v τ_1/R, of either sign
  std::vector<double> indentations;  ///< ŷ = y/R > 0
  std::vector<double> loads;         ///< F̃ = F/(E_0* R²) > 0; instead of indentations
  static const Schema& schema();
};

}  // namespace stridor
