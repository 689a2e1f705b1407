#include "app/report/tables.hpp"

#include <algorithm>
#include <cstddef>
#include <optional>
#include <utility>

#include "core/errors.hpp"

namespace stridor {

Json table_view(const std::string& title, const std::vector<TableColumn>& columns) {
  Json view = {{"type", "table"}, {"title", title}, {"columns", Json::array()}};
  for (const TableColumn& column : columns) {
    Json one = {
        {"name", column.name}, {"units", column.units}, {"digits", column.digits}};
    if (column.texts.empty()) {
      one["values"] = Json::array();
      for (const double value : column.values) one["values"].push_back(number(value));
    } else {
      one["texts"] = column.texts;
    }
    view["columns"].push_back(std::move(one));
  }
  return view;
}

std::vector<TableColumn> columns_in(const ResultFile& file,
                                    const std::vector<WantedColumn>& wanted) {
  std::vector<TableColumn> columns;
  std::optional<std::size_t> length;
  for (const auto& [path, name, digits] : wanted) {
    TableColumn column{name, "", {}, {}, digits};
    if (file.has(path)) {
      column.units = file.array(path).units;
      column.values = file.read(path);
    } else {
      column.texts = file.texts(path);
      if (column.texts.empty()) continue;
    }
    const std::size_t size = std::max(column.values.size(), column.texts.size());
    if (length && size != *length)
      throw FileError(Refusal::file_damaged, file.path(), path,
                      "is unlike the others of its group in length");
    length = size;
    columns.push_back(std::move(column));
  }
  return columns;
}

}  // namespace stridor
