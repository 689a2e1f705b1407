#include "app/runs/comparison_file.hpp"

#include <array>
#include <limits>
#include <vector>

#include "app/results/row_columns.hpp"

namespace stridor {
namespace {

constexpr std::array compared_quantities{RowNumber{"/runs/wall_time", "s", "/wall_s"},
                                         RowNumber{"/runs/step_time", "s", "/step_ns", 1e-9},
                                         RowNumber{"/runs/ratio", "1", "/ratio"},
                                         RowNumber{"/runs/steps", "1", "/steps"},
                                         RowNumber{"/runs/acceleration_peak", "m/s^2", "/peak"},
                                         RowNumber{"/runs/acceleration_rms", "m/s^2", "/rms"},
                                         RowNumber{"/runs/difference", "1", "/difference"},
                                         RowNumber{"/runs/force_min", "N", "/contact_force/min"},
                                         RowNumber{"/runs/force_max", "N", "/contact_force/max"},
                                         RowNumber{"/runs/stick_fraction", "1", "/stick_fraction"},
                                         RowNumber{"/runs/free_fraction", "1", "/free_fraction"}};

}  // namespace

void write_comparison_file(const std::filesystem::path& path, Overwrite overwrite, const Json& rows,
                           const Attributes& attributes) {
  std::vector<Column> columns{{"/runs/assumption", "", {}},
                              {"/runs/coordinates", "", {}},
                              {"/runs/status", "", {}}};
  for (const Json& row : rows) {
    columns[0].texts.push_back(row["assumption"].get<std::string>());
    columns[1].texts.push_back(row["coordinates"].get<std::string>());
    columns[2].texts.push_back(row["status"].get<std::string>());
  }
  append_numbers(
      compared_quantities, rows, [](const Json& row) -> const Json& { return row; }, columns);
  Column bursts{"/runs/num_bursts", "1", {}};
  for (const Json& row : rows)
    bursts.values.push_back(row["bursts"].is_array() ? static_cast<double>(row["bursts"].size())
                                                     : std::numeric_limits<double>::quiet_NaN());
  columns.push_back(std::move(bursts));
  write_column_file(path.string(), overwrite, "comparison of assumptions", columns, attributes);
}

}  // namespace stridor
