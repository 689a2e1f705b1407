// Plane meshes for ParaView, in the legacy format of VTK.
#pragma once

#include <Eigen/Core>
#include <filesystem>
#include <string>
#include <utility>
#include <vector>

namespace stridor {

/// Cells in the plane and vectors at their points. Everything has z = 0.
struct VtkMesh {
  std::string title;  ///< one line
  Eigen::MatrixX2d points;
  struct Cell {
    int type = 0;             ///< of vtkCellType.h
    std::vector<int> points;  ///< in the order of VTK
  };
  static constexpr int poly_line = 4;  ///< type of a line through points in order
  std::vector<Cell> cells;
  std::vector<int> parts;  ///< number of the body of each cell
  std::vector<std::pair<std::string, Eigen::MatrixX2d>>
      vectors;  ///< name without blanks, per point
};

/// Writes a file (DATASET UNSTRUCTURED_GRID, ASCII, with the cell scalar `body`); one of that name
/// is replaced.
/// @throws std::invalid_argument if an index is out of range, or parts or vectors do not fit the
///         cells or points
/// @throws FileError if the file cannot be written
void write_vtk(const std::filesystem::path& path, const VtkMesh& mesh);

}  // namespace stridor
