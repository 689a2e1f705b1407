// Numbers with units, as users write them: "75 mm", "2.38 GPa", "150 deg".
#pragma once

#include <stdexcept>
#include <string>

#include "core/refusals.hpp"

namespace stridor {

/// A text is no number with a unit as it was wanted.
class QuantityError : public std::invalid_argument {
 public:
  QuantityError(Refusal refusal, const std::string& message)
      : std::invalid_argument(message), refusal_(refusal) {}

  /// wrong_unit where a number has a unit that is unknown or of another kind, else wrong_value.
  Refusal refusal() const { return refusal_; }

 private:
  Refusal refusal_;
};

/// Reads a number, with or without a unit, and returns it in the given SI unit.
///
/// A bare number is taken to be in that unit already. A number with a unit is converted after a
/// check of its dimension; angles are in rad ("deg", "°", "rad"), frequencies in Hz.
///
/// @param text what the user wrote
/// @param unit SI unit of the result as UDUNITS-2 reads it, e.g. "m", "Pa", "kg m-3"; empty:
/// dimensionless
/// @throws QuantityError with a message of one line (not a number; not finite; unknown unit; wrong
///         dimension), without the place, which only the caller knows
double parse_quantity(const std::string& text, const std::string& unit);

/// A number in a unit made of basic SI units.
struct Quantity {
  double value = 0.0;
  std::string unit;  ///< "m", "kg m-1 s-2"; empty: dimensionless
};

/// Reads a number with any unit and converts it to basic SI units: "2 GPa" is 2e9 kg m-1 s-2.
/// @throws QuantityError as parse_quantity(), but for the dimension
Quantity parse_any_quantity(const std::string& text);

}  // namespace stridor
