// What the program says of scenes of all kinds.
#pragma once

#include <string>

namespace stridor {

/// JSON Schema and reference page of scenes of all kinds: docs/scene.schema.json and
/// docs/scene_reference.md.
std::string all_scenes_json_schema();
std::string all_scenes_reference();

}  // namespace stridor
