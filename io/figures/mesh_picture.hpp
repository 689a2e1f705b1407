// Pictures of meshes, bodies and places on them, in their plane or projected from space.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <filesystem>
#include <span>
#include <string>
#include <vector>

#include "substructures/elements/mesh.hpp"

namespace stridor {

/// From which side a picture shows things: unit vectors, the last one towards the viewer.
struct PictureView {
  Eigen::Vector3d right = Eigen::Vector3d::UnitX();
  Eigen::Vector3d up = Eigen::Vector3d::UnitY();
  Eigen::Vector3d towards = Eigen::Vector3d::UnitZ();
  bool is_planar = true;  ///< x and y have axes with numbers; else three arms show the directions

  static PictureView plane() { return {}; }
  /// All three axes equally short, z upwards.
  static PictureView isometric();
};

/// 0xRRGGBB.
using PictureColour = std::uint32_t;
/// Colours of bodies or surfaces by number; they repeat after some.
PictureColour part_colour(std::size_t number);

/// A body, or a surface of one.
struct PicturePart {
  std::string name;  ///< in the legend; empty: none
  PictureColour colour = 0x0b5394;
  Eigen::MatrixX3d nodes;               ///< m
  std::vector<std::vector<int>> faces;  ///< nodes around each, as face_loops() gives them
  std::vector<std::vector<int>> lines;  ///< nodes in order
  bool is_closed = false;  ///< the faces surround it: those that look away are not drawn
};

enum class PictureMark {
  point,        ///< has a name
  mass,         ///< a node of a body that is made of no elements
  contact,      ///< a slave point
  held,         ///< moves in no direction
  held_partly,  ///< in some
  guided,       ///< moves with a drive
};

struct PicturePlace {
  Eigen::Vector3d at;  ///< m
  PictureMark mark = PictureMark::point;
};

/// An arrow from a place, as long as all others.
struct PictureArrow {
  enum class Kind { motion, load, normal };
  Eigen::Vector3d at;         ///< m
  Eigen::Vector3d direction;  ///< of any length
  Kind kind = Kind::motion;
};

/// A spring between two places, or from one to the ground.
struct PictureSpring {
  Eigen::Vector3d at;        ///< m
  Eigen::Vector3d to;        ///< m; of one to the ground the direction in which it is
  bool is_grounded = false;  ///< then as long as two arrows
};

/// A name of a place. Those that come to stand on one spot are written together, `of` once and the
/// weightier ones first.
struct PictureLabel {
  Eigen::Vector3d at;  ///< m
  std::string of;      ///< before the name, with a dot between; empty: nothing
  std::string text;
  int weight = 0;
};

struct MeshPicture {
  PictureView view;
  std::vector<PicturePart> parts;
  std::vector<PicturePlace> places;
  std::vector<PictureArrow> arrows;
  std::vector<PictureSpring> springs;
  std::vector<PictureLabel> labels;  ///< written above the picture, each with a line to its place
  std::string unit = "m";            ///< of the lengths in the picture
  double metres_per_unit = 1.0;      ///< > 0
  std::string caption;
};

/// The nodes around what is seen of elements: around every planar one, around the outer sides of
/// volumes, counter-clockwise seen from outside.
std::vector<std::vector<int>> face_loops(std::span<const DrawnElement> elements);
/// Around some sides of the elements of a mesh in space.
std::vector<std::vector<int>> face_loops(const Mesh& mesh, std::span<const ElementSide> sides);

/// Draws a picture, farther faces first, so that nearer ones hide them; places, arrows and labels
/// are drawn over all of them. One length is the same in every direction. Of labels for which there
/// is no room the caption says how many.
/// @throws std::invalid_argument if there is nothing to draw
/// @throws ConfigError, FileError as draw_figure()
void draw_mesh_picture(const MeshPicture& picture, const std::filesystem::path& figure);

}  // namespace stridor
