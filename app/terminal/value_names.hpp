// Names of the values of options in help and manual.
#pragma once

#include <CLI/CLI.hpp>

namespace stridor {

/// Gives every option of every verb that takes a text a name of its value, FILE or QUANTITY: options
/// of one name take the same in all verbs, but for those listed.
/// @throws std::logic_error where an option has none, which a developer has forgotten
void name_values(CLI::App& program);

}  // namespace stridor
