// Numbers of rows of JSON as columns of a file.
#pragma once

#include <span>
#include <string>
#include <vector>

#include "app/terminal/command.hpp"
#include "io/results/column_file.hpp"

namespace stridor {

/// A number that every row has.
struct RowNumber {
  const char* path;  ///< of the column
  const char* units;
  const char* pointer;  ///< into a row
  double factor = 1.0;  ///< from the number in the row to that in the file
};

/// Appends a column of each number; NaN where a row has none.
/// @param results_of a row as JSON
template <class Rows, class ResultsOf>
void append_numbers(std::span<const RowNumber> numbers, const Rows& rows, ResultsOf&& results_of,
                    std::vector<Column>& columns) {
  for (const RowNumber& number : numbers) {
    Column column{number.path, number.units, {}};
    for (const auto& row : rows)
      column.values.push_back(number.factor * pointed_number(results_of(row), number.pointer));
    columns.push_back(std::move(column));
  }
}

}  // namespace stridor
