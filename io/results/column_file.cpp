#include "io/results/column_file.hpp"

#include <fmt/format.h>

#include <cstddef>
#include <map>
#include <stdexcept>
#include <utility>

#include "io/hdf5/hdf5_output.hpp"

namespace stridor {
namespace {

std::string group_of(const std::string& path) {
  return path.substr(0, path.rfind('/'));
}

/// A column of which others are functions, in the file.
struct ColumnScale {
  Handle dataset;
  std::string path;
  std::size_t length = 0;
};

/// Scales by their groups.
using ColumnScales = std::map<std::string, ColumnScale>;

/// The scale of a column: that of its own group, or of the nearest one about it; numbers where none
/// is.
const ColumnScale& column_scale(const Column& column, const Hdf5Writer& writer,
                                ColumnScales& scales) {
  const std::size_t length = column.length();
  for (std::string group = group_of(column.path);; group = group_of(group)) {
    const auto scale = scales.find(group);
    if (scale != scales.end() && scale->second.length == length) return scale->second;
    if (group.empty()) break;
  }
  const std::string group = group_of(column.path);
  const std::string path = group + "/number";
  const auto [scale, is_new] = scales.try_emplace(group);
  if (!is_new) {
    throw std::invalid_argument(fmt::format("write_column_file: '{}' has {} entries, '{}' {}",
                                            column.path, length, scale->second.path,
                                            scale->second.length));
  }
  scale->second = {writer.write_numbers(path, length), path, length};
  return scale->second;
}

}  // namespace

void write_column_file(const std::string& path, Overwrite overwrite, const std::string& kind,
                       const std::vector<Column>& columns, const Attributes& attributes) {
  Attributes all{{"kind", kind}};
  all.insert(all.end(), attributes.begin(), attributes.end());
  write_hdf5_file(path, overwrite, all, [&](const Hdf5Writer& writer) {
    ColumnScales scales;
    std::string signal;
    std::string axis;
    for (const Column& column : columns) {
      Handle written = column.texts.empty() ? writer.write(column.path, column.values, column.units)
                                            : writer.write_texts(column.path, column.texts);
      if (column.is_scale) {
        writer.make_scale(written, column.path);
        scales[group_of(column.path)] = {std::move(written), column.path, column.length()};
        continue;
      }
      const ColumnScale& scale = column_scale(column, writer, scales);
      writer.tie(written, column.path, scale.dataset, 0);
      if (signal.empty() && column.texts.empty() && !column.path.ends_with("/failed")) {
        signal = column.path;
        axis = scale.path;
      }
    }
    if (!signal.empty()) writer.make_default_plot(signal, {axis});
  });
}

}  // namespace stridor
