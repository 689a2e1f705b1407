// The gap closed exactly, by a Lagrange multiplier.
#pragma once

#include "coupling/laws/normal_law_type.hpp"

namespace stridor {

/// gap = 0.
inline NormalLawType multiplier_law_type() {
  return {.name = "multiplier", .doc = "the gap is closed exactly", .keys = {preload_key()}};
}

}  // namespace stridor
