// Meshes of Gmsh.
#pragma once

#include <string>

#include "io/imports/mesh_draft.hpp"

namespace stridor {

/// Reads a mesh of Gmsh: .msh of version 4.1 or 2.2, text or binary (little-endian).
///
/// Elements of the highest dimension in the file are the elements of the mesh; those of 3, 4, 6 and
/// 8 nodes in a plane, tetrahedra of 4 and 10, hexahedra of 8 and 20, prisms of 6 and 15. Physical
/// groups of that dimension are element sets. Those of one dimension less are surfaces and node
/// sets, lower ones node sets. Of a face between two elements, that side belongs to a surface whose
/// outward normal is the normal of the group's element. A group without a name is "group_<tag>".
/// Groups of the same name and different dimensions below the highest make one node set.
/// Orientation and volume of elements are not checked here. Other sections are skipped and listed.
///
/// @param source contents of the file; its name is used in messages
/// @throws ConfigError with line and column, or byte, if the file is of another format or version,
///     is incomplete or contradicts itself, or holds other types of elements or partitions
ImportedMesh read_gmsh_mesh(SourceText source);

}  // namespace stridor
