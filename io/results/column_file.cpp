#include "io/results/column_file.hpp"

#include <set>

#include "io/hdf5/hdf5_output.hpp"

namespace stridor {

void write_column_file(const std::string& path, Overwrite overwrite, const std::string& kind,
                       const std::vector<Column>& columns, const Attributes& attributes) {
  Attributes all{{"kind", kind}};
  all.insert(all.end(), attributes.begin(), attributes.end());
  write_hdf5_file(path, overwrite, all, [&](const Hdf5Writer& writer) {
    std::set<std::string> groups;
    for (const Column& column : columns) {
      for (std::size_t slash = column.path.find('/', 1); slash != std::string::npos;
           slash = column.path.find('/', slash + 1)) {
        const std::string group = column.path.substr(0, slash);
        if (groups.insert(group).second) writer.make_group(group);
      }
      writer.write(column.path, column.values, column.units);
    }
  });
}

}  // namespace stridor
