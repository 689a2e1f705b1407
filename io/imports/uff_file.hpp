// Universal files (UFF): nodes, units and mode shapes of a modal test.
#pragma once

#include <string>
#include <vector>

#include "io/imports/source_text.hpp"
#include "io/imports/uff_lines.hpp"
#include "substructures/bodies/modal_test.hpp"

namespace stridor {

/// Reads datasets 15 and 2411 (nodes), 82 (trace lines), 2412 (elements), 164 (units) and 55
/// (shapes at nodes: normal and complex modes) of a universal file in ASCII; other datasets are
/// passed over, binary ones (58b) too.
///
/// Tolerated: line ends of any system, a last dataset that is not closed, numbers without blanks
/// between them in columns of 13 (E13.5) or 10, exponents with D, a delimiter right behind binary
/// data, texts in any encoding.
/// @throws ConfigError with the place in the file and what was expected
ModalTest read_uff(const SourceText& source);

/// Nodes and modes of the datasets of a file, with remarks; may be none.
/// @throws ConfigError with the place in the file and what was expected
ModalTest modal_test_in(const std::vector<UffDataset>& datasets);

/// @throws ConfigError as read_uff(); FileError
ModalTest read_uff_file(const std::string& path);

}  // namespace stridor
