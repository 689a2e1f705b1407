// Contents of a universal file, as text and JSON.
#pragma once

#include <string>

#include "app/terminal/command.hpp"
#include "io/imports/uff_contents.hpp"

namespace stridor {

Json universal_json(const UffHoldings& held);

/// Prints it, with what a scene or a command would say of the file.
void print_universal(const UffHoldings& held, const std::string& file);

}  // namespace stridor
