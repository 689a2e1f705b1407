// A key of a scene and the range in which a verb varies it.
#pragma once

#include <string>
#include <vector>

#include "app/terminal/command.hpp"
#include "io/scene/scene_family.hpp"

namespace stridor {

/// A range of one key, as written.
struct RangeOptions {
  std::string parameter;  ///< empty: the position at which the pair starts
  std::string from;
  std::string to;
  int points = 101;
};

/// The values of a key in a range.
/// @throws ConfigError as parse_value() and spaced_values(), or if the range ends before it starts
std::vector<double> range_values(const NumericKey& key, const RangeOptions& options,
                                 Spacing spacing);

/// --parameter, --from, --to, --points.
void add_range_options(CLI::App& verb, RangeOptions& options);

/// The unit of a key as it is printed and stored: "1/s" for "s-1", "kg/m^3" for "kg m-3", "1" where
/// dimensionless.
std::string printed_units(const NumericKey& key);

/// "contact.start = 0.05 m".
std::string value_text(const NumericKey& key, double value);

/// A key and the values at which eigenvalues are wanted.
struct KeyRange {
  NumericKey key;
  std::vector<double> values;  ///< strictly ascending
};

}  // namespace stridor
