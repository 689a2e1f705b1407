// Units of a universal file.
#pragma once

#include <string>

#include "io/imports/uff_lines.hpp"

namespace stridor {

/// What values of the file are divided by to be in SI units.
struct UffUnits {
  double length = 1.0;
  double force = 1.0;
  bool is_given = false;
  /// Of mass: force per length at the same time.
  double mass() const { return force / length; }
};

/// The factors of a dataset 164.
/// @throws ConfigError if they are none
UffUnits read_uff_units(const UffDataset& dataset);

/// "file:line" of a place.
std::string place_text(const TextPlace& place);

}  // namespace stridor
