#include "substructures/bodies/realised_shape.hpp"

#include <algorithm>
#include <cmath>

namespace stridor {

RealisedShape realise(const TestMode& mode) {
  // ∑ φ² is largest in size, and real, where the shape is turned back by half of its angle.
  std::complex<double> squares = 0.0;
  double size = 0.0;
  for (const auto& [node, values] : mode.shape) {
    for (const std::complex<double>& value : values) {
      squares += value * value;
      size += std::norm(value);
    }
  }
  RealisedShape real;
  if (!mode.is_complex || size == 0.0) return real;
  real.phase = 0.5 * std::arg(squares);
  real.complexity = std::sqrt(std::max(0.0, 0.5 * (1.0 - std::abs(squares) / size)));
  return real;
}

}  // namespace stridor
