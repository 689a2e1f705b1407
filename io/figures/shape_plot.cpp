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
#include "io/results/vtk_writer.hpp"

namespace stridor {
namespace {

constexpr std::array<const char*, 4> shape_colours{"#0b5394", "#c0392b", "#38761d", "#741b47"};

/// The nodes displaced by scale · Re(displacement e^{iφ}).
Eigen::MatrixX2d displaced(const BodyShape& body, double scale, double phase) {
  return body.nodes + scale * (body.displacement * std::polar(1.0, phase)).real();
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

Extent extent_of(const std::vector<BodyShape>& bodies) {
  Extent extent;
  for (const BodyShape& body : bodies) extent.include(body.nodes);
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

/// The sides of the elements, each edge through its middle node; none where they would lie closer
/// than can be drawn.
std::vector<std::vector<int>> element_sides(const BodyShape& body) {
  constexpr std::size_t most_drawn = 5000;
  std::vector<std::vector<int>> sides;
  if (body.elements.size() > most_drawn) return sides;
  for (const DrawnElement& element : body.elements) {
    const auto node = [&](int of_element) {
      return element.nodes[static_cast<std::size_t>(of_element)];
    };
    for (const SideNodes& side : facts_of(element.shape).sides) {
      std::vector<int>& line = sides.emplace_back();
      const int num_edges = side.num_corners == 2 ? 1 : side.num_corners;
      for (int edge = 0; edge < num_edges; ++edge) {
        line.push_back(node(side.nodes[static_cast<std::size_t>(edge)]));
        if (side.count > side.num_corners)
          line.push_back(node(side.nodes[static_cast<std::size_t>(side.num_corners + edge)]));
      }
      line.push_back(node(side.nodes[static_cast<std::size_t>(num_edges % side.num_corners)]));
    }
  }
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
  return largest > 0.0 ? share * extent_of(bodies).diagonal() / largest : 0.0;
}

void plot_shape(const ShapePicture& picture, const std::filesystem::path& figure) {
  check_figure_name(figure);
  const double scale = shape_scale(picture.bodies);
  Extent extent = extent_of(picture.bodies);
  constexpr double quarter = -0.5 * std::numbers::pi;  // Re(u e^{-iπ/2}) = Im u
  const std::array<std::pair<double, const char*>, 2> phases{
      {{0.0, "real part"}, {quarter, "imaginary part"}}};
  for (const auto& [phase, name] : phases)
    for (const BodyShape& body : picture.bodies) extent.include(displaced(body, scale, phase));
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
    script.append(line_data(fmt::format("$rest_{}", b), body.outlines, body.nodes, x, y));
    for (std::size_t p = 0; p < phases.size(); ++p) {
      const Eigen::MatrixX2d moved = displaced(body, scale, phases[p].first);
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
    script.add_text(axis_label("y", "m", y), 0.7 * line, bottom + 0.5 * panel_height,
                    "center rotate");
    if (is_last) {
      script.add_text(axis_label("x", "m", x), 0.5 * (left + right), below - 1.9 * line, "center");
      script.add_caption(caption, left, below - 2.7 * line);
    }
    std::string plot = "plot NaN";
    for (std::size_t b = 0; b < picture.bodies.size(); ++b)
      plot += fmt::format(", $rest_{} using 1:2 with lines linewidth 0.8 linecolor '#909090'", b);
    for (std::size_t b = 0; b < picture.bodies.size(); ++b) {
      const char* colour = shape_colours[b % shape_colours.size()];
      if (!element_sides(picture.bodies[b]).empty()) {
        plot += fmt::format(", $mesh_{}_{} using 1:2 with lines linewidth 0.5 linecolor '{}'", b, p,
                            colour);
      }
      plot += fmt::format(", $moved_{}_{} using 1:2 with lines linewidth 1.6 linecolor '{}'", b, p,
                          colour);
    }
    if (!picture.contacts.empty())
      plot +=
          ", $contacts using 1:2 with points pointtype 6 pointsize 1.6 linewidth 2 linecolor "
          "'#e07b00'";
    script.add("{}", plot);
  }
  script.add("unset multiplot");
  draw_figure(figure, script.text(), size);
}

std::vector<std::filesystem::path> write_shape_frames(const ShapePicture& picture,
                                                      const std::filesystem::path& stem,
                                                      int num_frames) {
  VtkMesh mesh;
  mesh.title = picture.caption;
  int num_points = 0;
  for (std::size_t b = 0; b < picture.bodies.size(); ++b) {
    const BodyShape& body = picture.bodies[b];
    for (const DrawnElement& element : body.elements) {
      VtkMesh::Cell& cell =
          mesh.cells.emplace_back(VtkMesh::Cell{vtk_cell_type(element.shape), element.nodes});
      for (int& node : cell.points) node += num_points;
      mesh.parts.push_back(static_cast<int>(b));
    }
    // A body of another kind shows its outline.
    for (std::size_t i = 0; body.elements.empty() && i < body.outlines.size(); ++i) {
      VtkMesh::Cell& line =
          mesh.cells.emplace_back(VtkMesh::Cell{VtkMesh::poly_line, body.outlines[i]});
      for (int& node : line.points) node += num_points;
      mesh.parts.push_back(static_cast<int>(b));
    }
    num_points += static_cast<int>(body.nodes.rows());
  }
  // The points of all bodies, displaced.
  const auto stacked = [&](double scale, double phase) {
    Eigen::MatrixX2d points(num_points, 2);
    Eigen::Index first = 0;
    for (const BodyShape& body : picture.bodies) {
      points.middleRows(first, body.nodes.rows()) = displaced(body, scale, phase);
      first += body.nodes.rows();
    }
    return points;
  };
  const Eigen::MatrixX2d rest = stacked(0.0, 0.0);
  std::vector<std::filesystem::path> files;
  const auto write = [&](const std::string& ending) {
    files.push_back(stem);
    files.back() += ending;
    write_vtk(files.back(), mesh);
  };
  mesh.points = rest;
  mesh.vectors = {{"real", stacked(1.0, 0.0) - rest},
                  {"imaginary", stacked(1.0, -0.5 * std::numbers::pi) - rest}};
  write(".vtk");
  const double scale = shape_scale(picture.bodies);
  for (int frame = 0; frame < num_frames; ++frame) {
    const double phase = 2.0 * std::numbers::pi * frame / num_frames;
    mesh.points = stacked(scale, phase);
    mesh.vectors = {{"displacement", stacked(1.0, phase) - rest}};
    write(fmt::format("_frame_{:03}.vtk", frame));
  }
  return files;
}

}  // namespace stridor
