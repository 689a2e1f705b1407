#include "io/figures/mesh_plot.hpp"

#include <fmt/format.h>

#include <Eigen/Dense>
#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <stdexcept>
#include <vector>

#include "io/figures/axes.hpp"
#include "io/figures/gnuplot.hpp"
#include "substructures/elements/mesh_surfaces.hpp"

namespace stridor {
namespace {

struct Colour {
  int red, green, blue;
};
constexpr Colour plain{201, 205, 210};
constexpr std::array<Colour, 8> surface_colours{{{214, 96, 77},
                                                 {67, 147, 195},
                                                 {90, 174, 97},
                                                 {225, 175, 60},
                                                 {153, 112, 171},
                                                 {53, 151, 143},
                                                 {191, 129, 45},
                                                 {222, 119, 174}}};

std::string hex(const Colour& colour, double light) {
  const auto part = [&](int value) {
    return std::clamp(static_cast<int>(std::lround(light * value)), 0, 255);
  };
  return fmt::format("#{:02x}{:02x}{:02x}", part(colour.red), part(colour.green),
                     part(colour.blue));
}

/// A polygon on the page.
struct Polygon {
  std::vector<Eigen::Vector2d> corners;
  double depth = 0.0;  ///< towards the viewer
  double light = 1.0;
  int surface = -1;  ///< number among the names; −1: none
};

/// Directions of the page, and towards the viewer, as rows.
Eigen::Matrix3d view_of(int dimension) {
  if (dimension == 2) return Eigen::Matrix3d::Identity();
  const Eigen::Vector3d towards = Eigen::Vector3d(1.0, -1.6, 1.1).normalized();
  const Eigen::Vector3d right = Eigen::Vector3d::UnitZ().cross(towards).normalized();
  Eigen::Matrix3d view;
  view << right.transpose(), towards.cross(right).transpose(), towards.transpose();
  return view;
}

/// Nodes of a side around it, each edge through its middle node.
std::vector<int> outline(const Mesh& mesh, std::size_t element, const SideNodes& side) {
  const std::span<const int> nodes = mesh.nodes_of(element);
  const auto node = [&](int i) {
    return nodes[static_cast<std::size_t>(side.nodes[static_cast<std::size_t>(i)])];
  };
  std::vector<int> around;
  for (int i = 0; i < side.num_corners; ++i) {
    around.push_back(node(i));
    if (side.count > side.num_corners) around.push_back(node(side.num_corners + i));
  }
  return around;
}

/// Nodes of a planar element around it.
std::vector<int> outline(const Mesh& mesh, std::size_t element) {
  const std::span<const int> nodes = mesh.nodes_of(element);
  const auto num_corners = static_cast<std::size_t>(facts_of(mesh.shapes[element]).num_corners);
  std::vector<int> around;
  for (std::size_t i = 0; i < num_corners; ++i) {
    around.push_back(nodes[i]);
    if (nodes.size() > num_corners) around.push_back(nodes[num_corners + i]);
  }
  return around;
}

class MeshDrawing {
 public:
  explicit MeshDrawing(const Mesh& mesh)
      : mesh_(mesh), dimension_(mesh.dimension()), view_(view_of(dimension_)) {
    for (const auto& [name, sides] : mesh.surfaces) {
      const auto number = static_cast<int>(names_.size());
      names_.push_back(name);
      for (const ElementSide& side : sides) owner_.emplace(side, number);
    }
    if (dimension_ == 3) {
      for (const ElementSide& side : outer_sides(mesh)) add_side(side);
      std::sort(polygons_.begin(), polygons_.end(),
                [](const Polygon& a, const Polygon& b) { return a.depth < b.depth; });
    } else {
      for (std::size_t element = 0; element < mesh.num_elements(); ++element)
        polygons_.push_back(polygon_of(outline(mesh, element)));
    }
  }

  const std::vector<Polygon>& polygons() const { return polygons_; }
  const std::vector<std::string>& names() const { return names_; }
  int dimension() const { return dimension_; }
  const Eigen::Matrix3d& view() const { return view_; }

  /// Edges of named surfaces of a planar mesh.
  std::vector<std::pair<int, std::vector<Eigen::Vector2d>>> lines() const {
    std::vector<std::pair<int, std::vector<Eigen::Vector2d>>> all;
    if (dimension_ == 3) return all;
    for (const auto& [side, number] : owner_) {
      std::vector<int> nodes = nodes_of(mesh_, side);
      if (nodes.size() == 3) std::swap(nodes[1], nodes[2]);
      all.emplace_back(number, polygon_of(nodes).corners);
    }
    return all;
  }

 private:
  Polygon polygon_of(const std::vector<int>& nodes) const {
    Polygon polygon;
    for (const int node : nodes) {
      const Eigen::Vector3d seen = view_ * mesh_.nodes.row(node).transpose();
      polygon.corners.emplace_back(seen.head<2>());
      polygon.depth += seen.z() / static_cast<double>(nodes.size());
    }
    return polygon;
  }

  void add_side(const ElementSide& side) {
    const auto element = static_cast<std::size_t>(side.element);
    const SideNodes& shape =
        facts_of(mesh_.shapes[element]).sides[static_cast<std::size_t>(side.side)];
    const std::vector<int> around = outline(mesh_, element, shape);
    Eigen::Vector3d normal = Eigen::Vector3d::Zero();
    for (std::size_t i = 0; i < around.size(); ++i) {
      const Eigen::Vector3d a = mesh_.nodes.row(around[i]);
      const Eigen::Vector3d b = mesh_.nodes.row(around[(i + 1) % around.size()]);
      normal += a.cross(b);
    }
    const double length = normal.norm();
    if (!(length > 0.0)) return;
    normal = view_ * normal / length;
    if (normal.z() <= 0.0) return;
    Polygon polygon = polygon_of(around);
    // Light from above on the left.
    const Eigen::Vector3d light = Eigen::Vector3d(-0.4, 0.7, 0.6).normalized();
    polygon.light = 0.72 + 0.3 * std::max(0.0, normal.dot(light));
    const auto found = owner_.find(side);
    if (found != owner_.end()) polygon.surface = found->second;
    polygons_.push_back(std::move(polygon));
  }

  const Mesh& mesh_;
  int dimension_;
  Eigen::Matrix3d view_;
  std::vector<std::string> names_;
  std::map<ElementSide, int> owner_;
  std::vector<Polygon> polygons_;  ///< those further away first
};

const Colour& colour_of(int surface) {
  if (surface < 0) return plain;
  return surface_colours[static_cast<std::size_t>(surface) % surface_colours.size()];
}

/// From directions of the page in metres to cm on it.
struct Layout {
  double scale = 1.0;
  Eigen::Vector2d lowest = Eigen::Vector2d::Zero();
  double left = 0.0, bottom = 0.0;
  Eigen::Vector2d operator()(const Eigen::Vector2d& point) const {
    return {left + scale * (point.x() - lowest.x()), bottom + scale * (point.y() - lowest.y())};
  }
};

void add_polygon(FigureScript& script, int number, const Polygon& polygon, const Layout& layout,
                 const std::string& border) {
  std::string path;
  for (std::size_t i = 0; i <= polygon.corners.size(); ++i) {
    const Eigen::Vector2d at = layout(polygon.corners[i % polygon.corners.size()]);
    path += fmt::format("{} screen {:.5f},{:.5f}", i == 0 ? "from" : " to", script.across(at.x()),
                        script.up(at.y()));
  }
  script.add("set object {} polygon {} fillstyle solid 1.0 {} fillcolor rgb '{}'", number, path,
             border, hex(colour_of(polygon.surface), polygon.light));
}

/// Named edges of a planar mesh.
void add_lines(FigureScript& script, const MeshDrawing& picture, const Layout& layout) {
  for (const auto& [surface, points] : picture.lines()) {
    for (std::size_t i = 0; i + 1 < points.size(); ++i) {
      const Eigen::Vector2d from = layout(points[i]);
      const Eigen::Vector2d to = layout(points[i + 1]);
      script.add("set arrow from screen {:.5f},{:.5f} to screen {:.5f},{:.5f} nohead front linewidth "
                 "3 linecolor rgb '{}'",
                 script.across(from.x()), script.up(from.y()), script.across(to.x()),
                 script.up(to.y()), hex(colour_of(surface), 1.0));
    }
  }
}

void add_legend(FigureScript& script, int& number, const std::vector<std::string>& names,
                double left, double top) {
  const double line = line_height(caption_font);
  double y = top;
  for (std::size_t i = 0; i < names.size(); ++i) {
    script.add("set object {} rectangle from screen {:.5f},{:.5f} to screen {:.5f},{:.5f} fillstyle "
               "solid 1.0 noborder fillcolor rgb '{}'",
               number++, script.across(left), script.up(y - 0.12), script.across(left + 0.5),
               script.up(y + 0.12), hex(colour_of(static_cast<int>(i)), 1.0));
    script.add_text(names[i], left + 0.7, y, "left", caption_font);
    y -= line;
  }
}

/// Directions of the axes, in the lower left corner.
void add_triad(FigureScript& script, const MeshDrawing& picture, double left, double bottom) {
  const Eigen::Vector2d origin(left + 0.9, bottom + 0.9);
  for (int axis = 0; axis < picture.dimension(); ++axis) {
    const Eigen::Vector2d along = picture.view().col(axis).head<2>();
    const Eigen::Vector2d end = origin + 0.8 * along;
    const Eigen::Vector2d name = origin + 1.05 * along;
    script.add("set arrow from screen {:.5f},{:.5f} to screen {:.5f},{:.5f} front size screen "
               "0.01,20 linewidth 1.2 linecolor '#404040'",
               script.across(origin.x()), script.up(origin.y()), script.across(end.x()),
               script.up(end.y()));
    script.add_text(std::string(1, "xyz"[axis]), name.x(), name.y(), "center", caption_font);
  }
}

}  // namespace

void plot_mesh(const Mesh& mesh, const std::string& caption, const std::filesystem::path& figure) {
  check_figure_name(figure);
  if (mesh.num_elements() == 0) throw std::invalid_argument("plot_mesh: there are no elements");
  const MeshDrawing picture(mesh);
  Eigen::Vector2d low = picture.polygons().front().corners.front();
  Eigen::Vector2d high = low;
  for (const Polygon& polygon : picture.polygons()) {
    for (const Eigen::Vector2d& corner : polygon.corners) {
      low = low.cwiseMin(corner);
      high = high.cwiseMax(corner);
    }
  }
  FigureSize size;
  double legend_width = 0.0;
  for (const std::string& name : picture.names())
    legend_width = std::max(legend_width, 1.2 + text_width(name, caption_font));
  const std::vector<std::string> lines = wrapped(caption, caption_font, size.width - 1.0);
  const double below = 0.4 + caption_height(lines);
  Layout layout;
  layout.lowest = low;
  layout.left = 2.2;
  layout.bottom = below + 0.6;
  const Eigen::Vector2d extent = (high - low).cwiseMax(1e-300);
  constexpr double most_height = 11.0;
  layout.scale = std::min((size.width - layout.left - 0.5 - legend_width) / extent.x(),
                          most_height / extent.y());
  const double legend_height =
      static_cast<double>(picture.names().size()) * line_height(caption_font);
  const double height = std::max({layout.scale * extent.y(), legend_height, 2.2});
  layout.bottom += 0.5 * (height - layout.scale * extent.y());
  size.height = below + height + 1.1;

  FigureScript script(size);
  script.add("unset border\nunset tics\nunset key\nset lmargin 0\nset rmargin 0\nset tmargin 0\n"
             "set bmargin 0\nset xrange [0:1]\nset yrange [0:1]");
  constexpr std::size_t most_with_edges = 6000;
  const bool has_edges = picture.polygons().size() <= most_with_edges;
  int number = 1;
  for (const Polygon& polygon : picture.polygons()) {
    const std::string border =
        has_edges ? "border linecolor rgb '#606468'"
                  : fmt::format("border linecolor rgb '{}'",
                                hex(colour_of(polygon.surface), polygon.light));
    add_polygon(script, number++, polygon, layout, border);
  }
  add_lines(script, picture, layout);
  add_legend(script, number, picture.names(), size.width - legend_width, size.height - 0.7);
  add_triad(script, picture, 0.0, below + 0.2);
  script.add_caption(lines, 0.5, below);
  script.add("plot NaN");
  draw_figure(figure, script.text(), size);
}

}  // namespace stridor
