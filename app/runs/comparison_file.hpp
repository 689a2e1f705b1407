// The file of a comparison of contact assumptions.
#pragma once

#include <filesystem>

#include "app/terminal/command.hpp"
#include "io/hdf5/output_options.hpp"

namespace stridor {

/// Writes a file of the kind `comparison of assumptions`, a row for each run (docs/files.md).
/// @param rows       of comparison.json
/// @param attributes of the root: where the file comes from
/// @throws FileError if it exists and may not be overwritten, or cannot be written
void write_comparison_file(const std::filesystem::path& path, Overwrite overwrite, const Json& rows,
                           const Attributes& attributes);

}  // namespace stridor
