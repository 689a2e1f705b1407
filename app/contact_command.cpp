// stridor contact: sliding contact of an indenter on a viscoelastic half-space.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <limits>
#include <memory>
#include <optional>

#include "app/command.hpp"
#include "app/expectations.hpp"
#include "app/progress.hpp"
#include "core/errors.hpp"
#include "core/stop_token.hpp"
#include "core/version.hpp"
#include "io/contact_file.hpp"
#include "io/contact_scene.hpp"
#include "io/gnuplot.hpp"
#include "io/law_table_file.hpp"
#include "io/panel_plot.hpp"
#include "io/part_file.hpp"
#include "solvers/contact_table.hpp"
#include "solvers/master_curve.hpp"

namespace stridor {
namespace {

struct ContactOptions {
  CommonOptions common;
  std::string scene;
  std::vector<double> speeds;
  std::vector<double> indentations;
  std::vector<double> loads;
  std::optional<std::string> output;
  std::optional<std::string> pressure_figure;
  std::optional<std::string> edges_figure;
  std::optional<std::string> master_curve;
  std::optional<std::string> table;
  std::vector<double> table_speeds{1e-3, 1e3, 49};        ///< first, last, number
  std::vector<double> table_indentations{1e-4, 0.3, 15};  ///< likewise
  bool verify = false;
  std::string command_line;
};

/// One contact as it is reported: dimensionless, with the fields where they are wanted.
struct Row {
  double speed = 0.0;        ///< v̂
  double indentation = 0.0;  ///< ŷ
  double force = 0.0;        ///< F̃
  double area = 0.0;         ///< Ã
  SlidingContactResult result;
  ContactFields fields;
};

/// Refuses loads that an indenter of finite size cannot carry.
void check_reach(const LoadedContactScene& loaded, const SlidingPoints& points) {
  const double radius = loaded.scene.profile.radius;
  const IndenterProfile profile(loaded.scene.profile);
  for (const double indentation : points.indentations) {
    if (!profile.elastic_contact_radius(indentation * radius)) {
      throw loaded.problem(
          "profile", fmt::format("is in contact up to its end at an indentation of {:g} R; its "
                                 "table must reach further",
                                 indentation));
    }
  }
  const double reach = profile.reach();
  for (const double load : points.loads) {
    if (std::isfinite(reach) && profile.elastic_force(reach) <= load * radius * radius) {
      throw loaded.problem(
          "profile", fmt::format("is in contact up to its end under a load of {:g} E_0* R2", load));
    }
  }
}

/// The points of the scene, overridden by those of the command line.
SlidingPoints settle_points(const ContactOptions& options, const LoadedContactScene& loaded) {
  SlidingPoints points = loaded.scene.sliding;
  const auto check = [](const char* option, const std::vector<double>& values, const Range& range) {
    for (const double value : values) {
      if (!range.contains(value))
        throw ConfigError(option, fmt::format("{:g} must be {}", value, range.text()));
    }
  };
  check("--speed", options.speeds, Range::any());
  check("--indentation", options.indentations, Range::positive());
  check("--load", options.loads, Range::positive());
  if (!options.speeds.empty()) points.speeds = options.speeds;
  if (!options.indentations.empty() || !options.loads.empty()) {
    points.indentations = options.indentations;
    points.loads = options.loads;
  }
  if (points.speeds.empty())
    throw ConfigError("--speed", "is needed, since the scene has no sliding.speeds");
  if (points.indentations.empty() && points.loads.empty()) {
    throw ConfigError("--indentation",
                      "or --load is needed, since the scene has no sliding.indentations");
  }
  check_reach(loaded, points);
  return points;
}

ContactFields fields_of(const SlidingContact& contact, double composite_modulus) {
  const auto n = static_cast<std::size_t>(contact.parameters().grid);
  const double side = contact.cell_side();
  ContactFields fields;
  for (std::size_t i = 0; i < n; ++i)
    fields.x.push_back((static_cast<double>(i) + 0.5 - 0.5 * static_cast<double>(n)) * side);
  for (std::size_t j = 0; j < n / 2; ++j) fields.y.push_back((static_cast<double>(j) + 0.5) * side);
  fields.pressure = contact.pressure();
  for (double& p : fields.pressure) p *= composite_modulus;
  fields.gap = contact.gap();
  for (const auto& [x, y] : contact.edge().points) fields.edge.push_back({x * side, y * side});
  return fields;
}

std::vector<Row> compute_rows(const ContactOptions& options, const LoadedContactScene& loaded,
                              const SlidingPoints& points) {
  const ContactScene& scene = loaded.scene;
  const double radius = scene.profile.radius;
  const bool keeps_fields = options.output || options.pressure_figure || options.edges_figure;
  SlidingContact contact(scene.contact_solver, IndenterProfile(scene.profile));
  const bool is_loaded = !points.loads.empty();
  const std::vector<double>& depths = is_loaded ? points.loads : points.indentations;
  std::vector<Row> rows;
  Progress progress("contact");
  for (const double depth : depths) {
    for (const double speed : points.speeds) {
      if (stop_requested()) throw Interrupted("nothing has been written");
      const CreepLengths creep = creep_lengths(scene, speed);
      Row row;
      row.speed = speed;
      row.result = is_loaded ? contact.load(depth * radius * radius, creep)
                             : contact.indent(depth * radius, creep);
      row.indentation = row.result.indentation / radius;
      row.force = row.result.force / (radius * radius);
      row.area = row.result.area / (radius * radius);
      if (keeps_fields) row.fields = fields_of(contact, scene.material.composite_modulus());
      rows.push_back(std::move(row));
      progress.report(static_cast<double>(rows.size()) /
                          static_cast<double>(depths.size() * points.speeds.size()),
                      fmt::format("speed {:g}, indentation {:g}", speed, rows.back().indentation));
    }
  }
  progress.finish();
  return rows;
}

Json row_json(const Row& row) {
  const SlidingContactResult& result = row.result;
  return {{"speed", row.speed},
          {"indentation", row.indentation},
          {"force", number(row.force)},
          {"area", number(row.area)},
          {"friction", number(result.friction)},
          {"converged", result.converged},
          {"touches_window", result.touches_window},
          {"has_resolved_edge", result.has_resolved_edge},
          {"memory_in_cells", number(result.memory_in_cells)},
          {"rounds", result.rounds},
          {"products", result.products},
          {"residual", number(result.residual)},
          {"remarks", result.remarks()}};
}

Attributes file_attributes(const ContactOptions& options, const LoadedContactScene& loaded) {
  return {{"scene", options.scene},
          {"scene_hash", loaded.hash()},
          {"scene_resolved", loaded.resolved()},
          {"command", options.command_line},
          {"version", std::string(version)},
          {"commit", std::string(commit)},
          {"date", utc_now()}};
}

void write_file(const ContactOptions& options, const LoadedContactScene& loaded,
                const std::vector<Row>& rows) {
  std::vector<ContactColumn> columns;
  const auto add = [&](const char* name, auto&& of) {
    ContactColumn column{name, "1", {}};
    for (const Row& row : rows) column.values.push_back(static_cast<double>(of(row)));
    columns.push_back(std::move(column));
  };
  add("speed", [](const Row& row) { return row.speed; });
  add("indentation", [](const Row& row) { return row.indentation; });
  add("force", [](const Row& row) { return row.force; });
  add("area", [](const Row& row) { return row.area; });
  add("friction", [](const Row& row) { return row.result.friction; });
  add("converged", [](const Row& row) { return row.result.converged; });
  add("touches_window", [](const Row& row) { return row.result.touches_window; });
  add("has_resolved_edge", [](const Row& row) { return row.result.has_resolved_edge; });
  add("memory_in_cells", [](const Row& row) { return row.result.memory_in_cells; });
  add("rounds", [](const Row& row) { return row.result.rounds; });
  add("products", [](const Row& row) { return row.result.products; });
  add("residual", [](const Row& row) { return row.result.residual; });
  std::vector<ContactFields> fields;
  fields.reserve(rows.size());
  for (const Row& row : rows) fields.push_back(row.fields);
  write_contact_file(*options.output, options.common.overwrite(), columns, fields,
                     file_attributes(options, loaded));
}

std::string source_text(const ContactOptions& options, const LoadedContactScene& loaded) {
  return fmt::format("{}, scene {}", std::filesystem::path(options.scene).filename().string(),
                     loaded.hash());
}

void draw_pressure(const ContactOptions& options, const LoadedContactScene& loaded,
                   const Row& row) {
  const double radius = loaded.scene.profile.radius;
  const double modulus = loaded.scene.material.composite_modulus();
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

void draw_edges(const ContactOptions& options, const LoadedContactScene& loaded,
                const std::vector<Row>& rows) {
  const double radius = loaded.scene.profile.radius;
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

/// Computes the master curve of the scene's material and writes it as rows of C++.
ExitCode make_master_curve(const ContactOptions& options, const LoadedContactScene& loaded) {
  const ContactScene& scene = loaded.scene;
  if (scene.profile.shape != ProfileShape::paraboloid)
    throw loaded.problem("profile.shape", "must be paraboloid: only these lie on one curve");
  if (scene.material.creep_times.size() != 1)
    throw loaded.problem("material.creep_times",
                         "must be one: only then do contacts lie on one curve");
  const std::string& path = *options.master_curve;
  check_output(path, options.common.overwrite());
  const std::vector<double> betas = master_curve_betas();
  Progress progress("master curve");
  const ComputedMasterCurve computed = compute_master_curve(
      scene.material.modulus_ratio(), betas, scene.contact_solver, [&](std::size_t done) {
        if (stop_requested()) throw Interrupted("nothing has been written");
        progress.report(static_cast<double>(done) / static_cast<double>(betas.size()),
                        fmt::format("point {} of {}", done, betas.size()));
      });
  progress.finish();
  std::string text = fmt::format(
      "// beta, f, g, m, v tau in cells: a paraboloid with E_0/E_inf = {:g} on {} cells a side, "
      "tolerance\n// {:g}. Made by `stridor contact --master-curve`; do not edit.\n",
      computed.curve.modulus_ratio, scene.contact_solver.grid, scene.contact_solver.tolerance);
  Json points = Json::array();
  for (std::size_t k = 0; k < computed.results.size(); ++k) {
    const MasterPoint& point = computed.curve.points[k];
    text += fmt::format("{{{}, {:.8g}, {:.6g}, {:.7g}, {:.6g}}},\n", point.beta, point.force,
                        point.area, point.friction, point.memory_in_cells);
    points.push_back({{"beta", point.beta},
                      {"force", number(point.force)},
                      {"area", number(point.area)},
                      {"friction", number(point.friction)},
                      {"converged", computed.results[k].converged},
                      {"remarks", computed.results[k].remarks()}});
  }
  if (!computed.converged())
    throw NumericalError("a point of the master curve did not converge; nothing has been written");
  write_text_file(path, text);
  if (options.common.json) {
    print_json(Json{{"modulus_ratio", computed.curve.modulus_ratio}, {"points", points}});
  } else {
    fmt::print("{} points\n{}\n", computed.results.size(), path);
  }
  return ExitCode::done;
}

/// Computes a table of contacts, which an oscillator takes as its contact law.
ExitCode make_table(const ContactOptions& options, const LoadedContactScene& loaded) {
  const ContactScene& scene = loaded.scene;
  const std::string& path = *options.table;
  const Overwrite overwrite = options.common.overwrite();
  check_output(path, overwrite);
  SlidingPoints points;
  points.speeds = spaced_values("--speeds", options.table_speeds);
  points.indentations = spaced_values("--indentations", options.table_indentations);
  check_reach(loaded, points);
  const auto num_contacts = static_cast<double>(points.speeds.size() * points.indentations.size());
  Progress progress("contact table");
  const ComputedContactTable computed = compute_contact_table(
      IndenterProfile(scene.profile), creep_lengths(scene, 1.0), points.speeds, points.indentations,
      scene.contact_solver, [&](std::size_t done) {
        if (stop_requested()) throw Interrupted("nothing has been written");
        progress.report(static_cast<double>(done) / num_contacts,
                        fmt::format("contact {} of {:g}", done, num_contacts));
      });
  progress.finish();
  const auto count = [&](auto&& is_so) {
    return std::count_if(computed.results.begin(), computed.results.end(), is_so);
  };
  if (!computed.converged()) {
    throw NumericalError(fmt::format(
        "{} of {:g} contacts of the table did not converge; nothing has been written",
        count([](const SlidingContactResult& result) { return !result.converged; }), num_contacts));
  }
  const auto is_positive = [](double value) { return value > 0.0; };
  if (!std::all_of(computed.table.friction.begin(), computed.table.friction.end(), is_positive)) {
    throw NumericalError(
        "the friction of a contact of the table is not > 0, since its speed is too low for the "
        "grid: begin at a higher one, or lower contact_solver.tolerance; nothing has been written");
  }
  std::vector<double> memory_in_cells;
  for (const SlidingContactResult& result : computed.results)
    memory_in_cells.push_back(result.memory_in_cells);
  write_law_table(path, overwrite, computed.table, memory_in_cells,
                  file_attributes(options, loaded));
  const auto num_unresolved =
      count([](const SlidingContactResult& result) { return !result.has_resolved_memory(); });
  const auto num_touching =
      count([](const SlidingContactResult& result) { return result.touches_window; });
  if (options.common.json) {
    print_json(Json{{"speeds", points.speeds},
                            {"indentations", points.indentations},
                            {"force", computed.table.force},
                            {"area", computed.table.area},
                            {"friction", computed.table.friction},
                            {"num_unresolved", num_unresolved},
                            {"num_touching_window", num_touching}});
  } else {
    fmt::print("{} speeds, {} indentations\n", points.speeds.size(), points.indentations.size());
    if (num_unresolved > 0) {
      fmt::print(
          "{} contacts: the layer of length v tau at the edge is less than two cells wide "
          "and not resolved: the friction is too low\n",
          num_unresolved);
    }
    if (num_touching > 0) {
      fmt::print("{} contacts reach the border of the window: enlarge it\n", num_touching);
    }
    fmt::print("{}\n", path);
  }
  return ExitCode::done;
}

ExitCode contact(const ContactOptions& options) {
  if (options.output) check_output(*options.output, options.common.overwrite());
  for (const auto& figure : {options.pressure_figure, options.edges_figure}) {
    if (figure) check_figure(*figure, options.common);
  }
  const LoadedContactScene loaded = load_contact_scene(options.scene, options.common.sets);
  if (options.master_curve) return make_master_curve(options, loaded);
  if (options.table) return make_table(options, loaded);
  const SlidingPoints points = settle_points(options, loaded);
  const std::vector<Row> rows = compute_rows(options, loaded, points);

  if (options.output) write_file(options, loaded, rows);
  if (options.pressure_figure) draw_pressure(options, loaded, rows.back());
  if (options.edges_figure) draw_edges(options, loaded, rows);

  Json results = {{"rows", Json::array()}};
  for (const Row& row : rows) results["rows"].push_back(row_json(row));
  if (options.common.json) {
    print_json(results);
  } else {
    fmt::print("{:>12} {:>12} {:>14} {:>14} {:>14}\n", "speed", "indentation", "force", "area",
               "friction");
    for (const Row& row : rows) {
      fmt::print("{:>12.6g} {:>12.6g} {:>14.7g} {:>14.7g} {:>14.7g}\n", row.speed, row.indentation,
                 row.force, row.area, row.result.friction);
      for (const std::string& remark : row.result.remarks()) fmt::print("  {}\n", remark);
    }
    for (const auto& file : {options.output, options.pressure_figure, options.edges_figure})
      if (file) fmt::print("{}\n", *file);
  }
  std::fflush(stdout);
  const auto num_failed =
      std::count_if(rows.begin(), rows.end(), [](const Row& row) { return !row.result.converged; });
  if (num_failed > 0) {
    throw NumericalError(
        fmt::format("{} of {} contacts did not converge", num_failed, rows.size()));
  }
  if (options.verify) check_expectations(loaded.scene.expect, results);
  return ExitCode::done;
}

}  // namespace

void add_contact_command(CLI::App& program, Action& action, const std::string& command_line) {
  auto options = std::make_shared<ContactOptions>();
  options->command_line = command_line;
  CLI::App* verb = program.add_subcommand(
      "contact", "Sliding contact on a viscoelastic half-space: force, area, friction");
  verb->add_option("scene", options->scene, "Scene file (YAML) with material and profile")
      ->required();
  verb->add_option("--speed", options->speeds, "Sliding speeds v tau/R, separated by commas")
      ->delimiter(',')
      ->allow_extra_args(false)
      ->type_name("A,B,...");
  CLI::Option* indentation =
      verb->add_option("--indentation", options->indentations, "Indentations y/R")
          ->delimiter(',')
          ->allow_extra_args(false)
          ->type_name("A,B,...");
  verb->add_option("--load", options->loads, "Normal forces F/(E_0* R^2) instead of indentations")
      ->delimiter(',')
      ->allow_extra_args(false)
      ->type_name("A,B,...")
      ->excludes(indentation);
  verb->add_option("-o,--output", options->output,
                   "File to write (HDF5): results, pressures, gaps and edges");
  verb->add_option("--pressure", options->pressure_figure,
                   "Picture of the pressure of the last contact: .png, .svg or .pdf");
  verb->add_option("--edges", options->edges_figure, "Picture of the edges of all contacts");
  verb->add_option("--master-curve", options->master_curve,
                   "Compute the curve on which all paraboloids on this material lie instead, and "
                   "write it to this file");
  verb->add_option("--table", options->table,
                   "Compute a table over speeds and indentations instead and write it to this file "
                   "(HDF5), which the key contact_law of an oscillator takes");
  verb->add_option("--speeds", options->table_speeds,
                   "Of the table: first and last speed v tau/R, number; default 1e-3 1e3 49")
      ->expected(3);
  verb->add_option("--indentations", options->table_indentations,
                   "Of the table: indentations y/R likewise; default 1e-4 0.3 15")
      ->expected(3);
  verb->add_flag("--verify", options->verify,
                 "Compare the results with the scene's `expect` block; exit 3 where they differ");
  add_scene_options(*verb, options->common);
  add_json_option(*verb, options->common);
  add_force_option(*verb, options->common);
  verb->callback([options, &action] { action = [options] { return contact(*options); }; });
}

}  // namespace stridor
