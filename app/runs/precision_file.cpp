#include "app/runs/precision_file.hpp"

#include <fmt/format.h>

#include <array>
#include <limits>
#include <string>
#include <utility>
#include <vector>

#include "app/results/file_attributes.hpp"
#include "app/results/row_columns.hpp"
#include "io/figures/axes.hpp"

namespace stridor {
namespace {

/// "exact, to 50 kHz, step 5 us".
std::string setting_text(const Json& row) {
  const auto method = row["method"].get<std::string>();
  return row.contains("step") && row["step"].is_number()
             ? fmt::format("{}, step {}", method, quantity_text(row["step"].get<double>(), "s"))
             : fmt::format("{}, tolerance {:.2g}", method, pointed_number(row, "/tolerance"));
}

/// The column over which the others are drawn stands first.
constexpr std::array setting_numbers{
    RowNumber{"/settings/run_time", "s", "/least_wall_s"},
    RowNumber{"/settings/error", "1", "/error"},
    RowNumber{"/settings/step", "s", "/step"},
    RowNumber{"/settings/tolerance", "1", "/tolerance"},
    RowNumber{"/settings/modes", "1", "/modes"},
    RowNumber{"/settings/error_of_force", "1", "/errors/force"},
    RowNumber{"/settings/error_of_acceleration", "1", "/errors/acceleration"},
    RowNumber{"/settings/error_of_envelope", "1", "/errors/envelope"}};

std::vector<Column> columns_of_settings(const Json& rows) {
  Column method{"/settings/method", "", {}};
  Column status{"/settings/status", "", {}};
  Column on_front{"/settings/on_front", "1", {}};
  for (const Json& row : rows) {
    method.texts.push_back(row["method"].get<std::string>());
    status.texts.push_back(row["status"].get<std::string>());
    on_front.values.push_back(row["on_front"].get<bool>() ? 1.0 : 0.0);
  }
  std::vector<Column> columns;
  append_numbers(
      setting_numbers, rows, [](const Json& row) -> const Json& { return row; }, columns);
  columns.front().is_scale = true;
  for (Column* column : {&method, &status, &on_front}) columns.push_back(std::move(*column));
  return columns;
}

void add_reductions(const Json& reductions, std::vector<Column>& columns) {
  Column body{"/reduction/body", "", {}};
  Column frequency{"/reduction/frequency", "Hz", {}};
  Column error{"/reduction/error", "1", {}};
  for (const Json& one : reductions) {
    for (std::size_t i = 0; i < one["errors"].size(); ++i) {
      const Json& found = one["errors"][i];
      body.texts.push_back(one["body"].get<std::string>());
      frequency.values.push_back(one["frequencies"][i].get<double>());
      error.values.push_back(found.is_null() ? std::numeric_limits<double>::quiet_NaN()
                                             : found.get<double>());
    }
  }
  if (body.texts.empty()) return;
  columns.push_back(std::move(body));
  columns.push_back(std::move(frequency));
  columns.push_back(std::move(error));
}

}  // namespace

void write_precision_file(const std::filesystem::path& path, const Json& object,
                          const PrecisionOptions& options, const LoadedScene& loaded) {
  std::vector<Column> columns = columns_of_settings(object.value("rows", Json::array()));
  add_reductions(object.value("reduction", Json::array()), columns);
  Attributes attributes = source_attributes(loaded, options.command_line);
  for (const auto& [name, value] :
       Attributes{{"norm", object.value("norm", std::string("displacement"))},
                  {"channel", object.value("channel", std::string())},
                  {"reference_error", pointed_number(object, "/reference/error")},
                  {"wanted_error", pointed_number(object, "/tune/wanted")},
                  {"tuned", std::string()}})
    attributes.emplace_back(name, value);
  if (object.contains("tune") && object["tune"].is_object())
    std::get<std::string>(attributes.back().second) = setting_text(object["tune"]);
  write_column_file(path.string(), options.common.overwrite(), "study of precision", columns,
                    attributes);
}

}  // namespace stridor
