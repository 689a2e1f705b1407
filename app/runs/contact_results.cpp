#include "app/runs/contact_results.hpp"

#include <fmt/format.h>

#include <array>
#include <filesystem>
#include <limits>
#include <utility>

#include "app/results/file_attributes.hpp"
#include "io/figures/gnuplot.hpp"
#include "io/figures/panel_plot.hpp"
#include "io/hdf5/part_file.hpp"

namespace stridor {
namespace {

std::string source_text(const ContactOptions& options, const LoadedScene& loaded) {
  return fmt::format("{}, scene {}", std::filesystem::path(options.scene).filename().string(),
                     loaded.hash());
}

}  // namespace

void write_rows(const ContactOptions& options, const LoadedScene& loaded,
                const std::vector<LawRow>& rows) {
  std::vector<ContactColumn> columns;
  const auto add = [&](const char* name, auto&& of) {
    ContactColumn column{name, "1", {}};
    for (const LawRow& row : rows) column.values.push_back(static_cast<double>(of(row)));
    columns.push_back(std::move(column));
  };
  add("speed", [](const LawRow& row) { return row.speed; });
  add("indentation", [](const LawRow& row) { return row.indentation; });
  add("force", [](const LawRow& row) { return row.force; });
  add("area", [](const LawRow& row) { return row.area; });
  add("friction", [](const LawRow& row) { return row.result.friction; });
  add("converged", [](const LawRow& row) { return row.result.converged; });
  add("touches_window", [](const LawRow& row) { return row.result.touches_window; });
  add("has_resolved_edge", [](const LawRow& row) { return row.result.has_resolved_edge; });
  add("memory_in_cells", [](const LawRow& row) { return row.result.memory_in_cells; });
  add("rounds", [](const LawRow& row) { return row.result.rounds; });
  add("products", [](const LawRow& row) { return row.result.products; });
  add("residual", [](const LawRow& row) { return row.result.residual; });
  std::vector<ContactFields> fields;
  fields.reserve(rows.size());
  for (const LawRow& row : rows)
    if (!row.fields.x.empty()) fields.push_back(row.fields);
  write_contact_file(*options.output, options.common.overwrite(), columns, fields,
                     source_attributes(loaded, options.command_line));
}

void draw_pressure(const ContactOptions& options, const LoadedScene& loaded,
                   const StudiedContact& contact, const LawRow& row) {
  const double radius = contact.normal.tip_radius();
  const double modulus = contact.normal.composite_modulus();
  FieldPicture picture;
  picture.num_columns = row.fields.x.size();
  picture.cell_side = (row.fields.x[1] - row.fields.x[0]) / radius;
  for (const double p : row.fields.pressure) {
    picture.values.push_back(p > 0.0 ? p / modulus : std::numeric_limits<double>::quiet_NaN());
  }
  picture.x_label = "x/R, sliding towards +x";
  picture.y_label = "y/R";
  picture.value_label = "pressure/E₀*";
  for (const auto& [x, y] : row.fields.edge) {
    picture.curve_x.push_back(x / radius);
    picture.curve_y.push_back(y / radius);
  }
  plot_field(
      picture,
      fmt::format("Contact pressure at speed v τ/R = {:g} and indentation y/R = {:.4g}, with "
                  "the edge of the contact. {}.",
                  row.speed, row.indentation, source_text(options, loaded)),
      *options.pressure_figure);
}

void draw_edges(const ContactOptions& options, const LoadedScene& loaded,
                const StudiedContact& contact, const std::vector<LawRow>& rows) {
  const double radius = contact.normal.tip_radius();
  DiagramPanel panel;
  panel.x_label = "x/R, sliding towards +x";
  panel.y_label = "y/R";
  panel.is_to_scale = true;
  for (std::size_t k = 0; k < rows.size(); ++k) {
    const auto& edge = rows[k].fields.edge;
    if (edge.empty()) continue;
    PanelCurve curve;
    curve.label = rows.size() <= 12 ? fmt::format("{:g}", rows[k].speed) : "";
    curve.colour = static_cast<int>(k);
    const auto add = [&](const std::array<double, 2>& point, double side) {
      curve.x.push_back(point[0] / radius);
      curve.y.push_back(side * point[1] / radius);
    };
    for (const auto& point : edge) add(point, 1.0);
    for (std::size_t i = edge.size(); i-- > 0;) add(edge[i], -1.0);
    add(edge.front(), 1.0);
    panel.curves.push_back(std::move(curve));
  }
  plot_panels(
      {panel},
      fmt::format("Edge of the contact at several speeds v τ/R. {}.", source_text(options, loaded)),
      *options.edges_figure);
}

}  // namespace stridor
