// What a scene says about marching in time.
#pragma once

#include "core/schema.hpp"

namespace stridor {

enum class Integrator {
  central_difference,  ///< predictor-corrector of BDF: first order in h with damping
};

enum class Coordinates {
  modal,                ///< one recurrence per mode
  craig_bampton,        ///< the published dense form, line by line
  craig_bampton_fused,  ///< the same with constants folded in advance
};

struct TimeParameters {
  Integrator integrator = Integrator::central_difference;
  Coordinates coordinates = Coordinates::modal;
  double step = 0.0;  ///< h, s, > 0
  double end = 0.0;   ///< s, > 0
  static const Schema& schema();
};

}  // namespace stridor
