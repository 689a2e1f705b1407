// The file of a study of errors and run times.
#pragma once

#include <filesystem>

#include "app/runs/precision.hpp"

namespace stridor {

inline constexpr const char* precision_file_name = "precision.h5";

/// Writes the JSON object of `precision` as columns: a row for each setting in `/settings`, and one
/// for each reduced body and frequency in `/reduction`.
/// @param object of precision_json(), or that of events: with `rows`, `reference` and perhaps
///               `reduction`, `tune`
/// @throws FileError if it cannot be written
void write_precision_file(const std::filesystem::path& path, const Json& object,
                          const PrecisionOptions& options, const LoadedScene& loaded);

}  // namespace stridor
