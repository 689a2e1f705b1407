// Columns of numbers as an HDF5 file, for results that are tables and histories.
#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "io/hdf5/output_options.hpp"

namespace stridor {

/// One dataset. The groups in its path are made.
struct Column {
  std::string path;   ///< "/time", "/channels/sphere.x.displacement"
  std::string units;  ///< "1" where dimensionless
  std::vector<double> values;
  std::vector<std::string> texts{};  ///< instead of values
  bool is_scale = false;             ///< others of its group and below are functions of it

  std::size_t length() const { return texts.empty() ? values.size() : texts.size(); }
};

/// Writes columns to a file of their own. Scales stand before the columns that depend on them: they
/// are those of all of their length in their groups and below; where there is none, `number` of
/// their group is, 1, 2, …. The file takes its name when it is whole.
/// @param kind       kind of the file, an attribute of the root
/// @param attributes of the root besides
/// @throws FileError if the file exists, its folder is not writable, or anything cannot be written
/// @throws std::invalid_argument if a column has no scale of its length and its group has one
void write_column_file(const std::string& path, Overwrite overwrite, const std::string& kind,
                       const std::vector<Column>& columns, const Attributes& attributes);

}  // namespace stridor
