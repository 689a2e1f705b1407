// Units of a universal file.
#pragma once

#include <string>
#include <vector>

#include "io/imports/uff_lines.hpp"

namespace stridor {

/// What values of the file are divided by to be in SI units.
struct UffUnits {
  double length = 1.0;
  double force = 1.0;
  bool is_given = false;
  std::string name{};  ///< as the file has it: "SI: m, N, kg"
  /// Of mass: force per length at the same time.
  double mass() const { return force / length; }
};

/// The factors of a dataset 164.
/// @throws ConfigError if they are none
UffUnits read_uff_units(const UffDataset& dataset);

/// Those of a file; SI where it gives none.
/// @throws ConfigError as read_uff_units()
UffUnits units_in(const std::vector<UffDataset>& datasets);

/// What is remarked of a file that gives none.
constexpr const char* no_units = "has no units (dataset 164); they are taken to be SI";

/// "file:line" of a place.
std::string place_text(const TextPlace& place);

}  // namespace stridor
