#include "io/figures/shape_plot.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <complex>
#include <iterator>
#include <numbers>
#include <stdexcept>

#include "io/figures/axes.hpp"
#include "io/figures/gnuplot.hpp"
#include "io/figures/mesh_picture.hpp"
#include "io/figures/picture_canvas.hpp"

namespace stridor {
namespace {

constexpr std::array<PictureColour, 4> shape_colours{0x0b5394, 0xc0392b, 0x38761d, 0x741b47};

/// How bodies are seen: in their plane, or from above where they are in space.
PictureView view_of(const std::vector<BodyShape>& bodies) {
  return is_spatial(bodies) ? PictureView::isometric() : PictureView::plane();
}

Eigen::MatrixX2d seen(const Eigen::MatrixX3d& places, const PictureView& view) {
  Eigen::MatrixX2d flat(places.rows(), 2);
  flat << places * view.right, places * view.up;
  return flat;
}

/// The nodes displaced by scale · Re(displacement e^{iφ}).
Eigen::MatrixX2d displaced(const BodyShape& body, const PictureView& view, double scale,
                           double phase) {
  const Eigen::MatrixX3d moved =
      body.nodes + scale * (body.displacement * std::polar(1.0, phase)).real();
  return seen(moved, view);
}

/// Whether a body shows as its nodes alone: matrices with a table of nodes, a modal test, masses.
bool is_of_points(const BodyShape& body) {
  return body.outlines.empty() && body.elements.empty();
}

struct Extent {
  ValueRange x, y;
  void include(const Eigen::MatrixX2d& nodes) {
    const auto size = static_cast<std::size_t>(nodes.rows());
    x.include({nodes.col(0).data(), size});
    y.include({nodes.col(1).data(), size});
  }
  /// 1 m for nodes in a single place, whose picture may have any scale.
  double diagonal() const {
    const double length = std::hypot(x.upper - x.lower, y.upper - y.lower);
    return length > 0.0 ? length : 1.0;
  }
};

Extent extent_of(const std::vector<BodyShape>& bodies, const PictureView& view) {
  Extent extent;
  for (const BodyShape& body : bodies) extent.include(seen(body.nodes, view));
  if (extent.x.is_empty() || extent.y.is_empty())
    throw std::invalid_argument("shape plot: there is no node");
  return extent;
}

std::string line_data(const std::string& block, const std::vector<std::vector<int>>& lines,
                      const Eigen::MatrixX2d& nodes, const AxisScale& x, const AxisScale& y) {
  std::string data = block + " << END_OF_DATA\n";
  auto out = std::back_inserter(data);
  for (const auto& line : lines) {
    for (const int node : line) {
      fmt::format_to(out, "{:.7g} {:.7g}\n", as_number(nodes(node, 0), x),
                     as_number(nodes(node, 1), y));
    }
    data += '\n';
  }
  return data + "END_OF_DATA\n";
}

/// Where each node is at rest, and the way it moves.
std::string arrow_data(const std::string& block, const Eigen::MatrixX2d& rest,
                       const Eigen::MatrixX2d& moved, const AxisScale& x, const AxisScale& y) {
  std::string data = block + " << END_OF_DATA\n";
  auto out = std::back_inserter(data);
  for (Eigen::Index node = 0; node < rest.rows(); ++node) {
    const double from_x = as_number(rest(node, 0), x);
    const double from_y = as_number(rest(node, 1), y);
    fmt::format_to(out, "{:.7g} {:.7g} {:.7g} {:.7g}\n", from_x, from_y,
                   as_number(moved(node, 0), x) - from_x, as_number(moved(node, 1), y) - from_y);
  }
  return data + "END_OF_DATA\n";
}

/// Sides of the elements in a plane that are seen, each edge through its middle node; none where
/// they would lie closer than can be drawn.
std::vector<std::vector<int>> element_sides(const BodyShape& body) {
  constexpr std::size_t most_drawn = 5000;
  std::vector<std::vector<int>> sides;
  if (body.elements.size() > most_drawn) return sides;
  sides = face_loops(body.elements);
  for (std::vector<int>& side : sides) side.push_back(side.front());
  return sides;
}

}  // namespace

double shape_scale(const std::vector<BodyShape>& bodies) {
  double largest = 0.0;
  for (const BodyShape& body : bodies) {
    if (body.displacement.rows() > 0)
      largest = std::max(largest, body.displacement.rowwise().norm().maxCoeff());
  }
  constexpr double share = 0.06;
  return largest > 0.0 ? share * extent_of(bodies, view_of(bodies)).diagonal() / largest : 0.0;
}

namespace {

constexpr double quarter = -0.5 * std::numbers::pi;  // Re(u e^{-iπ/2}) = Im u
constexpr std::array<std::pair<double, const char*>, 2> phases{
    {{0.0, "real part"}, {quarter, "imaginary part"}}};

/// The part of the bodies that the diagrams show, and where they are on the page, cm; one length is
/// the same along both axes.
struct ShapeLayout {
  double scale = 0.0;
  PictureView view;
  ValueRange x_range, y_range;
  AxisScale x, y;
  FigureSize size;
  double line = 0.0;
  double left = 0.0, right = 0.0;
  double below = 0.0, upper = 0.0;  ///< lower edges of the diagrams
  double panel_height = 0.0;
  std::vector<std::string> caption;
  bool has_faces = false;  ///< of bodies in space

  double bottom(std::size_t phase) const { return phase + 1 == phases.size() ? below : upper; }
};

ShapeLayout shape_layout(const ShapePicture& picture) {
  ShapeLayout layout;
  layout.scale = shape_scale(picture.bodies);
  layout.view = view_of(picture.bodies);
  Extent extent = extent_of(picture.bodies, layout.view);
  for (const auto& [phase, name] : phases)
    for (const BodyShape& body : picture.bodies)
      extent.include(displaced(body, layout.view, layout.scale, phase));
  // Nodes along a line make no diagram; a beam does.
  const bool has_points_alone = std::ranges::all_of(picture.bodies, is_of_points);
  const double least_half = has_points_alone ? 0.06 * extent.diagonal() : 0.0;
  for (ValueRange* range : {&extent.x, &extent.y}) {
    const double middle = 0.5 * (range->lower + range->upper);
    *range = {std::min(range->lower, middle - least_half),
              std::max(range->upper, middle + least_half)};
  }
  const double margin = 0.03 * extent.diagonal();
  layout.x_range = {extent.x.lower - margin, extent.x.upper + margin};
  layout.y_range = {extent.y.lower - margin, extent.y.upper + margin};
  layout.x = axis_scale(layout.x_range.lower, layout.x_range.upper, 7);
  layout.y = axis_scale(layout.y_range.lower, layout.y_range.upper, 4);

  layout.line = line_height(layout.size.font_size);
  const double character = character_width(layout.size.font_size);
  layout.left =
      1.4 * layout.line +
      (static_cast<double>(tick_characters(layout.y_range, layout.y)) + 1.3) * character;
  const double widest = layout.size.width - 0.8;
  const double ratio = (layout.y_range.upper - layout.y_range.lower) /
                       (layout.x_range.upper - layout.x_range.lower);
  constexpr double most_height = 12.0;
  layout.panel_height = std::min(most_height, (widest - layout.left) * ratio);
  layout.right = layout.left + layout.panel_height / ratio;
  layout.caption = wrapped(picture.caption, caption_font, layout.size.width - layout.left - 1.2);
  layout.below = 2.7 * layout.line + caption_height(layout.caption);
  layout.upper = layout.below + layout.panel_height + 1.6 * layout.line;
  layout.size.height = layout.upper + layout.panel_height + 1.5 * layout.line;
  return layout;
}

/// The faces of bodies in space at a phase, nearer ones over farther ones; empty where there are
/// none.
std::string face_data(const ShapePicture& picture, const ShapeLayout& layout, std::size_t phase) {
  MeshPicture faces;
  faces.view = layout.view;
  bool has_faces = false;
  for (std::size_t b = 0; b < picture.bodies.size(); ++b) {
    const BodyShape& body = picture.bodies[b];
    PicturePart& part = faces.parts.emplace_back();
    part.colour = shape_colours[b % shape_colours.size()];
    part.nodes = body.nodes +
                 layout.scale * (body.displacement * std::polar(1.0, phases[phase].first)).real();
    part.faces = face_loops(body.elements);
    has_faces = has_faces || !part.faces.empty();
  }
  if (!has_faces) return {};
  PictureCanvas canvas(faces);
  canvas.x = layout.x_range;
  canvas.y = layout.y_range;
  canvas.left = layout.left;
  canvas.bottom = layout.bottom(phase);
  canvas.cm_per_metre =
      (layout.right - layout.left) / (layout.x_range.upper - layout.x_range.lower);
  return polygon_data(fmt::format("$faces_{}", phase), faces, canvas);
}

void add_shape_data(FigureScript& script, const ShapePicture& picture, const ShapeLayout& layout) {
  const AxisScale& x = layout.x;
  const AxisScale& y = layout.y;
  std::string contacts = "$contacts << END_OF_DATA\n";
  for (const Eigen::Vector2d& contact : picture.contacts)
    contacts +=
        fmt::format("{:.7g} {:.7g}\n", as_number(contact.x(), x), as_number(contact.y(), y));
  script.append(contacts + "END_OF_DATA\n");
  for (std::size_t b = 0; b < picture.bodies.size(); ++b) {
    const BodyShape& body = picture.bodies[b];
    const std::vector<std::vector<int>> sides =
        layout.has_faces ? std::vector<std::vector<int>>() : element_sides(body);
    script.append(line_data(fmt::format("$rest_{}", b), body.outlines, seen(body.nodes, layout.view),
                            x, y));
    for (std::size_t p = 0; p < phases.size(); ++p) {
      const Eigen::MatrixX2d moved = displaced(body, layout.view, layout.scale, phases[p].first);
      script.append(line_data(fmt::format("$mesh_{}_{}", b, p), sides, moved, x, y));
      script.append(line_data(fmt::format("$moved_{}_{}", b, p), body.outlines, moved, x, y));
      if (is_of_points(body))
        script.append(arrow_data(fmt::format("$nodes_{}_{}", b, p), seen(body.nodes, layout.view),
                                 moved, x, y));
    }
  }
}

/// The nodes of a body that shows as these alone: grey circles at rest, dots where they move to.
std::string node_plots(const ShapePicture& picture, std::size_t b, std::size_t phase) {
  if (!is_of_points(picture.bodies[b]) || picture.bodies[b].nodes.rows() == 0) return {};
  const double size = picture.bodies[b].nodes.rows() > 200 ? 0.5 : 1.0;
  const std::string colour = fmt::format("#{:06x}", shape_colours[b % shape_colours.size()]);
  return fmt::format(
      ", $nodes_{0}_{1} using 1:2 with points pointtype 6 pointsize {4} linecolor '#909090'"
      ", $nodes_{0}_{1} using 1:2:3:4 with vectors nohead linewidth 1 linecolor '{3}'"
      ", $nodes_{0}_{1} using ($1+$3):($2+$4) with points pointtype 7 pointsize {2} linecolor "
      "'{3}'",
      b, phase, size, colour, 2.2 * size);
}

/// The command of gnuplot that plots a phase.
std::string shape_plots(const ShapePicture& picture, const ShapeLayout& layout, std::size_t phase) {
  std::string plot = "plot NaN";
  if (layout.has_faces) {
    plot += fmt::format(
        ", $faces_{} using 1:2:3 axes x2y2 with filledcurves closed fillcolor rgb variable", phase);
  }
  // gnuplot refuses data without a line; bodies in space have no outlines.
  for (std::size_t b = 0; b < picture.bodies.size(); ++b) {
    if (!picture.bodies[b].outlines.empty())
      plot += fmt::format(", $rest_{} using 1:2 with lines linewidth 0.8 linecolor '#909090'", b);
  }
  for (std::size_t b = 0; b < picture.bodies.size(); ++b) {
    const std::string colour = fmt::format("#{:06x}", shape_colours[b % shape_colours.size()]);
    if (!layout.has_faces && !element_sides(picture.bodies[b]).empty()) {
      plot += fmt::format(", $mesh_{}_{} using 1:2 with lines linewidth 0.5 linecolor '{}'", b,
                          phase, colour);
    }
    if (!picture.bodies[b].outlines.empty()) {
      plot += fmt::format(", $moved_{}_{} using 1:2 with lines linewidth 1.6 linecolor '{}'", b,
                          phase, colour);
    }
  }
  for (std::size_t b = 0; b < picture.bodies.size(); ++b) plot += node_plots(picture, b, phase);
  if (!picture.contacts.empty() && layout.view.is_planar)
    plot +=
        ", $contacts using 1:2 with points pointtype 6 pointsize 1.6 linewidth 2 linecolor "
        "'#e07b00'";
  return plot;
}

void add_shape_panel(FigureScript& script, const ShapePicture& picture, const ShapeLayout& layout,
                     std::size_t phase) {
  const bool is_last = phase + 1 == phases.size();
  const double bottom = layout.bottom(phase);
  if (layout.has_faces) {
    // Faces are given in cm of the page.
    script.add("set x2range [{}:{}]\nset y2range [{}:{}]\nset style fill solid 1.0 noborder",
               layout.left, layout.right, bottom, bottom + layout.panel_height);
  }
  script.set_margins(layout.left, layout.right, bottom, bottom + layout.panel_height);
  script.set_axis('x', layout.x_range, layout.x);
  if (!is_last) script.add("set xtics format ''");
  script.set_axis('y', layout.y_range, layout.y);
  script.add("unset label");
  script.add_text(phases[phase].second, layout.left,
                  bottom + layout.panel_height + 0.65 * layout.line, "left");
  script.add_text(axis_label(layout.view.is_planar ? "y" : "upwards", "m", layout.y),
                  0.7 * layout.line, bottom + 0.5 * layout.panel_height, "center rotate");
  if (is_last) {
    const char* across = layout.view.is_planar
                             ? "x"
                             : "across, x to the lower right, y to the upper right";
    script.add_text(axis_label(across, "m", layout.x), 0.5 * (layout.left + layout.right),
                    layout.below - 1.9 * layout.line, "center");
    script.add_caption(layout.caption, layout.left, layout.below - 2.7 * layout.line);
  }
  script.add("{}", shape_plots(picture, layout, phase));
}

}  // namespace

void plot_shape(const ShapePicture& picture, const std::filesystem::path& figure) {
  check_figure_name(figure);
  ShapeLayout layout = shape_layout(picture);
  FigureScript script(layout.size);
  for (std::size_t phase = 0; !layout.view.is_planar && phase < phases.size(); ++phase) {
    const std::string faces = face_data(picture, layout, phase);
    layout.has_faces = !faces.empty();
    if (layout.has_faces) script.append(faces);
  }
  add_shape_data(script, picture, layout);
  script.add("set multiplot\n{}\nunset key", axes_style);
  for (std::size_t phase = 0; phase < phases.size(); ++phase)
    add_shape_panel(script, picture, layout, phase);
  script.add("unset multiplot");
  draw_figure(figure, script.text(), layout.size);
}

}  // namespace stridor
