#include "io/imports/uff_contents.hpp"

#include <algorithm>
#include <utility>

#include "core/errors.hpp"
#include "io/imports/uff_file.hpp"
#include "io/imports/uff_lines.hpp"

namespace stridor {

std::string dataset_words(int number) {
  switch (number) {
    case 15:
    case 2411:
      return "nodes";
    case 55:
      return "mode shapes and other data at nodes";
    case 58:
      return "functions";
    case 82:
      return "lines to draw";
    case 151:
      return "head, passed over";
    case 164:
      return "units";
    case 2412:
      return "elements to draw";
    case 2414:
      return "analysis data, passed over";
    case 18:
    case 2420:
      return "coordinate systems, passed over";
    default:
      return "passed over";
  }
}

UffHoldings read_uff_holdings(const SourceText& source) {
  const std::vector<UffDataset> datasets = uff_datasets(source);
  if (datasets.empty()) refuse_at({&source, 0}, "expected datasets of a universal file, got none");
  UffHoldings all;
  for (const UffDataset& dataset : datasets) ++all.datasets[dataset.type];
  all.units = units_in(datasets);
  all.shapes = modal_test_in(datasets);
  UffFunctions functions = functions_in(datasets);
  all.functions = std::move(functions.functions);
  all.remarks = std::exchange(all.shapes.remarks, {});
  // Both readers remark on missing units.
  for (std::string& remark : functions.remarks)
    if (std::ranges::find(all.remarks, remark) == all.remarks.end())
      all.remarks.push_back(std::move(remark));
  return all;
}

UffHoldings read_uff_holdings_file(const std::string& path) {
  return read_uff_holdings(read_source_text(path, "a universal file (.uff, .unv)"));
}

}  // namespace stridor
