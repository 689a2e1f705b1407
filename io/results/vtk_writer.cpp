#include "io/results/vtk_writer.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <iterator>
#include <span>
#include <stdexcept>

#include "io/hdf5/part_file.hpp"

namespace stridor {
namespace {

void append_plane_vectors(std::string& text, const Eigen::MatrixX2d& values) {
  for (Eigen::Index i = 0; i < values.rows(); ++i)
    fmt::format_to(std::back_inserter(text), "{:.9g} {:.9g} 0\n", values(i, 0), values(i, 1));
}

void append_cell(std::string& text, std::span<const int> points, Eigen::Index num_points) {
  fmt::format_to(std::back_inserter(text), "{}", points.size());
  for (const int point : points) {
    if (point < 0 || point >= num_points)
      throw std::invalid_argument(fmt::format("write_vtk: there is no point {}", point));
    fmt::format_to(std::back_inserter(text), " {}", point);
  }
  text += '\n';
}

}  // namespace

void write_vtk(const std::filesystem::path& path, const VtkMesh& mesh) {
  const Eigen::Index num_points = mesh.points.rows();
  const std::size_t num_cells = mesh.cells.size();
  if (mesh.parts.size() != num_cells) {
    throw std::invalid_argument(fmt::format("write_vtk: the bodies of {} cells are given, of {}",
                                            mesh.parts.size(), num_cells));
  }
  std::size_t num_indices = 0;
  for (const VtkMesh::Cell& cell : mesh.cells) num_indices += cell.points.size() + 1;

  std::string title = mesh.title.substr(0, 255);
  std::replace(title.begin(), title.end(), '\n', ' ');
  std::string text = fmt::format(
      "# vtk DataFile Version 3.0\n{}\nASCII\nDATASET UNSTRUCTURED_GRID\nPOINTS {} double\n", title,
      num_points);
  append_plane_vectors(text, mesh.points);
  text += fmt::format("CELLS {} {}\n", num_cells, num_indices);
  for (const VtkMesh::Cell& cell : mesh.cells) append_cell(text, cell.points, num_points);
  text += fmt::format("CELL_TYPES {}\n", num_cells);
  for (const VtkMesh::Cell& cell : mesh.cells) text += fmt::format("{}\n", cell.type);
  text += fmt::format("CELL_DATA {}\nSCALARS body int 1\nLOOKUP_TABLE default\n", num_cells);
  for (const int part : mesh.parts) text += fmt::format("{}\n", part);
  if (!mesh.vectors.empty()) text += fmt::format("POINT_DATA {}\n", num_points);
  for (const auto& [name, values] : mesh.vectors) {
    if (values.rows() != num_points) {
      throw std::invalid_argument(
          fmt::format("write_vtk: {} vectors '{}' for {} points", values.rows(), name, num_points));
    }
    text += fmt::format("VECTORS {} double\n", name);
    append_plane_vectors(text, values);
  }
  write_text_file(path.string(), text);
}

}  // namespace stridor
