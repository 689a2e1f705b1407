#include "io/figures/picture_canvas.hpp"

#include <fmt/format.h>

#include <Eigen/Geometry>
#include <iterator>
#include <stdexcept>
#include <vector>

namespace stridor {
namespace {

constexpr double arrow_share = 0.08;        // length of an arrow per diagonal of the picture
constexpr double mesh_line = 0.012;         // cm
constexpr double outline = 0.035;           // cm
constexpr std::size_t most_meshed = 12000;  // faces; their edges are left out beyond

/// Share of a colour, the rest of white or, beyond 1, of black.
PictureColour tinted(PictureColour colour, double share) {
  PictureColour result = 0;
  for (int shift = 16; shift >= 0; shift -= 8) {
    const double part = (colour >> shift) & 0xffu;
    const double value = share <= 1.0 ? 255.0 - share * (255.0 - part) : part * (2.0 - share);
    result |= static_cast<PictureColour>(std::lround(std::clamp(value, 0.0, 255.0))) << shift;
  }
  return result;
}

/// A polygon of the picture, with how near it is.
struct Painted {
  std::vector<Eigen::Vector2d> corners;  ///< m
  double nearness = 0.0;
  PictureColour fill = 0;
  PictureColour edge = 0;
  double edge_width = 0.0;  ///< cm; 0: none
  bool is_line = false;     ///< open and not filled
};

Eigen::Vector3d normal_of(const std::vector<Eigen::Vector3d>& corners) {
  Eigen::Vector3d twice_area = Eigen::Vector3d::Zero();
  for (std::size_t k = 1; k + 1 < corners.size(); ++k)
    twice_area += (corners[k] - corners[0]).cross(corners[k + 1] - corners[0]);
  const double size = twice_area.norm();
  return size > 0.0 ? Eigen::Vector3d(twice_area / size) : Eigen::Vector3d::Zero();
}

/// All faces and lines in the order in which they are drawn.
std::vector<Painted> painted_parts(const MeshPicture& picture, const PictureCanvas& canvas) {
  std::size_t num_faces = 0;
  for (const PicturePart& part : picture.parts) num_faces += part.faces.size();
  const double edge_width = num_faces > most_meshed ? 0.0 : mesh_line;
  const Eigen::Vector3d light =
      (picture.view.towards + 0.5 * picture.view.up - 0.3 * picture.view.right).normalized();
  // Lines on faces are drawn after these.
  const double lift = picture.view.is_planar ? 1.0 : 0.01 * canvas.diagonal();
  std::vector<Painted> all;
  for (const PicturePart& part : picture.parts) {
    const auto place = [&](int node) { return Eigen::Vector3d(part.nodes.row(node)); };
    const auto add = [&](const std::vector<int>& nodes) -> Painted& {
      Painted& painted = all.emplace_back();
      for (const int node : nodes) {
        painted.corners.push_back(canvas.flat(place(node)));
        painted.nearness += picture.view.towards.dot(place(node)) / static_cast<double>(nodes.size());
      }
      return painted;
    };
    for (const std::vector<int>& face : part.faces) {
      std::vector<Eigen::Vector3d> corners;
      for (const int node : face) corners.push_back(place(node));
      const Eigen::Vector3d normal = normal_of(corners);
      if (part.is_closed && normal.dot(picture.view.towards) < 0.0) continue;
      Painted& painted = add(face);
      const double lit = picture.view.is_planar ? 0.25 : 0.9 - 0.55 * std::abs(normal.dot(light));
      painted.fill = tinted(part.colour, lit);
      painted.edge = picture.view.is_planar ? part.colour : tinted(part.colour, 1.25);
      painted.edge_width = edge_width;
    }
    for (const std::vector<int>& line : part.lines) {
      for (std::size_t k = 0; k + 1 < line.size(); ++k) {
        Painted& painted = add({line[k], line[k + 1]});
        painted.is_line = true;
        painted.nearness += lift;
        painted.edge = part.colour;
        painted.edge_width = outline;
      }
    }
  }
  std::stable_sort(all.begin(), all.end(),
                   [](const Painted& a, const Painted& b) { return a.nearness < b.nearness; });
  return all;
}

}  // namespace

PictureCanvas::PictureCanvas(const MeshPicture& picture) : view_(picture.view) {
  for (const PicturePart& part : picture.parts)
    for (Eigen::Index i = 0; i < part.nodes.rows(); ++i) include(part.nodes.row(i).transpose());
  for (const PicturePlace& place : picture.places) include(place.at);
  for (const PictureLabel& label : picture.labels) include(label.at);
  if (x.is_empty()) throw std::invalid_argument("mesh picture: there is nothing to draw");
  // A single place has no size of its own.
  const double size = diagonal();
  arrow_length_ = arrow_share * (size > 0.0 ? size : picture.metres_per_unit);
  for (const PictureArrow& arrow : picture.arrows) include(head_of(arrow));
  for (const PictureSpring& spring : picture.springs) include(end_of(spring));
  const double margin = size > 0.0 ? 0.03 * diagonal() : 0.5 * picture.metres_per_unit;
  x = {x.lower - margin, x.upper + margin};
  y = {y.lower - margin, y.upper + margin};
}

std::string polygon_data(const std::string& block, const MeshPicture& picture,
                         const PictureCanvas& canvas) {
  const std::vector<Painted> all = painted_parts(picture, canvas);
  std::string data = block + " << END_OF_DATA\n";
  const auto corner = [&](const Eigen::Vector2d& at, PictureColour colour) {
    fmt::format_to(std::back_inserter(data), "{:.5f} {:.5f} {}\n", at.x(), at.y(), colour);
  };
  const auto line = [&](const Eigen::Vector2d& from, const Eigen::Vector2d& to,
                        const Painted& painted) {
    const double length = (to - from).norm();
    if (!(length > 0.0)) return;
    const Eigen::Vector2d along = 0.5 * painted.edge_width / length * (to - from);
    const Eigen::Vector2d across(-along.y(), along.x());
    corner(from - along - across, painted.edge);
    corner(to + along - across, painted.edge);
    corner(to + along + across, painted.edge);
    corner(from - along + across, painted.edge);
    data += '\n';
  };
  for (const Painted& painted : all) {
    std::vector<Eigen::Vector2d> corners;
    for (const Eigen::Vector2d& at : painted.corners) corners.push_back(canvas.on_page(at));
    if (!painted.is_line) {
      for (const Eigen::Vector2d& at : corners) corner(at, painted.fill);
      data += '\n';
    }
    for (std::size_t k = painted.is_line ? 1 : 0; painted.edge_width > 0.0 && k < corners.size(); ++k)
      line(corners[k == 0 ? corners.size() - 1 : k - 1], corners[k], painted);
  }
  return data + "END_OF_DATA\n";
}

}  // namespace stridor
