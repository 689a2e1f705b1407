// Pictures of meshes with their surfaces in colours.
#pragma once

#include <filesystem>
#include <string>

#include "substructures/elements/mesh.hpp"

namespace stridor {

/// Draws a mesh: a planar one as it lies, one of volumes in parallel projection from a direction
/// between its axes, sides that face away left out and those further away covered by nearer ones.
/// Named surfaces have colours of their own. Of more sides than can be drawn singly the edges are
/// left out.
/// @param mesh in metres, with elements
/// @throws std::invalid_argument if it has no elements
/// @throws ConfigError, FileError as draw_figure()
void plot_mesh(const Mesh& mesh, const std::string& caption, const std::filesystem::path& figure);

}  // namespace stridor
