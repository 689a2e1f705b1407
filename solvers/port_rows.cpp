#include "solvers/port_rows.hpp"

#include <algorithm>

namespace stridor {
namespace {

/// Rows from `first_row` on with entries in columns from `first` to before `end`.
struct Extent {
  Eigen::Index first_row = 0, num_rows = 0;
  Eigen::Index first = 0, end = 0;
};

/// Of one row; empty where it is zero.
Extent extent_of(const Eigen::MatrixXd& rows, Eigen::Index row) {
  Extent extent{row, 1, 0, 0};
  for (Eigen::Index j = 0; j < rows.cols(); ++j) {
    if (rows(row, j) == 0.0) continue;
    if (extent.end == 0) extent.first = j;
    extent.end = j + 1;
  }
  return extent;
}

std::vector<Extent> bands_of(const Eigen::MatrixXd& rows) {
  std::vector<Extent> bands;
  for (Eigen::Index row = 0; row < rows.rows(); ++row) {
    const Extent one = extent_of(rows, row);
    if (one.end == 0) continue;
    if (!bands.empty() && one.first < bands.back().end && bands.back().first < one.end) {
      Extent& band = bands.back();
      band.num_rows = row + 1 - band.first_row;
      band.first = std::min(band.first, one.first);
      band.end = std::max(band.end, one.end);
    } else {
      bands.push_back(one);
    }
  }
  return bands;
}

}  // namespace

PortRows::PortRows(const Eigen::MatrixXd& rows)
    : num_ports_(rows.rows()), num_coordinates_(rows.cols()) {
  for (const Extent& band : bands_of(rows)) {
    const Eigen::MatrixXd block =
        rows.block(band.first_row, band.first, band.num_rows, band.end - band.first);
    bands_.push_back(
        {band.first_row, band.first, PaddedMatrix(block), PaddedMatrix(block.transpose())});
  }
}

void PortRows::gather(const double* coordinates, double* ports) const {
  std::fill_n(ports, padded_size(num_ports_), 0.0);
  for (const Band& band : bands_)
    band.rows.add_product(coordinates + band.first_coordinate, ports + band.first_port);
}

void PortRows::scatter(const double* ports, double* coordinates) const {
  std::fill_n(coordinates, padded_size(num_coordinates_), 0.0);
  for (const Band& band : bands_)
    band.columns.add_product(ports + band.first_port, coordinates + band.first_coordinate);
}

}  // namespace stridor
