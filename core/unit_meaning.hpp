// Meaning of the text of a unit: a factor and powers of basic units, as UDUNITS-2 knows them.
#pragma once

#include <map>
#include <optional>
#include <string>

namespace stridor {

/// A unit as a factor times powers of basic units. The radian counts as a basic unit here: UDUNITS
/// holds it for dimensionless, which would turn 50 Hz into 50 rad/s.
struct UnitMeaning {
  double factor = 1.0;
  std::map<std::string, int> powers;
  bool is_scale = true;  ///< false for units with an offset or a logarithm (°C, dB)

  bool has_angle() const { return powers.contains("rad"); }
};

/// Meaning of a unit; nothing where the text is none.
/// @throws FileError if the database of units cannot be read
std::optional<UnitMeaning> meaning_of(const std::string& unit);

/// A value of one unit in another of the same powers.
double convert(double value, const UnitMeaning& from, const UnitMeaning& to);

/// "kg m-1 s-2" from the powers of basic units.
std::string unit_text(const UnitMeaning& meaning);

}  // namespace stridor
