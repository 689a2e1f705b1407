// How far the reduced bodies of a scene answer from the full ones, as `precision` says it.
#pragma once

#include <string>
#include <vector>

#include "app/terminal/command.hpp"
#include "io/scene/scene.hpp"

namespace stridor {

/// reduction_errors() of a scene: a list with body, unknowns, interface, modes, compared, frequencies
/// and errors of each.
/// @param frequencies as written behind --frequencies; empty: the default of each body
/// @throws ConfigError, FileError, NumericalError, Interrupted
Json reductions_json(const LoadedScene& loaded, const std::vector<std::string>& frequencies);

/// The same as a table on stdout; nothing where no body is reduced.
void print_reductions(const Json& reductions);

}  // namespace stridor
