// Contact laws as tables in HDF5 files.
//
//     /                    attributes: of what, how and when
//     /speed               v τ_1/R, ascending
//     /indentation         y/R, ascending
//     /force, /area        F/(E_0* R²) and A/R², [indentation][speed]
//     /friction            likewise
//     /memory_in_cells     likewise: the shortest v τ_k over the side of a cell of the grid
#pragma once

#include <string>
#include <vector>

#include "coupling/laws/viscoelastic_law.hpp"
#include "io/hdf5/output_options.hpp"

namespace stridor {

/// Writes a table to a file of its own; the file takes its name when it is whole.
/// @param memory_in_cells of every contact, a row per indentation
/// @param attributes      of the root
/// @throws FileError if the file exists, its folder is not writable, or anything cannot be written
void write_law_table(const std::string& path, Overwrite overwrite, const ContactTable& table,
                     const std::vector<double>& memory_in_cells, const Attributes& attributes);

/// Reads such a table.
/// @throws FileError if there is none, it is damaged, or is not as ContactTable says
TabulatedLaw read_law_table(const std::string& path);

}  // namespace stridor
