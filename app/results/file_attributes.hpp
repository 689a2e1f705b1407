// Attributes of files of results: their origin, and single numbers.
#pragma once

#include <string>

#include "app/terminal/command.hpp"
#include "io/hdf5/output_options.hpp"
#include "io/scene/scene.hpp"

namespace stridor {

/// Attributes of the root: the scene with its hash and as resolved, the command, version and commit of the
/// program, and the date.
Attributes source_attributes(const LoadedScene& loaded, const std::string& command_line);

/// Results as attributes, the names of those within others joined by dots: "x.rms".
void append_results(const Json& results, Attributes& attributes);

}  // namespace stridor
