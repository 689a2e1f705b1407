#include "app/runs/comparison_file.hpp"

#include <array>
#include <limits>
#include <vector>

#include "io/results/column_file.hpp"

namespace stridor {
namespace {

struct ComparedQuantity {
  const char* path;
  const char* units;
  const char* pointer;  ///< into the row
  double factor = 1.0;
};

constexpr std::array compared_quantities{
    ComparedQuantity{"/runs/wall_time", "s", "/wall_s"},
    ComparedQuantity{"/runs/step_time", "s", "/step_ns", 1e-9},
    ComparedQuantity{"/runs/ratio", "1", "/ratio"},
    ComparedQuantity{"/runs/steps", "1", "/steps"},
    ComparedQuantity{"/runs/acceleration_peak", "m/s^2", "/peak"},
    ComparedQuantity{"/runs/acceleration_rms", "m/s^2", "/rms"},
    ComparedQuantity{"/runs/difference", "1", "/difference"},
    ComparedQuantity{"/runs/force_min", "N", "/contact_force/min"},
    ComparedQuantity{"/runs/force_max", "N", "/contact_force/max"},
    ComparedQuantity{"/runs/stick_fraction", "1", "/stick_fraction"},
    ComparedQuantity{"/runs/free_fraction", "1", "/free_fraction"}};

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
  for (const ComparedQuantity& quantity : compared_quantities) {
    Column column{quantity.path, quantity.units, {}};
    for (const Json& row : rows)
      column.values.push_back(quantity.factor * pointed_number(row, quantity.pointer));
    columns.push_back(std::move(column));
  }
  Column bursts{"/runs/num_bursts", "1", {}};
  for (const Json& row : rows)
    bursts.values.push_back(row["bursts"].is_array() ? static_cast<double>(row["bursts"].size())
                                                     : std::numeric_limits<double>::quiet_NaN());
  columns.push_back(std::move(bursts));
  write_column_file(path.string(), overwrite, "comparison of assumptions", columns, attributes);
}

}  // namespace stridor
