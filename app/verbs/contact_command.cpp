// stridor contact: the viscoelastic normal laws of a scene in steady sliding.
#include <fmt/format.h>

#include <algorithm>
#include <cstdio>
#include <memory>
#include <optional>
#include <utility>

#include "app/results/expectations.hpp"
#include "app/runs/contact_laws.hpp"
#include "app/runs/contact_results.hpp"
#include "app/terminal/command.hpp"
#include "core/errors.hpp"
#include "core/suggestion.hpp"
#include "io/figures/gnuplot.hpp"

namespace stridor {
namespace {

/// The points of the scene, overridden by those of the command line.
SlidingPoints settle_points(const ContactOptions& options, const LoadedScene& loaded) {
  SlidingPoints points = loaded.scene.sliding.value_or(SlidingPoints{});
  const auto check = [](const char* option, const std::vector<double>& values, const Range& range) {
    for (const double value : values) {
      if (!range.contains(value))
        throw ConfigError(Refusal::wrong_value, option,
                          fmt::format("{:g} must be {}", value, range.text()));
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
    throw ConfigError(Refusal::missing, "--speed",
                      "is needed, since the scene has no sliding.speeds");
  if (points.indentations.empty() && points.loads.empty()) {
    throw ConfigError(Refusal::missing, "--indentation",
                      "or --load is needed, since the scene has no sliding.indentations");
  }
  return points;
}

Json row_json(const LawRow& row) {
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
          {"remarks", row.remarks}};
}

/// The contacts that are asked for.
std::vector<StudiedContact> asked_contacts(const ContactOptions& options,
                                           const LoadedScene& loaded) {
  std::vector<StudiedContact> contacts = viscoelastic_contacts(loaded);
  std::vector<std::string> names;
  for (const StudiedContact& contact : contacts) names.push_back(contact.name);
  if (options.contact) {
    std::erase_if(contacts,
                  [&](const StudiedContact& contact) { return contact.name != *options.contact; });
    if (contacts.empty()) {
      throw ConfigError(Refusal::unknown_name, "--contact",
                        fmt::format("there is no contact '{}' with the normal law viscoelastic{} "
                                    "(there are: {})",
                                    *options.contact, did_you_mean(*options.contact, names),
                                    fmt::join(names, ", ")));
    }
  }
  const std::pair<const char*, bool> of_one[] = {
      {"--output", options.output.has_value()},
      {"--pressure", options.pressure_figure.has_value()},
      {"--edges", options.edges_figure.has_value()},
      {"--master-curve", options.master_curve.has_value()},
      {"--table", options.table.has_value()}};
  for (const auto& [option, is_given] : of_one) {
    if (!is_given || contacts.size() == 1) continue;
    throw ConfigError(Refusal::missing, "--contact",
                      fmt::format("is needed: {} is of one contact, and the scene has {}: {}",
                                  option, names.size(), fmt::join(names, ", ")));
  }
  return contacts;
}

void print_rows(const std::vector<LawRow>& rows) {
  fmt::print("{:>12} {:>12} {:>14} {:>14} {:>14}\n", "speed", "indentation", "force", "area",
             "friction");
  for (const LawRow& row : rows) {
    fmt::print("{:>12.6g} {:>12.6g} {:>14.7g} {:>14.7g} {:>14.7g}\n", row.speed, row.indentation,
               row.force, row.area, row.result.friction);
    for (const std::string& remark : row.remarks) fmt::print("  {}\n", remark);
  }
}

/// Evaluates the contacts; of one of them, writes what is asked for.
Json evaluate_contacts(const ContactOptions& options, const LoadedScene& loaded,
                       const std::vector<StudiedContact>& contacts, std::ptrdiff_t& num_rows,
                       std::ptrdiff_t& num_failed) {
  const bool draws = options.pressure_figure || options.edges_figure;
  Json results = Json::object();
  const SlidingPoints points = settle_points(options, loaded);
  for (const StudiedContact& contact : contacts) {
    check_reach(loaded, contact, points);
    if (draws) require_boundary_elements(loaded, contact, "--pressure and --edges");
  }
  for (const StudiedContact& contact : contacts) {
    const std::vector<LawRow> rows =
        evaluate_contact(contact, points, options.output.has_value() || draws);
    if (options.output) write_rows(options, loaded, rows);
    if (options.pressure_figure) draw_pressure(options, loaded, contact, rows.back());
    if (options.edges_figure) draw_edges(options, loaded, contact, rows);
    Json list = Json::array();
    for (const LawRow& row : rows) list.push_back(row_json(row));
    if (contacts.size() == 1) {
      results["rows"] = std::move(list);
    } else {
      results["contacts"][contact.name]["rows"] = std::move(list);
      if (!options.common.json) fmt::print("{}\n", contact.name);
    }
    if (!options.common.json) print_rows(rows);
    num_rows += static_cast<std::ptrdiff_t>(rows.size());
    num_failed += std::count_if(rows.begin(), rows.end(),
                                [](const LawRow& row) { return !row.result.converged; });
  }
  return results;
}

ExitCode contact(const ContactOptions& options) {
  if (options.output) check_output(*options.output, options.common.overwrite());
  for (const auto& figure : {options.pressure_figure, options.edges_figure}) {
    if (figure) check_figure(*figure, options.common);
  }
  const LoadedScene loaded = load_scene(options.scene, options.common.sets);
  const std::vector<StudiedContact> contacts = asked_contacts(options, loaded);
  if (options.master_curve) return make_master_curve(options, loaded, contacts.front());
  if (options.table) return make_table(options, loaded, contacts.front());
  std::ptrdiff_t num_rows = 0;
  std::ptrdiff_t num_failed = 0;
  const Json results = evaluate_contacts(options, loaded, contacts, num_rows, num_failed);
  if (options.common.json) {
    print_json(results);
  } else {
    for (const auto& file : {options.output, options.pressure_figure, options.edges_figure})
      if (file) fmt::print("{}\n", *file);
  }
  std::fflush(stdout);
  if (num_failed > 0)
    throw NumericalError(Refusal::no_convergence,
                         fmt::format("{} of {} contacts did not converge", num_failed, num_rows));
  if (options.verify) check_expectations(loaded.scene.expect, results);
  return ExitCode::done;
}

}  // namespace

void add_contact_command(CLI::App& program, Action& action, const std::string& command_line) {
  auto options = std::make_shared<ContactOptions>();
  options->command_line = command_line;
  CLI::App* verb = program.add_subcommand(
      "contact", "Viscoelastic normal laws of a scene: force, area, friction in steady sliding");
  verb->add_option("scene", options->scene, "Scene file (YAML)")->required();
  verb->add_option("--contact", options->contact,
                   "Which of several contacts; default: all with such a law");
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
                   "write it to this file: .h5 (HDF5, which report shows), or .inc, .txt or .hpp "
                   "(rows of C++, as stridor itself is compiled with)");
  verb->add_option("--table", options->table,
                   "Compute a table over speeds and indentations instead and write it to this file "
                   "(HDF5), which the key normal.form of a contact takes");
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
