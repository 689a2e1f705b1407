#include "app/runs/swept_transients.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <filesystem>
#include <limits>
#include <utility>

#include "app/results/file_attributes.hpp"
#include "app/results/row_columns.hpp"
#include "app/stability/axis_units.hpp"
#include "io/figures/panel_plot.hpp"

namespace stridor {
namespace {

/// The results of every transient that are written.
constexpr std::array swept_numbers{
    RowNumber{"/acceleration_peak", "m/s^2", "/free_end_acceleration/peak"},
    RowNumber{"/acceleration_rms", "m/s^2", "/free_end_acceleration/rms"},
    RowNumber{"/force_min", "N", "/contact_force/min"},
    RowNumber{"/force_max", "N", "/contact_force/max"},
    RowNumber{"/stick_fraction", "1", "/stick_fraction"},
    RowNumber{"/free_fraction", "1", "/free_fraction"},
    RowNumber{"/violations", "1", "/violations"},
    RowNumber{"/steps", "1", "/steps"}};

std::vector<double> column(const SweptTransients& points, const char* pointer) {
  std::vector<double> values;
  for (const SweptTransient& point : points) values.push_back(point.number_at(pointer));
  return values;
}

std::vector<double> values_of(const SweptTransients& points) {
  std::vector<double> values;
  for (const SweptTransient& point : points) values.push_back(point.value);
  return values;
}

/// All bursts of all transients, one after the other.
std::vector<Column> columns_of_bursts(const NumericKey& key, const SweptTransients& points) {
  const std::pair<const char*, const char*> properties[] = {
      {"start", "s"}, {"end", "s"}, {"frequency", "Hz"}, {"peak", "m/s^2"}, {"gain", "1"}};
  Column burst_value{"/bursts/value", printed_units(key), {}, {}, true};
  std::vector<Column> bursts;
  for (const auto& [name, units] : properties)
    bursts.push_back({std::string("/bursts/") + name, units, {}});
  for (const SweptTransient& point : points) {
    if (!point.has_bursts()) continue;
    for (const Json& burst : point.results["bursts"]) {
      burst_value.values.push_back(point.value);
      for (std::size_t k = 0; k < bursts.size(); ++k)
        bursts[k].values.push_back(burst[properties[k].first].get<double>());
    }
  }
  bursts.insert(bursts.begin(), burst_value);
  return bursts;
}

}  // namespace

void write_swept(const SweepOptions& options, const LoadedScene& loaded, const NumericKey& key,
                 const SweptTransients& points) {
  std::vector<Column> columns{{"/value", printed_units(key), values_of(points), {}, true}};
  Column failed{"/failed", "1", {}};
  Column reason{"/reason", "", {}};
  Column num_bursts{"/num_bursts", "1", {}};
  for (const SweptTransient& point : points) {
    failed.values.push_back(point.failure.empty() ? 0.0 : 1.0);
    reason.texts.push_back(point.reason());
    num_bursts.values.push_back(point.has_bursts()
                                    ? static_cast<double>(point.results["bursts"].size())
                                    : std::numeric_limits<double>::quiet_NaN());
  }
  columns.push_back(failed);
  columns.push_back(reason);
  columns.push_back(num_bursts);
  append_numbers(
      swept_numbers, points,
      [](const SweptTransient& point) -> const Json& { return point.results; }, columns);
  const std::vector<Column> bursts = columns_of_bursts(key, points);
  columns.insert(columns.end(), bursts.begin(), bursts.end());
  Attributes attributes = source_attributes(loaded, options.command_line);
  attributes.emplace_back("parameter", key.path);
  write_column_file(*options.output, options.common.overwrite(), "sweep of transients", columns,
                    attributes);
}

void draw_swept(const SweepOptions& options, const LoadedScene& loaded, const NumericKey& key,
                const SweptTransients& points) {
  const AxisUnit unit = axis_unit(key, {options.range.from, options.range.to}, &loaded.tree);
  const std::string x_label =
      key.unit.empty() ? key.path : fmt::format("{} ({})", key.path, unit.name);
  const auto panel = [&](const char* y_label) {
    DiagramPanel one;
    one.x_label = x_label;
    one.y_label = y_label;
    if (options.scale == "log") one.x_kind = AxisKind::logarithmic;
    return one;
  };
  const std::vector<double> values = unit.numbers(values_of(points));
  std::vector<DiagramPanel> panels;
  const std::vector<double> rms = column(points, "/free_end_acceleration/rms");
  if (std::any_of(rms.begin(), rms.end(), [](double one) { return std::isfinite(one); })) {
    panels.push_back(panel("acceleration (m/s²)"));
    panels.back().y_kind = AxisKind::logarithmic;
    panels.back().curves = {
        {"r.m.s. in the band", values, rms, Mark::line, 0},
        {"peak", values, column(points, "/free_end_acceleration/peak"), Mark::line, 1}};
  }
  PanelCurve bursts{"", {}, {}, Mark::points, 2};
  for (const SweptTransient& point : points) {
    if (!point.has_bursts()) continue;
    for (const Json& burst : point.results["bursts"]) {
      bursts.x.push_back(unit.number(point.value));
      bursts.y.push_back(1e-3 * burst["frequency"].get<double>());
    }
  }
  if (!bursts.x.empty()) {
    panels.push_back(panel("frequency of bursts (kHz)"));
    panels.back().curves = {bursts};
  }
  if (points.front().results.contains("contact_force")) {
    panels.push_back(panel("contact force (N)"));
    panels.back().curves = {
        {"largest", values, column(points, "/contact_force/max"), Mark::line, 0},
        {"smallest", values, column(points, "/contact_force/min"), Mark::line, 1}};
  }
  if (panels.empty()) {
    panels.push_back(panel("part of the time that it sticks"));
    panels.back().curves = {{"", values, column(points, "/stick_fraction"), Mark::line, 0}};
  }
  plot_panels(panels,
              fmt::format("{} transients, scene {} ({}).", points.size(),
                          std::filesystem::path(options.scene).filename().string(), loaded.hash()),
              *options.figure);
}

void print_swept(const NumericKey& key, const SweptTransients& points) {
  const auto text = [](double value) {
    return std::isfinite(value) ? fmt::format("{:.5g}", value) : std::string("-");
  };
  fmt::print("{:>14} {:>8} {:>11} {:>11} {:>7} {:>11} {:>8} {:>8} {:>9}\n", "value", "status",
             "peak m/s^2", "rms m/s^2", "bursts", "at Hz", "stick %", "open %", "wall s");
  for (const SweptTransient& point : points) {
    const Json largest = point.largest_burst();
    fmt::print("{:>14.6g} {:>8} {:>11} {:>11} {:>7} {:>11} {:>8} {:>8} {:>9}\n", point.value,
               point.results["status"].get<std::string>(),
               text(point.number_at("/free_end_acceleration/peak")),
               text(point.number_at("/free_end_acceleration/rms")),
               point.has_bursts() ? fmt::format("{}", point.results["bursts"].size()) : "-",
               largest.is_null() ? "-" : text(largest["frequency"].get<double>()),
               text(100.0 * point.number_at("/stick_fraction")),
               text(100.0 * point.number_at("/free_fraction")), text(point.number_at("/wall_s")));
  }
  for (const SweptTransient& point : points) {
    if (!point.failure.empty())
      fmt::print("{}: {}\n", value_text(key, point.value), point.reason());
  }
}

Json json_of_swept(const SweptTransients& points) {
  Json rows = Json::array();
  for (const SweptTransient& point : points) {
    Json row = {{"value", point.value}};
    row.update(point.results);
    if (!point.failure.empty()) row["failure"] = point.reason();
    rows.push_back(std::move(row));
  }
  return rows;
}

}  // namespace stridor
