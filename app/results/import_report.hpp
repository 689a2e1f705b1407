// What meshes and matrices turned out to be, as text and JSON.
#pragma once

#include "app/terminal/command.hpp"
#include "substructures/bodies/import_facts.hpp"

namespace stridor {

Json import_json(const ImportFacts& facts);

/// @param indent before each line
void print_import(const ImportFacts& facts, const std::string& indent);

}  // namespace stridor
