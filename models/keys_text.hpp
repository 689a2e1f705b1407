// The keys of parameters as text, by which what was made of them is found again.
#pragma once

#include <string>

#include "core/schema.hpp"

namespace stridor {

/// The keys of a struct and what they hold, in the order of their declaration: equal for equal
/// parameters, different for different ones.
/// @param object the struct that the schema describes
std::string keys_text(const Schema& schema, const void* object);

}  // namespace stridor
