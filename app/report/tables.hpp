// Tables of a report.
#pragma once

#include <string>
#include <vector>

#include "app/report/report_section.hpp"

namespace stridor {

/// A column of a table: numbers in one unit, or words.
struct TableColumn {
  std::string name;
  std::string units;
  std::vector<double> values;
  std::vector<std::string> texts{};  ///< instead of values
  int digits = 6;
};

/// A table as a view of the page. @param columns of the same length, at least one
Json table_view(const std::string& title, const std::vector<TableColumn>& columns);

/// An array of a file that is to be a column.
struct WantedColumn {
  std::string path;
  std::string name;
  int digits = 6;
};

/// The arrays of a file as columns, those that it lacks left out.
/// @throws FileError if one is unlike the others in length
std::vector<TableColumn> columns_in(const ResultFile& file,
                                    const std::vector<WantedColumn>& wanted);

}  // namespace stridor
