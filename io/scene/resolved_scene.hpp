// Writes parameter structs back as the scene that gives them, defaults included.
#pragma once

#include <string>

#include "core/schema.hpp"

namespace stridor {

/// The scene text that reads back into exactly this struct.
///
/// Every key in the order of its declaration, defaults included; numbers in SI units without a
/// unit, in the shortest form that reads back to the same double. Expressions are written as their
/// values, parameters with the unit that they have. Left out are optionals that are
/// empty and numbers that are not finite, which can only be defaults standing for "not given".
///
/// @param schema declared keys
/// @param object the struct that `schema` describes, as filled by the reader. An optional section
/// with
///        required keys must be a std::optional member: a plain one would be written with values
///        that nobody gave.
/// @return YAML, one key per line, "{}\n" for a struct without keys
std::string resolved_yaml(const Schema& schema, const void* object);

/// The same for a struct with a static `schema()`.
template <class T>
std::string resolved_yaml(const T& object) {
  return resolved_yaml(T::schema(), &object);
}

}  // namespace stridor
