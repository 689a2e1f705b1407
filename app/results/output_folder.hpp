// A folder that a verb fills with figures and a JSON file.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "app/terminal/command.hpp"
#include "io/run_file/run_file.hpp"

namespace stridor {

/// Makes the folder where it is missing.
/// @param names files that will be made in it
/// @throws FileError if it cannot be made, or if one of the files exists and may not be overwritten
void prepare_folder(const std::filesystem::path& folder, const std::vector<std::string>& names,
                    Overwrite overwrite);

/// @throws FileError if it cannot be written
void write_json(const std::filesystem::path& path, const Json& object);

}  // namespace stridor
