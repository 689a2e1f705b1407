// Real shapes of modes that a test delivers as complex ones.
#pragma once

#include <string>

#include "substructures/bodies/modal_test.hpp"

namespace stridor {

/// The real shape nearest to a complex one: turned in phase so that most of it is real.
struct RealisedShape {
  double phase = 0.0;       ///< rad, by which it is turned back
  double complexity = 0.0;  ///< ‖Im‖/‖all‖ after that; 0 of a real shape, up to 1/√2
};
RealisedShape realise(const TestMode& mode);

/// @param most   complexity that is allowed
/// @param source of the mode, for the message
/// @throws ConfigError at `complexity` if more of the shape is out of phase
void require_real(const TestMode& mode, double most, const std::string& source);

}  // namespace stridor
