#include "app/runs/contact_laws.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "app/results/file_attributes.hpp"
#include "app/runs/contact_results.hpp"
#include "app/terminal/progress.hpp"
#include "core/errors.hpp"
#include "core/stop_token.hpp"
#include "io/hdf5/part_file.hpp"
#include "io/imports/law_table_file.hpp"
#include "io/results/column_file.hpp"
#include "solvers/contact/contact_table.hpp"
#include "solvers/half_space/master_curve.hpp"

namespace stridor {
namespace {

/// Refuses a name whose ending promises what is not written.
void check_curve_name(const std::string& path) {
  for (const char* ending : {".h5", ".inc", ".txt", ".hpp"})
    if (path.ends_with(ending)) return;
  throw ConfigError(
      Refusal::wrong_value, "--master-curve",
      fmt::format("'{}' ends neither in .h5 (HDF5) nor in .inc, .txt or .hpp (rows of "
                  "C++)",
                  path));
}

/// The rows with which the program itself is compiled.
std::string curve_text(const MasterCurve& curve, const SlidingContactParameters& solver) {
  std::string text = fmt::format(
      "// beta, f, g, m, v tau in cells: a paraboloid with E_0/E_inf = {:g} on {} cells a side, "
      "tolerance\n// {:g}. Made by `stridor contact --master-curve`; do not edit.\n",
      curve.modulus_ratio, solver.grid, solver.tolerance);
  for (const MasterPoint& point : curve.points)
    text += fmt::format("{{{}, {:.8g}, {:.6g}, {:.7g}, {:.6g}}},\n", point.beta, point.force,
                        point.area, point.friction, point.memory_in_cells);
  return text;
}

void write_curve_file(const ContactOptions& options, const LoadedScene& loaded,
                      const MasterCurve& curve, const SlidingContactParameters& solver) {
  std::vector<Column> columns;
  const auto add = [&](const char* path, double MasterPoint::*member) {
    Column column{path, "1", {}};
    for (const MasterPoint& point : curve.points) column.values.push_back(point.*member);
    columns.push_back(std::move(column));
  };
  add("/beta", &MasterPoint::beta);
  columns.back().is_scale = true;
  add("/f", &MasterPoint::force);
  add("/g", &MasterPoint::area);
  add("/m", &MasterPoint::friction);
  add("/memory_in_cells", &MasterPoint::memory_in_cells);
  Attributes attributes = source_attributes(loaded, options.command_line);
  attributes.emplace_back("modulus_ratio", curve.modulus_ratio);
  attributes.emplace_back("grid", static_cast<double>(solver.grid));
  attributes.emplace_back("tolerance", solver.tolerance);
  write_column_file(*options.master_curve, options.common.overwrite(), "master curve", columns,
                    attributes);
}

}  // namespace

ExitCode make_master_curve(const ContactOptions& options, const LoadedScene& loaded,
                           const StudiedContact& contact) {
  require_boundary_elements(loaded, contact, "--master-curve");
  const ViscoelasticMaterial& material = *contact.normal.material;
  const SlidingContactParameters solver =
      contact.normal.solver.value_or(SlidingContactParameters{});
  const auto refuse = [&](const char* key, const char* message) {
    throw loaded.located(ConfigError(Refusal::wrong_value, contact.key + key, message));
  };
  if (contact.normal.indenter().shape != ProfileShape::paraboloid)
    refuse(".profile.shape", "must be paraboloid: only these lie on one curve");
  if (material.creep_times.size() != 1)
    refuse(".material.creep_times", "must be one: only then do contacts lie on one curve");
  const std::string& path = *options.master_curve;
  check_curve_name(path);
  check_output(path, options.common.overwrite());
  const std::vector<double> betas = master_curve_betas();
  Progress progress("master curve");
  const ComputedMasterCurve computed =
      compute_master_curve(material.modulus_ratio(), betas, solver, [&](std::size_t done) {
        if (stop_requested()) throw Interrupted("nothing has been written");
        progress.report(static_cast<double>(done) / static_cast<double>(betas.size()),
                        fmt::format("point {} of {}", done, betas.size()));
      });
  progress.finish();
  Json points = Json::array();
  for (std::size_t k = 0; k < computed.results.size(); ++k) {
    const MasterPoint& point = computed.curve.points[k];
    points.push_back({{"beta", point.beta},
                      {"force", number(point.force)},
                      {"area", number(point.area)},
                      {"friction", number(point.friction)},
                      {"converged", computed.results[k].converged},
                      {"remarks", computed.results[k].remarks()}});
  }
  if (!computed.converged())
    throw NumericalError(Refusal::no_convergence,
                         "a point of the master curve did not converge; nothing has been written");
  if (path.ends_with(".h5")) {
    write_curve_file(options, loaded, computed.curve, solver);
  } else {
    write_text_file(path, curve_text(computed.curve, solver));
  }
  if (options.common.json) {
    print_json(Json{{"modulus_ratio", computed.curve.modulus_ratio}, {"points", points}});
  } else {
    fmt::print("{} points\n{}\n", computed.results.size(), path);
  }
  return ExitCode::done;
}

namespace {

/// How many contacts of a table are so.
template <class Condition>
std::ptrdiff_t count_contacts(const ComputedContactTable& computed, Condition&& is_so) {
  return std::count_if(computed.results.begin(), computed.results.end(), is_so);
}

/// @throws NumericalError if a contact did not converge or has no friction; Interrupted
ComputedContactTable compute_table(const NormalParameters& normal, const SlidingPoints& points) {
  const auto num_contacts = static_cast<double>(points.speeds.size() * points.indentations.size());
  Progress progress("contact table");
  ComputedContactTable computed = compute_contact_table(
      IndenterProfile(normal.indenter()), creep_lengths(*normal.material, normal.tip_radius(), 1.0),
      points.speeds, points.indentations, normal.solver.value_or(SlidingContactParameters{}),
      [&](std::size_t done) {
        if (stop_requested()) throw Interrupted("nothing has been written");
        progress.report(static_cast<double>(done) / num_contacts,
                        fmt::format("contact {} of {:g}", done, num_contacts));
      });
  progress.finish();
  if (!computed.converged()) {
    throw NumericalError(
        Refusal::no_convergence,
        fmt::format(
            "{} of {:g} contacts of the table did not converge; nothing has been written",
            count_contacts(computed,
                           [](const SlidingContactResult& result) { return !result.converged; }),
            num_contacts));
  }
  const auto is_positive = [](double value) { return value > 0.0; };
  if (!std::all_of(computed.table.friction.begin(), computed.table.friction.end(), is_positive)) {
    throw NumericalError(
        Refusal::no_convergence,
        "the friction of a contact of the table is not > 0, since its speed is too low for the "
        "grid: begin at a higher one, or lower solver.tolerance; nothing has been written");
  }
  return computed;
}

void print_table(const SlidingPoints& points, std::ptrdiff_t num_unresolved,
                 std::ptrdiff_t num_touching, const std::string& path) {
  fmt::print("{} speeds, {} indentations\n", points.speeds.size(), points.indentations.size());
  if (num_unresolved > 0) {
    fmt::print(
        "{} contacts: the layer of length v tau at the edge is less than two cells wide "
        "and not resolved: the friction is too low\n",
        num_unresolved);
  }
  if (num_touching > 0)
    fmt::print("{} contacts reach the border of the window: enlarge it\n", num_touching);
  fmt::print("{}\n", path);
}

}  // namespace

ExitCode make_table(const ContactOptions& options, const LoadedScene& loaded,
                    const StudiedContact& contact) {
  require_boundary_elements(loaded, contact, "--table");
  const std::string& path = *options.table;
  const Overwrite overwrite = options.common.overwrite();
  check_output(path, overwrite);
  SlidingPoints points;
  points.speeds = spaced_values("--speeds", options.table_speeds);
  points.indentations = spaced_values("--indentations", options.table_indentations);
  check_reach(loaded, contact, points);
  const ComputedContactTable computed = compute_table(contact.normal, points);
  std::vector<double> memory_in_cells;
  for (const SlidingContactResult& result : computed.results)
    memory_in_cells.push_back(result.memory_in_cells);
  write_law_table(path, overwrite, computed.table, memory_in_cells,
                  source_attributes(loaded, options.command_line));
  const auto num_unresolved = count_contacts(computed, [](const SlidingContactResult& result) {
    return !result.has_resolved_memory();
  });
  const auto num_touching = count_contacts(
      computed, [](const SlidingContactResult& result) { return result.touches_window; });
  if (options.common.json) {
    print_json(Json{{"speeds", points.speeds},
                    {"indentations", points.indentations},
                    {"force", computed.table.force},
                    {"area", computed.table.area},
                    {"friction", computed.table.friction},
                    {"num_unresolved", num_unresolved},
                    {"num_touching_window", num_touching}});
  } else {
    print_table(points, num_unresolved, num_touching, path);
  }
  return ExitCode::done;
}

}  // namespace stridor
