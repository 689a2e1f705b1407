// Meshes of geometries by gmsh, run as a program of its own.
#pragma once

#include <string>

#include "substructures/bodies/body_files.hpp"

namespace stridor {

/// Divides a geometry into elements, or finds the mesh that was made of it before.
///
/// The mesh is kept beside the geometry as `<name>-<16 digits>.msh`, the digits being a checksum of
/// the geometry, of the files that a script includes or merges, and of the options: as long as that
/// file is there the mesh is the same, whatever gmsh would make of it by now. Its last lines say
/// which version of gmsh made it. Where the user may not write beside the geometry, as with the
/// scenes of an installed package, it is kept in `stridor/` of XDG_CACHE_HOME, or of `~/.cache`.
///
/// `options.size` and `options.order` are set after a script has been read, and so replace its own
/// Mesh.MeshSizeMax and Mesh.ElementOrder; a script finds the size as the variable `mesh_size`.
///
/// @param geometry of an ending that is_geometry() knows
/// @return path of the mesh, from the root
/// @throws FileError if gmsh is not installed, fails or complains (its message is in the error),
/// the
///         geometry cannot be read, or the mesh cannot be written
std::string mesh_with_gmsh(const std::string& geometry, const MeshingOptions& options);

}  // namespace stridor
