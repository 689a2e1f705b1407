#include "substructures/bodies/realised_shape.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <complex>

#include "core/errors.hpp"

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

void require_real(const TestMode& mode, double most, const std::string& source) {
  const RealisedShape real = realise(mode);
  if (!(real.complexity > most)) return;
  throw ConfigError(
      Refusal::wrong_value, "complexity",
      fmt::format("{} is complex: {:.3g} % of its shape is out of phase, more than {:.3g} %; a "
                  "body of real modes cannot have it. Leave it out by `take`, or allow more",
                  source, 100.0 * real.complexity, 100.0 * most));
}

}  // namespace stridor
