// The files of a motion for ParaView.
#include <fmt/format.h>

#include <complex>
#include <numbers>

#include "io/figures/shape_plot.hpp"
#include "io/results/vtu_writer.hpp"

namespace stridor {

VtkMesh vtk_mesh(const std::vector<BodyShape>& bodies) {
  VtkMesh mesh;
  int num_points = 0;
  for (std::size_t b = 0; b < bodies.size(); ++b) {
    const BodyShape& body = bodies[b];
    const auto add = [&](int type, std::vector<int> points) {
      for (int& node : points) node += num_points;
      mesh.cells.push_back({type, std::move(points)});
      mesh.parts.push_back(static_cast<int>(b));
    };
    for (const DrawnElement& element : body.elements)
      add(vtk_cell_type(element.shape), element.nodes);
    // A body without elements shows its outline, or its nodes.
    if (body.elements.empty()) {
      for (const std::vector<int>& outline : body.outlines) add(VtkMesh::poly_line, outline);
      for (int node = 0; body.outlines.empty() && node < body.nodes.rows(); ++node)
        add(VtkMesh::vertex, {node});
    }
    num_points += static_cast<int>(body.nodes.rows());
  }
  mesh.points.resize(num_points, 3);
  Eigen::Index first = 0;
  for (const BodyShape& body : bodies) {
    mesh.points.middleRows(first, body.nodes.rows()) = body.nodes;
    first += body.nodes.rows();
  }
  return mesh;
}

Eigen::MatrixX3d stacked_displacement(const std::vector<BodyShape>& bodies, double phase) {
  Eigen::Index num_points = 0;
  for (const BodyShape& body : bodies) num_points += body.nodes.rows();
  Eigen::MatrixX3d stacked(num_points, 3);
  Eigen::Index first = 0;
  for (const BodyShape& body : bodies) {
    stacked.middleRows(first, body.nodes.rows()) =
        (body.displacement * std::polar(1.0, phase)).real();
    first += body.nodes.rows();
  }
  return stacked;
}

std::vector<std::filesystem::path> write_shape_frames(const ShapePicture& picture,
                                                      const std::filesystem::path& stem,
                                                      int num_frames, double period) {
  VtkMesh mesh = vtk_mesh(picture.bodies);
  mesh.title = picture.caption;
  std::vector<std::filesystem::path> files;
  const auto name = [&](const std::string& ending) {
    files.push_back(stem);
    files.back() += ending;
    return files.back();
  };
  mesh.vectors = {{"real", stacked_displacement(picture.bodies, 0.0)},
                  {"imaginary", stacked_displacement(picture.bodies, -0.5 * std::numbers::pi)}};
  write_vtu(name(".vtu"), mesh);
  const Eigen::MatrixX3d rest = mesh.points;
  const double scale = shape_scale(picture.bodies);
  std::vector<TimedFile> frames;
  for (int frame = 0; frame < num_frames; ++frame) {
    const double part = static_cast<double>(frame) / num_frames;
    const Eigen::MatrixX3d moved =
        stacked_displacement(picture.bodies, 2.0 * std::numbers::pi * part);
    mesh.points = rest + scale * moved;
    mesh.vectors = {{"displacement", moved}};
    write_vtu(name(fmt::format("_frame_{:03}.vtu", frame)), mesh);
    frames.push_back({part * period, files.back()});
  }
  write_pvd(name(".pvd"), frames);
  return files;
}

}  // namespace stridor
