// What a scene describes, as a picture: bodies, supports, contacts, drives and points.
#pragma once

#include <string>

#include "io/figures/mesh_picture.hpp"
#include "io/scene/length_unit.hpp"
#include "models/placed_model.hpp"

namespace stridor {

/// Bodies where a scene puts them, with their meshes, what is held and guided, masters with their
/// normals, slave points, motions and loads of drives, and named points.
///
/// Planar bodies are seen in their plane. Where a body has volumes, or contacts are on the face of a
/// spinning body, all are seen from above, with the axis of that body upwards. Of a body without
/// elements and outlines the nodes are shown, and which of them its stiffness joins.
/// @param recorded names, "<body>.<point>", of points whose motion is recorded
MeshPicture make_scene_picture(const PlacedModel& model, const std::vector<std::string>& recorded,
                               const LengthUnit& unit, const std::string& caption);

}  // namespace stridor
