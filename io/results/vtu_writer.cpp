#include "io/results/vtu_writer.hpp"

#include <fmt/format.h>

#include <iterator>
#include <stdexcept>

#include "io/hdf5/part_file.hpp"

namespace stridor {
namespace {

constexpr const char* xml_head =
    "<?xml version=\"1.0\"?>\n<VTKFile type=\"{}\" version=\"0.1\" byte_order=\"LittleEndian\">\n";

/// Text within XML.
std::string xml_text(const std::string& text) {
  std::string result;
  for (const char c : text) {
    switch (c) {
      case '&': result += "&amp;"; break;
      case '<': result += "&lt;"; break;
      case '>': result += "&gt;"; break;
      case '"': result += "&quot;"; break;
      default: result += static_cast<unsigned char>(c) < 0x20 ? ' ' : c;
    }
  }
  return result;
}

/// A comment may not hold two dashes side by side.
std::string xml_comment(const std::string& text) {
  std::string result;
  for (const char c : xml_text(text)) {
    if (c == '-' && !result.empty() && result.back() == '-') result += ' ';
    result += c;
  }
  return result;
}

template <class Append>
void append_array(std::string& text, const char* type, const std::string& name, int components,
                  const Append& append) {
  text += fmt::format("<DataArray type=\"{}\" Name=\"{}\" NumberOfComponents=\"{}\" format=\"ascii\">\n",
                      type, xml_text(name), components);
  append();
  text += "</DataArray>\n";
}

void append_vectors(std::string& text, const std::string& name, const Eigen::MatrixX3d& values) {
  append_array(text, "Float64", name, 3, [&] {
    for (Eigen::Index i = 0; i < values.rows(); ++i) {
      fmt::format_to(std::back_inserter(text), "{:.9g} {:.9g} {:.9g}\n", values(i, 0), values(i, 1),
                     values(i, 2));
    }
  });
}

void check_mesh(const VtkMesh& mesh) {
  if (mesh.parts.size() != mesh.cells.size()) {
    throw std::invalid_argument(fmt::format("write_vtu: the bodies of {} cells are given, of {}",
                                            mesh.parts.size(), mesh.cells.size()));
  }
  for (const VtkMesh::Cell& cell : mesh.cells) {
    for (const int point : cell.points) {
      if (point < 0 || point >= mesh.points.rows())
        throw std::invalid_argument(fmt::format("write_vtu: there is no point {}", point));
    }
  }
  for (const auto& [name, values] : mesh.vectors) {
    if (values.rows() != mesh.points.rows()) {
      throw std::invalid_argument(fmt::format("write_vtu: {} vectors '{}' for {} points",
                                              values.rows(), name, mesh.points.rows()));
    }
  }
}

void append_cells(std::string& text, const VtkMesh& mesh) {
  text += "<Cells>\n";
  append_array(text, "Int32", "connectivity", 1, [&] {
    for (const VtkMesh::Cell& cell : mesh.cells) {
      for (const int point : cell.points) text += std::to_string(point) + ' ';
      text += '\n';
    }
  });
  append_array(text, "Int64", "offsets", 1, [&] {
    std::size_t end = 0;
    for (const VtkMesh::Cell& cell : mesh.cells) {
      end += cell.points.size();
      text += std::to_string(end) + '\n';
    }
  });
  append_array(text, "UInt8", "types", 1, [&] {
    for (const VtkMesh::Cell& cell : mesh.cells) text += std::to_string(cell.type) + '\n';
  });
  text += "</Cells>\n<CellData Scalars=\"body\">\n";
  append_array(text, "Int32", "body", 1, [&] {
    for (const int part : mesh.parts) text += std::to_string(part) + '\n';
  });
  text += "</CellData>\n";
}

}  // namespace

void write_vtu(const std::filesystem::path& path, const VtkMesh& mesh) {
  check_mesh(mesh);
  std::string text = fmt::format(fmt::runtime(xml_head), "UnstructuredGrid");
  if (!mesh.title.empty()) text += "<!-- " + xml_comment(mesh.title) + " -->\n";
  text += fmt::format("<UnstructuredGrid>\n<Piece NumberOfPoints=\"{}\" NumberOfCells=\"{}\">\n",
                      mesh.points.rows(), mesh.cells.size());
  text += "<Points>\n";
  append_vectors(text, "points", mesh.points);
  text += "</Points>\n";
  append_cells(text, mesh);
  text += "<PointData>\n";
  for (const auto& [name, values] : mesh.vectors) append_vectors(text, name, values);
  text += "</PointData>\n</Piece>\n</UnstructuredGrid>\n</VTKFile>\n";
  write_text_file(path.string(), text);
}

void write_pvd(const std::filesystem::path& path, const std::vector<TimedFile>& files) {
  std::string text = fmt::format(fmt::runtime(xml_head), "Collection") + "<Collection>\n";
  for (const TimedFile& one : files) {
    text += fmt::format("<DataSet timestep=\"{:.12g}\" part=\"0\" file=\"{}\"/>\n", one.time,
                        xml_text(one.file.filename().string()));
  }
  write_text_file(path.string(), text + "</Collection>\n</VTKFile>\n");
}

}  // namespace stridor
