// Meshes of Abaqus and CalculiX.
#pragma once

#include "io/imports/inp_lines.hpp"
#include "io/imports/mesh_draft.hpp"

namespace stridor {

/// Reads the mesh of an input of Abaqus or CalculiX (.inp).
///
/// *NODE, *ELEMENT, *NSET, *ELSET, *SURFACE (of elements and sides, or of nodes, which is a node
/// set), *INCLUDE and INPUT=. Elements of types with the nodes of C3D4, C3D10, C3D6, C3D15, C3D8,
/// C3D20, CPS3, CPS6, CPS4 and CPS8; not planar ones beside volumes. One part with one instance at
/// its place; names as "PART-1-1.SET" work. Sets and surfaces of the part are called so, too, where
/// the assembly has the same name; names keep the letters with which they first stand. Nodes of the
/// assembly itself (reference points) are passed over; sets may lose nodes that no element uses.
/// Numbers that GENERATE counts and that are not defined are passed over. Keywords without nodes,
/// elements or sets are skipped and listed; those that make or move nodes or elements are refused.
///
/// @param source contents of the file; its name is used in messages
/// @param reader of included files; none: they are refused
/// @throws ConfigError with line and column, if something is wrong or is not supported
ImportedMesh read_inp_mesh(SourceText source, IncludeReader reader = {});

}  // namespace stridor
