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
#include "io/results/vtu_writer.hpp"

namespace stridor {
namespace {

constexpr std::array<const char*, 4> shape_colours{"#0b5394", "#c0392b", "#38761d", "#741b47"};

/// How bodies are seen: in their plane, or from above where one of them has volumes.
PictureView view_of(const std::vector<BodyShape>& bodies) {
  for (const BodyShape& body : bodies) {
    if (!body.elements.empty() && facts_of(body.elements.front().shape).dimension == 3)
      return PictureView::isometric();
  }
  return PictureView::plane();
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

struct Extent {
  ValueRange x, y;
  void include(const Eigen::MatrixX2d& nodes) {
    const auto size = static_cast<std::size_t>(nodes.rows());
    x.include({nodes.col(0).data(), size});
    y.include({nodes.col(1).data(), size});
  }
  double diagonal() const { return std::hypot(x.upper - x.lower, y.upper - y.lower); }
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

/// What is seen of the elements, each edge through its middle node; none where they would lie closer
/// than can be drawn.
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

void plot_shape(const ShapePicture& picture, const std::filesystem::path& figure) {
  check_figure_name(figure);
  const double scale = shape_scale(picture.bodies);
  const PictureView view = view_of(picture.bodies);
  Extent extent = extent_of(picture.bodies, view);
  constexpr double quarter = -0.5 * std::numbers::pi;  // Re(u e^{-iπ/2}) = Im u
  const std::array<std::pair<double, const char*>, 2> phases{
      {{0.0, "real part"}, {quarter, "imaginary part"}}};
  for (const auto& [phase, name] : phases)
    for (const BodyShape& body : picture.bodies) extent.include(displaced(body, view, scale, phase));
  const double margin = 0.03 * extent.diagonal();
  const ValueRange x_range{extent.x.lower - margin, extent.x.upper + margin};
  const ValueRange y_range{extent.y.lower - margin, extent.y.upper + margin};
  const AxisScale x = axis_scale(x_range.lower, x_range.upper, 7);
  const AxisScale y = axis_scale(y_range.lower, y_range.upper, 4);

  // All lengths in cm; one length is the same along both axes.
  FigureSize size;
  const double line = line_height(size.font_size);
  const double character = character_width(size.font_size);
  const double left =
      1.4 * line + (static_cast<double>(tick_characters(y_range, y)) + 1.3) * character;
  double right = size.width - 0.8;
  const double ratio = (y_range.upper - y_range.lower) / (x_range.upper - x_range.lower);
  constexpr double most_height = 12.0;
  const double panel_height = std::min(most_height, (right - left) * ratio);
  right = left + panel_height / ratio;
  const std::vector<std::string> caption =
      wrapped(picture.caption, caption_font, size.width - left - 1.2);
  const double below = 2.7 * line + caption_height(caption);
  const double upper = below + panel_height + 1.6 * line;
  size.height = upper + panel_height + 1.5 * line;

  FigureScript script(size);
  std::string contacts = "$contacts << END_OF_DATA\n";
  for (const Eigen::Vector2d& contact : picture.contacts)
    contacts +=
        fmt::format("{:.7g} {:.7g}\n", as_number(contact.x(), x), as_number(contact.y(), y));
  script.append(contacts + "END_OF_DATA\n");
  for (std::size_t b = 0; b < picture.bodies.size(); ++b) {
    const BodyShape& body = picture.bodies[b];
    const std::vector<std::vector<int>> sides = element_sides(body);
    script.append(line_data(fmt::format("$rest_{}", b), body.outlines, seen(body.nodes, view), x, y));
    for (std::size_t p = 0; p < phases.size(); ++p) {
      const Eigen::MatrixX2d moved = displaced(body, view, scale, phases[p].first);
      script.append(line_data(fmt::format("$mesh_{}_{}", b, p), sides, moved, x, y));
      script.append(line_data(fmt::format("$moved_{}_{}", b, p), body.outlines, moved, x, y));
    }
  }
  script.add("set multiplot\n{}\nunset key", axes_style);
  for (std::size_t p = 0; p < phases.size(); ++p) {
    const bool is_last = p + 1 == phases.size();
    const double bottom = is_last ? below : upper;
    script.set_margins(left, right, bottom, bottom + panel_height);
    script.set_axis('x', x_range, x);
    if (!is_last) script.add("set xtics format ''");
    script.set_axis('y', y_range, y);
    script.add("unset label");
    script.add_text(phases[p].second, left, bottom + panel_height + 0.65 * line, "left");
    script.add_text(axis_label(view.is_planar ? "y" : "upwards", "m", y), 0.7 * line, bottom + 0.5 * panel_height,
                    "center rotate");
    if (is_last) {
      script.add_text(axis_label(view.is_planar ? "x" : "across, x to the lower right, y to the upper right", "m", x), 0.5 * (left + right), below - 1.9 * line, "center");
      script.add_caption(caption, left, below - 2.7 * line);
    }
    std::string plot = "plot NaN";
    // gnuplot refuses data without a line; bodies in space have no outlines.
    for (std::size_t b = 0; b < picture.bodies.size(); ++b) {
      if (!picture.bodies[b].outlines.empty())
        plot += fmt::format(", $rest_{} using 1:2 with lines linewidth 0.8 linecolor '#909090'", b);
    }
    for (std::size_t b = 0; b < picture.bodies.size(); ++b) {
      const char* colour = shape_colours[b % shape_colours.size()];
      if (!element_sides(picture.bodies[b]).empty()) {
        plot += fmt::format(", $mesh_{}_{} using 1:2 with lines linewidth 0.5 linecolor '{}'", b, p,
                            colour);
      }
      if (!picture.bodies[b].outlines.empty()) {
        plot += fmt::format(", $moved_{}_{} using 1:2 with lines linewidth 1.6 linecolor '{}'", b, p,
                            colour);
      }
    }
    if (!picture.contacts.empty() && view.is_planar)
      plot +=
          ", $contacts using 1:2 with points pointtype 6 pointsize 1.6 linewidth 2 linecolor "
          "'#e07b00'";
    script.add("{}", plot);
  }
  script.add("unset multiplot");
  draw_figure(figure, script.text(), size);
}

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
