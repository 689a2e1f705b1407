#include "io/imports/law_table_file.hpp"

#include <fmt/format.h>

#include <stdexcept>

#include "core/errors.hpp"
#include "io/hdf5/damage_guard.hpp"
#include "io/hdf5/hdf5_input.hpp"
#include "io/hdf5/hdf5_output.hpp"

namespace stridor {
namespace {

struct TableDataset {
  const char* dataset;
  std::vector<double> ContactTable::*values;
};
constexpr TableDataset table_datasets[] = {{"/force", &ContactTable::force},
                                           {"/area", &ContactTable::area},
                                           {"/friction", &ContactTable::friction}};

}  // namespace

void write_law_table(const std::string& path, Overwrite overwrite, const ContactTable& table,
                     const std::vector<double>& memory_in_cells, const Attributes& attributes) {
  Attributes all{{"kind", std::string("contact law")}};
  all.insert(all.end(), attributes.begin(), attributes.end());
  write_hdf5_file(path, overwrite, all, [&](const Hdf5Writer& writer) {
    const Handle speed = writer.write("/speed", table.speeds, "1");
    const Handle indentation = writer.write("/indentation", table.indentations, "1");
    writer.make_scale(speed, "/speed");
    writer.make_scale(indentation, "/indentation");
    const std::vector<hsize_t> shape{table.indentations.size(), table.speeds.size()};
    const auto add = [&](const char* dataset, const std::vector<double>& values) {
      const Handle written = writer.write(dataset, shape, values.data(), "1");
      writer.tie(written, dataset, indentation, 0);
      writer.tie(written, dataset, speed, 1);
    };
    for (const auto& [dataset, values] : table_datasets) add(dataset, table.*values);
    add("/memory_in_cells", memory_in_cells);
    writer.make_default_plot("/friction", {"/indentation", "/speed"});
  });
}

TabulatedLaw read_law_table(const std::string& path) {
  const DamageGuard guard(path);
  const QuietErrors quiet;
  const Checker at(path);
  const Handle file = open_hdf5_file(at);
  ContactTable table;
  const auto read = [&](const std::string& dataset, std::size_t rank) {
    return read_array(at, open_array(at, file.id(), dataset, rank), dataset);
  };
  table.speeds = read("/speed", 1);
  table.indentations = read("/indentation", 1);
  for (const auto& [dataset, values] : table_datasets) {
    const Hdf5Array array = open_array(at, file.id(), dataset, 2);
    if (array.shape[0] != table.indentations.size() || array.shape[1] != table.speeds.size()) {
      throw FileError(
          Refusal::file_damaged, path, dataset,
          fmt::format("is {} x {}, but there are {} indentations and {} speeds", array.shape[0],
                      array.shape[1], table.indentations.size(), table.speeds.size()));
    }
    table.*values = read_array(at, array, dataset);
  }
  try {
    return TabulatedLaw(table);
  } catch (const std::invalid_argument& error) {
    throw FileError(
        Refusal::file_damaged, path, "",
        fmt::format("is no contact law of `stridor contact --table`: {}", error.what()));
  }
}

}  // namespace stridor
