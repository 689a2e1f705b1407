// Numbers of a scene that can be varied, and their values.
#pragma once

#include <string>
#include <vector>

#include "core/schema.hpp"
#include "io/scene/scene.hpp"

namespace stridor {

/// A number of a scene that can be varied.
struct NumericKey {
  std::string path;  ///< "contact.friction.coefficient"
  std::string unit;  ///< SI; empty: dimensionless
  Range range;
  bool is_integer = false;
};

/// Whether a key is one of the scene's `parameters`, on which other keys may depend.
bool is_parameter(const NumericKey& key);

/// The key at a path, which need not be written in the scene where it is optional; a parameter has
/// the path "parameters.<name>" and the unit in which it is written.
///
/// @param option where the path was written, for messages
/// @throws ConfigError with a suggestion if the path leads nowhere, if the key is not a number, or
///         if it is a parameter that no expression uses
NumericKey find_numeric_key(const Scene& scene, const std::string& path, const std::string& option);
/// The same in a scene of any kind.
/// @param schema its keys
/// @param object the struct that they describe
NumericKey find_numeric_key(const Schema& schema, const void* object, const std::string& path,
                            const std::string& option);

/// A value of a key as the user wrote it, with or without a unit.
/// @param option where it was written, for messages
/// @throws ConfigError if it is no such number, not whole where the key is, or out of range
double parse_value(const NumericKey& key, const std::string& text, const std::string& option);

enum class Spacing { linear, logarithmic };

/// `count` values from `from` to `to`, both included; one where they are equal.
/// @throws ConfigError if `count` is too small, values of an integer key are not whole, or those of
///         a logarithmic scale are not positive
std::vector<double> spaced_values(const NumericKey& key, double from, double to, int count,
                                  Spacing spacing);

}  // namespace stridor
