#include "io/results/column_file.hpp"

#include <map>
#include <set>
#include <utility>

#include "io/hdf5/hdf5_output.hpp"

namespace stridor {
namespace {

std::string group_of(const std::string& path) {
  return path.substr(0, path.rfind('/'));
}

/// Columns of which others are functions.
bool is_scale(const std::string& path) {
  return path.ends_with("/time") || path.ends_with("/value") || path.ends_with("/run_time");
}

/// The path of the scale that stands in a group.
std::string scale_path(const std::string& group, const std::vector<Column>& columns) {
  for (const Column& column : columns)
    if (is_scale(column.path) && group_of(column.path) == group) return column.path;
  return "";
}

}  // namespace

void write_column_file(const std::string& path, Overwrite overwrite, const std::string& kind,
                       const std::vector<Column>& columns, const Attributes& attributes) {
  Attributes all{{"kind", kind}};
  all.insert(all.end(), attributes.begin(), attributes.end());
  write_hdf5_file(path, overwrite, all, [&](const Hdf5Writer& writer) {
    std::set<std::string> groups;
    std::map<std::string, std::pair<Handle, std::size_t>> scales;  // by group, with their length
    std::string signal;
    std::string axis;
    for (const Column& column : columns) {
      for (std::size_t slash = column.path.find('/', 1); slash != std::string::npos;
           slash = column.path.find('/', slash + 1)) {
        const std::string group = column.path.substr(0, slash);
        if (groups.insert(group).second) writer.make_group(group);
      }
      if (!column.texts.empty()) {
        writer.write_texts(column.path, column.texts);
        continue;
      }
      Handle written = writer.write(column.path, column.values, column.units);
      if (is_scale(column.path)) {
        writer.make_scale(written, column.path);
        const std::size_t length = column.values.size();
        scales.emplace(group_of(column.path), std::pair(std::move(written), length));
        continue;
      }
      // That of its own group, or of the nearest one about it.
      for (std::string group = group_of(column.path);; group = group_of(group)) {
        const auto scale = scales.find(group);
        if (scale != scales.end() && scale->second.second == column.values.size()) {
          writer.tie(written, column.path, scale->second.first, 0);
          if (signal.empty() && column.path.find("failed") == std::string::npos) {
            signal = column.path;
            axis = scale_path(group, columns);
          }
          break;
        }
        if (group.empty()) break;
      }
    }
    if (!signal.empty()) writer.make_default_plot(signal, {axis});
  });
}

}  // namespace stridor
