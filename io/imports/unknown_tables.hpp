// Tables of what rows of matrices are, and of places of nodes.
#pragma once

#include <string>

#include "io/imports/source_text.hpp"
#include "substructures/elements/labelled_matrix.hpp"

namespace stridor {

/// Reads which row is which displacement of which node: .dof of CalculiX ("12.3" a line), .mapping
/// of ANSYS (equation, node, label), or a table of one's own, "node, direction" or "node,
/// direction, x, y, z" a line in the order of the rows, with a head or without. Directions are 1 to
/// 6, or x, y, z, rx, ry, rz.
/// @throws ConfigError with the place
UnknownTable read_unknown_table(const SourceText& source);

/// Reads "node, x, y, z" or "node, x, y" a line; lines that begin with # and a head are passed over,
/// and the angles of NLIST of ANSYS must be 0.
/// @throws ConfigError with the place
NodeTable read_node_table(const SourceText& source);

/// @throws FileError if the file is not there, no regular one, or empty; ConfigError as above
UnknownTable read_unknown_file(const std::string& path);
NodeTable read_node_file(const std::string& path);

}  // namespace stridor
