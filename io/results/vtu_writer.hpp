// Meshes and series of them for ParaView, in the XML format of VTK.
#pragma once

#include <Eigen/Core>
#include <filesystem>
#include <string>
#include <utility>
#include <vector>

namespace stridor {

/// Cells in space and vectors at their points.
struct VtkMesh {
  std::string title;  ///< a comment in the file
  Eigen::MatrixX3d points;
  struct Cell {
    int type = 0;             ///< of vtkCellType.h
    std::vector<int> points;  ///< in the order of VTK
  };
  static constexpr int vertex = 1;     ///< type of a point
  static constexpr int poly_line = 4;  ///< type of a line through points in order
  std::vector<Cell> cells;
  std::vector<int> parts;  ///< number of the body of each cell
  std::vector<std::pair<std::string, Eigen::MatrixX3d>> vectors;  ///< by name, per point
};

/// Writes a file `.vtu` (UnstructuredGrid, ASCII, with the cell scalar `body`); one of that name is
/// replaced.
/// @throws std::invalid_argument if an index is out of range, or parts or vectors do not fit the
///         cells or points
/// @throws FileError if the file cannot be written
void write_vtu(const std::filesystem::path& path, const VtkMesh& mesh);

/// A file of a series and its time.
struct TimedFile {
  double time = 0.0;           ///< s
  std::filesystem::path file;  ///< in the folder of the collection
};

/// Writes a file `.pvd` by which ParaView opens files one after the other in time.
/// @throws FileError if the file cannot be written
void write_pvd(const std::filesystem::path& path, const std::vector<TimedFile>& files);

}  // namespace stridor
