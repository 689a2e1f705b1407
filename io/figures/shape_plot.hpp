// Pictures and animations of vibrating bodies.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "io/results/vtu_writer.hpp"
#include "substructures/reduction/recovery.hpp"

namespace stridor {

struct ShapePicture {
  std::vector<BodyShape> bodies;
  std::vector<Eigen::Vector2d> contacts;  ///< where they touch, m
  std::string caption;
};

/// Factor by which displacements are enlarged: the largest one becomes 6 % of the extent of the
/// nodes. 0 where nothing moves.
double shape_scale(const std::vector<BodyShape>& bodies);

/// Draws the meshes of the bodies displaced by the real and the imaginary part of their motion, a
/// quarter of a period apart: in a plane over their outlines at rest, with the contacts marked, of
/// a mesh finer than can be drawn the outline; in space their outer faces. Of bodies without both,
/// as matrices with a table of nodes, the nodes at rest and displaced, in space over all faces.
/// @throws std::invalid_argument if there is no node
/// @throws ConfigError, FileError as draw_figure()
void plot_shape(const ShapePicture& picture, const std::filesystem::path& figure);

/// The bodies as one mesh for ParaView, where they are at rest, one after the other.
VtkMesh vtk_mesh(const std::vector<BodyShape>& bodies);

/// Re(displacement e^{iφ}) of all points of vtk_mesh().
Eigen::MatrixX3d stacked_displacement(const std::vector<BodyShape>& bodies, double phase);

/// Writes a motion on the meshes of the bodies for ParaView: `<stem>.vtu` with its real and
/// imaginary part as vectors, `num_frames` frames of one period, `<stem>_frame_000.vtu` and so
/// on, with points moved shape_scale() times as far, and `<stem>.pvd`, which shows them in time.
/// @param period of the motion, s
/// @return the files
/// @throws FileError as write_vtu()
std::vector<std::filesystem::path> write_shape_frames(const ShapePicture& picture,
                                                      const std::filesystem::path& stem,
                                                      int num_frames, double period);

}  // namespace stridor
