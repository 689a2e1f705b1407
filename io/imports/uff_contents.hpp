// What a universal file holds.
#pragma once

#include <cstddef>
#include <map>
#include <string>
#include <vector>

#include "io/imports/uff_functions.hpp"
#include "io/imports/uff_units.hpp"
#include "substructures/bodies/modal_test.hpp"

namespace stridor {

/// All that is read of a universal file, and how many datasets there are of each number.
struct UffHoldings {
  std::map<int, std::size_t> datasets;
  UffUnits units;
  ModalTest shapes;  ///< nodes and modes, in SI units
  std::vector<UffFunction> functions;
  std::vector<std::string> remarks;
};

/// "mode shapes and other data at nodes" of 55; "passed over" of a dataset that is not read.
std::string dataset_words(int number);

/// @throws ConfigError with the place in the file and what was expected; if there is no dataset
UffHoldings read_uff_holdings(const SourceText& source);

/// @throws ConfigError as read_uff_holdings(); FileError
UffHoldings read_uff_holdings_file(const std::string& path);

}  // namespace stridor
