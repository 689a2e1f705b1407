// Of runs under several contact assumptions side by side.
#include <fmt/format.h>

#include <algorithm>
#include <string>
#include <vector>

#include "app/report/tables.hpp"
#include "core/errors.hpp"

namespace stridor {

Json comparison_section(const ResultFile& file, const ReportContext&) {
  Json section = section_head(file, file.kind(), "contact assumptions side by side");
  section["file"] = name_with_folder(file);
  const std::vector<TableColumn> columns =
      columns_in(file, {{"/runs/assumption", "Assumption"},
                        {"/runs/coordinates", "Coordinates"},
                        {"/runs/step_time", "Time per step", 4},
                        {"/runs/ratio", "Of FiLM's", 4},
                        {"/runs/acceleration_peak", "Peak", 5},
                        {"/runs/acceleration_rms", "R.m.s.", 5},
                        {"/runs/difference", "Difference", 3},
                        {"/runs/force_min", "Least force", 4},
                        {"/runs/force_max", "Largest force", 4},
                        {"/runs/num_bursts", "Bursts"},
                        {"/runs/status", "Status"}});
  if (columns.empty()) throw FileError(Refusal::file_damaged, file.path(), "/runs", "holds no run");
  const std::vector<std::string> status = file.texts("/runs/status");
  const auto num_done = std::ranges::count(status, "done");
  section["verdict"] =
      verdict(num_done < std::ssize(status) ? "failed" : "told",
              fmt::format("{} runs, of which {} came to their end.", status.size(), num_done));
  section["views"].push_back(table_view("Runs; differences are from FiLM", columns));
  return section;
}

}  // namespace stridor
