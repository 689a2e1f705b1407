// Files of matrices of any format that is read.
#pragma once

#include <string>

#include "io/imports/source_text.hpp"
#include "substructures/elements/labelled_matrix.hpp"

namespace stridor {

/// Reads a matrix in the format that its first lines show: Matrix Market, CalculiX (.sti, .mas),
/// Abaqus (*MATRIX OUTPUT), Harwell-Boeing as of ANSYS, or DMIG of Nastran.
/// @param purpose which one is meant where the file holds several
/// @throws ConfigError with the place
LabelledMatrix read_matrix_text(SourceText source, MatrixPurpose purpose);

/// @throws FileError if the file is not there, no regular one, or empty; ConfigError as
///         read_matrix_text()
LabelledMatrix read_matrix_file(const std::string& path, MatrixPurpose purpose);

}  // namespace stridor
