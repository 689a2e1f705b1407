// Sparse matrices in the Harwell-Boeing exchange format, as ANSYS writes them (HBMAT).
#pragma once

#include "io/imports/source_text.hpp"
#include "substructures/elements/labelled_matrix.hpp"

namespace stridor {

/// Whether a text begins as such a file does: its third line says the type of the matrix.
bool is_harwell_boeing(std::string_view text);

/// Reads an assembled real matrix, symmetric (RSA: one triangle) or not (RUA). Its rows are
/// equations by number; ANSYS says in a file .mapping what they are.
/// @throws ConfigError with the place
LabelledMatrix read_harwell_boeing(const SourceText& source);

}  // namespace stridor
