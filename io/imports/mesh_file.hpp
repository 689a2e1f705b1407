// Mesh files of any format that is read.
#pragma once

#include <string>

#include "io/imports/mesh_draft.hpp"

namespace stridor {

/// Reads a mesh of Gmsh, or one of Abaqus or CalculiX with the files that it includes.
///
/// The first bytes decide; where they say nothing, the ending .msh or .inp. Included files are
/// looked for in the folder of the file that names them. Needs about twice the memory of the file
/// besides the mesh.
///
/// @throws FileError if the file is not there, no regular one, empty, or of no format that is read
/// @throws ConfigError as read_gmsh_mesh() and read_inp_mesh()
ImportedMesh read_mesh_file(const std::string& path);

}  // namespace stridor
