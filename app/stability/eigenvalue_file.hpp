// The file of eigenvalues at one position.
#pragma once

#include <string>

#include "app/stability/analysed_spectrum.hpp"
#include "io/hdf5/output_options.hpp"

namespace stridor {

/// Writes a file of the kind `eigenvalues`: the eigenvalues, the sliding equilibrium about which they
/// are, and why a mode grows where that was asked for (docs/files.md).
/// @param explanation of one mode, as `eig --explain` prints it; null: none
/// @param attributes  of the root, among them where the file comes from
/// @throws FileError if the file exists and may not be overwritten, or cannot be written
void write_eigenvalue_file(const std::string& path, Overwrite overwrite, const Analysis& analysis,
                           const Json& explanation, Attributes attributes);

}  // namespace stridor
