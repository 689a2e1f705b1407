// A spring in the place of a closed gap.
#pragma once

#include "coupling/laws/normal_law_type.hpp"

namespace stridor {

/// λ_n = −k gap.
inline NormalLawType penalty_law_type() {
  return {.name = "penalty",
          .doc = "a spring of `stiffness` at each slave point",
          .keys = {{"stiffness",
                    {.doc = "Of a penalty, per slave point.",
                     .unit = "N m-1",
                     .range = Range::positive()}},
                   preload_key()},
          .spring = "stiffness"};
}

}  // namespace stridor
