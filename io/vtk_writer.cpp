#include "io/vtk_writer.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <fstream>
#include <iterator>
#include <stdexcept>

#include "core/errors.hpp"

namespace stridor {
namespace {

void append_plane_vectors(std::string& text, const Eigen::MatrixX2d& values) {
  for (Eigen::Index i = 0; i < values.rows(); ++i)
    fmt::format_to(std::back_inserter(text), "{:.9g} {:.9g} 0\n", values(i, 0), values(i, 1));
}

}  // namespace

void write_vtk(const std::filesystem::path& path, const VtkLines& data) {
  const Eigen::Index num_points = data.points.rows();
  std::size_t num_indices = 0;
  for (const auto& line : data.lines) {
    num_indices += line.size() + 1;
    for (const int index : line) {
      if (index < 0 || index >= num_points)
        throw std::invalid_argument(fmt::format("write_vtk: there is no point {}", index));
    }
  }
  std::string title = data.title.substr(0, 255);
  std::replace(title.begin(), title.end(), '\n', ' ');
  std::string text =
      fmt::format("# vtk DataFile Version 3.0\n{}\nASCII\nDATASET POLYDATA\nPOINTS {} double\n",
                  title, num_points);
  append_plane_vectors(text, data.points);
  text += fmt::format("LINES {} {}\n", data.lines.size(), num_indices);
  for (const auto& line : data.lines) {
    text += fmt::format("{}", line.size());
    for (const int index : line) text += fmt::format(" {}", index);
    text += '\n';
  }
  if (!data.vectors.empty()) text += fmt::format("POINT_DATA {}\n", num_points);
  for (const auto& [name, values] : data.vectors) {
    if (values.rows() != num_points) {
      throw std::invalid_argument(
          fmt::format("write_vtk: {} vectors '{}' for {} points", values.rows(), name, num_points));
    }
    text += fmt::format("VECTORS {} double\n", name);
    append_plane_vectors(text, values);
  }
  std::ofstream file(path, std::ios::binary);
  file << text;
  file.close();
  if (!file)
    throw FileError(path.string(), "", fmt::format("cannot be written: {}", std::strerror(errno)));
}

}  // namespace stridor
