// Lines in the plane for ParaView, in the legacy format of VTK.
#pragma once

#include <Eigen/Core>
#include <filesystem>
#include <string>
#include <utility>
#include <vector>

namespace stridor {

/// Polylines and vectors at their points. Everything has z = 0.
struct VtkLines {
  std::string title;  ///< one line
  Eigen::MatrixX2d points;
  std::vector<std::vector<int>> lines;  ///< indices of points
  std::vector<std::pair<std::string, Eigen::MatrixX2d>>
      vectors;  ///< name without blanks, per point
};

/// Writes a file (DATASET POLYDATA, ASCII); one of that name is replaced.
/// @throws std::invalid_argument if an index is out of range or vectors do not fit the points
/// @throws FileError if the file cannot be written
void write_vtk(const std::filesystem::path& path, const VtkLines& data);

}  // namespace stridor
