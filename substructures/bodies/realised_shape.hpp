// Real shapes of modes that a test delivers as complex ones.
#pragma once

#include "substructures/bodies/modal_test.hpp"

namespace stridor {

/// The real shape nearest to a complex one: turned in phase so that most of it is real.
struct RealisedShape {
  double phase = 0.0;       ///< rad, by which it is turned back
  double complexity = 0.0;  ///< ‖Im‖/‖all‖ after that; 0 of a real shape, up to 1/√2
};
RealisedShape realise(const TestMode& mode);

}  // namespace stridor
