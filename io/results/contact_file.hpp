// Sliding contacts as HDF5 files.
//
//     /                   attributes: of what, how and when
//     /rows/<quantity>    one entry per contact: speed, indentation, force, area, friction,
//                         converged, touches_window, has_resolved_edge, memory_in_cells, rounds,
//                         products, residual
//     /contacts/<k>/x, y          middles of the cells, m
//     /contacts/<k>/pressure      Pa, [y][x], the half y > 0
//     /contacts/<k>/gap           m, likewise
//     /contacts/<k>/edge_x, edge_y, edge_point  m, m, 1, 2, …; absent where the edge was not
//     resolved
#pragma once

#include <array>
#include <string>
#include <vector>

#include "io/hdf5/output_options.hpp"

namespace stridor {

/// One column of /rows.
struct ContactColumn {
  std::string name;
  std::string units;  ///< "1" where dimensionless
  std::vector<double> values;
};

/// The fields of one contact, of the half y > 0.
struct ContactFields {
  std::vector<double> x;                      ///< m
  std::vector<double> y;                      ///< m
  std::vector<double> pressure;               ///< Pa, a row per y
  std::vector<double> gap;                    ///< m, a row per y
  std::vector<std::array<double, 2>> edge{};  ///< m
};

/// Writes contacts to a file of its own; the file takes its name when it is whole.
/// @param path       final name; an existing file is replaced only with Overwrite::yes
/// @param attributes of the root
/// @throws FileError if the file exists, its folder is not writable, or anything cannot be written
void write_contact_file(const std::string& path, Overwrite overwrite,
                        const std::vector<ContactColumn>& columns,
                        const std::vector<ContactFields>& fields, const Attributes& attributes);

}  // namespace stridor
