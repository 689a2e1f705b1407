#include "io/imports/uff_units.hpp"

#include <fmt/format.h>

#include <string_view>

namespace stridor {

UffUnits read_uff_units(const UffDataset& dataset) {
  UffReader reader(dataset);
  const std::string_view head = reader.line("the code of the units").text;
  const UffLine& line = reader.line("factors of length, force and temperature");
  const std::vector<double> factors =
      uff_numbers(line, 25, "factors of length, force and temperature");
  if (factors.size() < 2 || !(factors[0] > 0.0) || !(factors[1] > 0.0))
    refuse_at(line.place, "expected positive factors of length and force (dataset 164)");
  // I10, 20A1, I10.
  const std::string_view name = head.size() > 10 ? head.substr(10, 20) : std::string_view();
  return {factors[0], factors[1], true, std::string(trimmed(name))};
}

UffUnits units_in(const std::vector<UffDataset>& datasets) {
  UffUnits units;
  for (const UffDataset& dataset : datasets)
    if (dataset.type == 164) units = read_uff_units(dataset);
  return units;
}

std::string place_text(const TextPlace& place) {
  std::size_t line = 1;
  const std::string& text = place.source->text;
  for (std::size_t i = 0; i < place.offset && i < text.size(); ++i) {
    if (text[i] == '\n' || (text[i] == '\r' && (i + 1 >= text.size() || text[i + 1] != '\n')))
      ++line;
  }
  return fmt::format("{}:{}", place.source->name, line);
}

}  // namespace stridor
