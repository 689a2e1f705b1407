// The reference page of scenes, made from the declared keys (core/schema.hpp).
#pragma once

#include <string>

#include "core/schema.hpp"

namespace stridor {

/// Markdown page with every key that a scene may hold: docs/scene_reference.md.
///
/// One section per map, in the order of declaration, headed by its key path; NAME denotes a name
/// that the user gives, N for the index in a list. Each has a table key | type | allowed | default
/// | meaning. A map that occurs at several paths is described at the first and linked from the
/// others.
std::string scene_reference(const Schema& schema);

}  // namespace stridor
