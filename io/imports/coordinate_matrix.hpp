// Matrices of CalculiX and Abaqus: an entry a line.
#pragma once

#include "io/imports/source_text.hpp"
#include "substructures/elements/labelled_matrix.hpp"

namespace stridor {

/// Reads "row column value", numbers from 1, as CalculiX writes .sti and .mas (the upper triangle)
/// and Abaqus with FORMAT=COORDINATE (both triangles).
/// @throws ConfigError with the place
LabelledMatrix read_coordinate_matrix(const SourceText& source);

/// Reads "node,dof, node,dof, value" as Abaqus writes with FORMAT=MATRIX INPUT; comments begin
/// with **, and the keyword *MATRIX ASSEMBLE may stand around it.
/// @throws ConfigError with the place
LabelledMatrix read_abaqus_matrix(const SourceText& source);

}  // namespace stridor
