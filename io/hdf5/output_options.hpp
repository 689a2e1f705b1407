// Options common to all files that the program makes: when one may be replaced, and attributes.
#pragma once

#include <string>
#include <utility>
#include <variant>
#include <vector>

namespace stridor {

enum class Overwrite { no, yes };

/// Attributes of a file or a dataset: text or one number each.
using Attributes = std::vector<std::pair<std::string, std::variant<std::string, double>>>;

/// Checks whether a run file can be made, before anything expensive is computed for it.
/// @throws FileError as the constructor of RunFileWriter; the file is not touched
void check_output(const std::string& path, Overwrite overwrite);

/// Checks whether a file of this name may be made where there is one already.
/// @throws FileError if it exists and `overwrite` is no, or if another process is writing it
void check_replaceable(const std::string& path, Overwrite overwrite);

/// The scene that a command line names, its first word that ends in .yaml or .yml; empty without.
std::string scene_of_command(const std::string& command);

/// The present time as "2024-05-17T08:30:00Z".
std::string utc_now();

}  // namespace stridor
