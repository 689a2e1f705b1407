// Matrices as text: Matrix Market files, and rows of numbers.
#pragma once

#include <istream>
#include <string>
#include <vector>

#include "substructures/matrices/body_matrices.hpp"

namespace stridor {

/// Reads a real matrix in the Matrix Market exchange format.
///
/// Coordinate and array, real and integer, general, symmetric and skew-symmetric. Strict: an entry
/// out of bounds, given twice, or above the diagonal of a symmetric matrix, and anything left over
/// at the end are errors.
///
/// @param source name of the text in messages
/// @throws ConfigError with source, line and column
SparseMatrix read_matrix_market(std::istream& text, const std::string& source);

/// A square matrix from rows like "1 0 -2.5".
/// @throws std::invalid_argument saying which row is wrong
SparseMatrix parse_matrix_rows(const std::vector<std::string>& rows);

}  // namespace stridor
