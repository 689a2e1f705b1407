// Matrices in the punch files of Nastran (DMIG, as EXTSEOUT writes them), with their grid points.
#pragma once

#include "io/imports/source_text.hpp"
#include "substructures/elements/labelled_matrix.hpp"

namespace stridor {

/// Whether a text begins as bulk data of Nastran does.
bool is_nastran_bulk(std::string_view text);

/// Reads one matrix out of the DMIG entries of bulk data, in fields of 8 or 16 columns or between
/// commas, and the grid points beside it. Names of stiffness matrices begin with K, but for K4 of
/// structural damping, of mass matrices with M, of viscous damping with B; of purpose `any` there
/// must be one matrix only. Other entries are passed over.
/// @throws ConfigError with the place, and the names that are there where none is meant
LabelledMatrix read_nastran_punch(const SourceText& source, MatrixPurpose purpose);

}  // namespace stridor
