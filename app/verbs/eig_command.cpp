// stridor eig: sliding equilibrium of a scene and its eigenvalues.
#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <string>
#include <vector>

#include "app/results/file_attributes.hpp"
#include "app/stability/analysed_spectrum.hpp"
#include "app/stability/eigenvalue_file.hpp"
#include "app/stability/eigenvalue_report.hpp"
#include "app/stability/equilibrium_report.hpp"
#include "app/stability/mode_pictures.hpp"
#include "app/stability/shape_files.hpp"
#include "app/stability/verdict.hpp"
#include "core/errors.hpp"
#include "io/figures/assurance_plot.hpp"
#include "io/hdf5/part_file.hpp"

namespace stridor {
namespace {

struct EigOptions {
  StabilityOptions stability;
  std::optional<std::string> at;
  bool explain = false;
  std::optional<int> mode;
  std::optional<std::string> shapes;
  std::optional<std::string> universal;  ///< file to write
  std::optional<std::string> compared;   ///< universal file of measured shapes
  std::vector<std::string> nodes;        ///< of it, "NUMBER=BODY.POINT"
  std::optional<std::string> figure;     ///< of the assurance criteria
  std::optional<std::string> output;
  std::string command_line;
};

/// A key of the scene and its value at the position asked for.
struct AskedPosition {
  NumericKey key;
  double value = 0.0;
};
std::optional<AskedPosition> asked_position(const LoadedScene& loaded, const EigOptions& options) {
  if (!options.at) return std::nullopt;
  loaded.require_section("contact", "eig --at");
  const auto path = start_key(loaded.scene.model);
  if (!path) {
    throw ConfigError(Refusal::wrong_value, "--at",
                      "the scene has several contact pairs; set the `start` of one of them "
                      "with --set");
  }
  const NumericKey key = find_stability_key(loaded.scene, *path, "--at");
  return AskedPosition{key, parse_value(key, *options.at, "--at")};
}

void print_explanation(const Json& explanation) {
  // No "-0": nothing is neither fed nor taken.
  const auto value = [](const Json& object, const char* key) {
    return object[key].get<double>() + 0.0;
  };
  const Json& energy = explanation["energy"];
  fmt::print("\nmode {} at {:.2f} Hz, growth {:.4f} 1/s\n", explanation["mode"].get<int>(),
             value(explanation, "frequency"), value(explanation, "growth"));
  print_quotients(explanation["quotients"]);
  fmt::print("  growth: {:+.4f} 1/s from the contact, {:+.4f} 1/s by damping\n",
             value(energy, "growth_from_contact"), value(energy, "growth_by_damping"));
  if (const double coupled = value(energy, "growth_by_coupled_terms"); coupled != 0.0)
    fmt::print("          {:+.4f} 1/s by coupled terms of bodies\n", coupled);
  fmt::print(
      "  of its energy {:+.4f} % enters at the contact in each cycle, {:+.4f} % by damping\n",
      100.0 * value(energy, "contact_per_cycle"), 100.0 * value(energy, "damping_per_cycle"));
  for (const Json& mode : explanation["frictionless_modes"]) {
    fmt::print("  {:.1f} % of it is the mode of {:.2f} Hz without friction\n",
               100.0 * value(mode, "share"), value(mode, "frequency"));
  }
}

/// The eigenvalue to explain or draw: of those over which the verdict is, where none is named.
std::size_t mode_of_interest(const Analysis& analysis, const std::optional<int>& mode) {
  const FoundSpectrum& found = analysis.found;
  std::vector<Eigenvalue> choice = found.eigenvalues;
  const auto is_above = [&](const auto& one) { return one.frequency() > found.highest; };
  if (!mode && !std::all_of(choice.begin(), choice.end(), is_above))
    std::erase_if(choice, is_above);
  return chosen_mode(choice, num_real_of(choice), mode);
}

/// |s|/2π, Hz, as tests state frequencies.
double undamped_frequency(const ShapedMode& mode) {
  return std::abs(mode.eigenvalue.s) / (2.0 * std::numbers::pi);
}

Json unclear_json(const ShapeComparison& comparison) {
  Json nodes = Json::array();
  for (const UnclearNode& one : comparison.unclear)
    nodes.push_back({{"node", one.label}, {"bodies", one.bodies}});
  return nodes;
}

/// All modes as a universal file, and beside measured ones.
void add_shape_files(const EigOptions& options, const LoadedScene& loaded, const Analysis& analysis,
                     Json& object) {
  if (!options.universal && !options.compared) return;
  const ShapedModes shapes = shaped_modes(analysis, options.universal ? "--uff" : "--compare");
  if (options.universal) {
    const UffContents contents = uff_contents(shapes, options.stability.scene);
    write_text_file(*options.universal,
                    [&](const TextSink& sink) { write_uff(contents, "--uff", sink); });
    object["uff"] = *options.universal;
  }
  if (!options.compared) return;
  const NodesByLabel named = nodes_at_points(shapes, loaded, parse_node_names(options.nodes));
  const ShapeComparison comparison =
      compared_shapes(shapes, read_uff_file(*options.compared), named, *options.compared);
  Json rows = Json::array();
  for (std::size_t m = 0; m < comparison.measured.size(); ++m) {
    const auto column = comparison.assurance.col(static_cast<Eigen::Index>(m));
    Eigen::Index best = 0;
    column.maxCoeff(&best);
    const ShapedMode& computed = shapes.modes[static_cast<std::size_t>(best)];
    rows.push_back({{"measured", comparison.measured[m].number},
                    {"measured_frequency", comparison.measured[m].frequency},
                    {"mode", best + 1},
                    {"frequency", undamped_frequency(computed)},
                    {"mac", column[best]},
                    {"macs", std::vector<double>(column.begin(), column.end())}});
  }
  object["comparison"] = {{"file", *options.compared},
                          {"nodes", comparison.num_nodes},
                          {"farthest", comparison.farthest},
                          {"unclear", unclear_json(comparison)},
                          {"modes", rows}};
  if (!options.figure) return;
  AssurancePicture picture{comparison.assurance, {}, {}};
  for (const ShapedMode& mode : shapes.modes) picture.computed.push_back(undamped_frequency(mode));
  for (const TestMode& mode : comparison.measured) picture.measured.push_back(mode.frequency);
  plot_assurance(picture,
                 fmt::format("{} beside {}: modal assurance criterion at {} nodes.",
                             options.stability.scene, *options.compared, comparison.num_nodes),
                 *options.figure);
  object["figure"] = *options.figure;
}

void print_comparison(const Json& comparison) {
  fmt::print("\n{} measured nodes, at most {:.3g} m from a node of the scene\n",
             comparison["nodes"].get<std::size_t>(), comparison["farthest"].get<double>());
  for (const Json& one : comparison["unclear"]) {
    const auto bodies = one["bodies"].get<std::vector<std::string>>();
    fmt::print(
        "node {} stands where {} nodes coincide ({}); that of {} was taken, --node {}=BODY.POINT "
        "names "
        "another\n",
        one["node"].get<std::int64_t>(), bodies.size(), fmt::join(bodies, ", "), bodies.front(),
        one["node"].get<std::int64_t>());
  }
  fmt::print("{:>8} {:>14} {:>6} {:>14} {:>10} {:>7}   (undamped frequencies)\n", "measured", "Hz",
             "mode", "Hz", "difference", "MAC");
  for (const Json& row : comparison["modes"]) {
    const auto measured = row["measured_frequency"].get<double>();
    const auto computed = row["frequency"].get<double>();
    fmt::print("{:>8} {:>14.3f} {:>6} {:>14.3f} {:>8.2f} % {:>7.4f}\n", row["measured"].get<std::int64_t>(),
               measured, row["mode"].get<int>(), computed,
               measured > 0.0 ? 100.0 * (computed / measured - 1.0) : 0.0, row["mac"].get<double>());
  }
}

void write_output(const EigOptions& options, const LoadedScene& loaded, const Analysis& analysis,
                  const std::optional<AskedPosition>& position, const Json& object) {
  Attributes attributes = source_attributes(loaded, options.command_line);
  attributes.emplace_back("about", options.stability.about);
  attributes.emplace_back("method", analysis.found.method);
  attributes.emplace_back("stable", object["stable"].get<bool>() ? 1.0 : 0.0);
  if (position) {
    attributes.emplace_back("parameter", position->key.path);
    attributes.emplace_back("value", position->value);
    attributes.emplace_back("units", printed_units(position->key));
  }
  write_eigenvalue_file(*options.output, options.stability.common.overwrite(), analysis,
                        object.value("explanation", Json()), std::move(attributes));
}

void print_report(const EigOptions& options, const Analysis& analysis, const Json& object) {
  const FoundSpectrum& found = analysis.found;
  if (!analysis.is_sparse())
    print_equilibrium(analysis.member.model->system, analysis.state.equilibrium);
  print_law_ranges(object["equilibrium"]);
  if (object.contains("remark")) fmt::print("{}\n", object["remark"].get<std::string>());
  print_eigenvalues(found.eigenvalues, analysis.trusted);
  const char* verdict = object["stable"].get<bool>() ? "stable" : "unstable";
  const std::string about = analysis.has_contacts()
                                ? fmt::format(", about the {} geometry", options.stability.about)
                                : "";
  const std::string reach = std::isfinite(found.highest)
                                ? fmt::format("between 0 and {:.6g} Hz{}", found.highest,
                                              limit_text(found.highest, analysis.trusted))
                                : "at all frequencies";
  fmt::print("{} {}{}\n", verdict, reach, about);
  if (found.more.contains("counted")) {
    fmt::print("{} eigenvalues with their conjugates, as the argument principle counts\n",
               found.more["counted"].get<int>());
  }
  if (options.explain) {
    const Json& explanation = object["explanation"];
    analysis.has_contacts() ? print_explanation(explanation) : print_whole_explanation(explanation);
  }
  if (options.shapes) {
    fmt::print("{} and {} files for ParaView\n", object["files"][0].get<std::string>(),
               object["files"].size() - 1);
  }
  if (options.compared) print_comparison(object["comparison"]);
  if (options.figure) fmt::print("{}\n", *options.figure);
  for (const auto& file : {options.universal, options.output})
    if (file) fmt::print("{}\n", *file);
}

ExitCode report(const EigOptions& options, const LoadedScene& loaded, const Analysis& analysis,
                const std::optional<AskedPosition>& position) {
  const FoundSpectrum& found = analysis.found;
  const std::vector<Eigenvalue>& eigenvalues = found.eigenvalues;
  const bool is_stable = std::none_of(
      eigenvalues.begin(), eigenvalues.end(),
      [&](const Eigenvalue& one) { return one.frequency() <= found.highest && is_growing(one); });
  Json object = {
      {"about", options.stability.about},
      {"method", found.method},
      {"equilibrium", analysis.is_sparse()
                          ? Json::object()
                          : equilibrium_json(*analysis.member.model, analysis.state.equilibrium)},
      {"eigenvalues", eigenvalues_json(eigenvalues)},
      {"residuals", Json::array()},
      {"doubtful", doubtful_json(eigenvalues)},
      {"stable", is_stable},
      {"window", {0.0, number(found.highest)}}};
  object.update(found.more);
  for (const Eigenvalue& one : eigenvalues) object["residuals"].push_back(number(one.residual));
  if (options.explain || options.shapes) {
    const std::size_t chosen = mode_of_interest(analysis, options.mode);
    const std::size_t number_of_mode = chosen - num_real_of(eigenvalues) + 1;
    const Eigenvalue& one = eigenvalues[chosen];
    if (options.explain) {
      object["explanation"] = {
          {"mode", number_of_mode}, {"frequency", one.frequency()}, {"growth", one.growth()}};
      object["explanation"].update(found.explain(chosen));
    }
    if (options.shapes) {
      if (!found.shape) {
        throw ConfigError(Refusal::cannot_reduce, "--shapes",
                          "needs bodies that are reduced (reduction), or fewer "
                          "unknowns than these");
      }
      object["files"] =
          write_mode_pictures(*options.shapes, options.stability, loaded, analysis.member,
                              analysis.state, one, found.shape(chosen), number_of_mode);
    }
  }
  add_shape_files(options, loaded, analysis, object);
  if (options.output) {
    write_output(options, loaded, analysis, position, object);
    object["file"] = *options.output;
  }
  if (options.stability.common.json) {
    print_json(object);
  } else {
    print_report(options, analysis, object);
  }
  return ExitCode::done;
}

ExitCode eig(EigOptions options) {
  if (options.mode && !options.explain && !options.shapes)
    throw ConfigError(Refusal::missing, "--mode",
                      "names the mode to explain or draw; add --explain or --shapes");
  for (const auto& file : {options.universal, options.output})
    if (file) check_output(*file, options.stability.common.overwrite());
  if (!options.compared && (options.figure || !options.nodes.empty())) {
    throw ConfigError(Refusal::contradiction, options.figure ? "--figure" : "--node",
                      "is of the comparison with measured shapes; give it with --compare");
  }
  if (options.figure) check_figure(*options.figure, options.stability.common);
  const LoadedScene loaded = load_scene(options.stability.scene, options.stability.common.sets);
  make_choices(options.stability, loaded.scene);
  const std::optional<AskedPosition> position = asked_position(loaded, options);
  SceneFamily family(loaded, position ? std::vector{position->key} : std::vector<NumericKey>{});
  const std::vector<double> values =
      position ? std::vector{position->value} : std::vector<double>{};
  return report(options, loaded, analyse(options.stability, loaded, family.at(values)), position);
}

}  // namespace

void add_eig_command(CLI::App& program, Action& action, const std::string& command_line) {
  auto options = std::make_shared<EigOptions>();
  options->command_line = command_line;
  CLI::App* verb =
      program.add_subcommand("eig", "Sliding equilibrium and its eigenvalues at one position");
  add_stability_options(*verb, options->stability);
  verb->add_option("--at", options->at,
                   "Position of the contact along the master, about the deformed geometry on the "
                   "deformed one, m "
                   "or with a unit; default: contact.start");
  verb->add_option("-o,--output", options->output,
                   "File to write (HDF5): eigenvalues, equilibrium and explanation");
  verb->add_flag("--explain", options->explain,
                 "Say why a mode grows: what it sees of damping, stiffness and friction, where its "
                 "energy comes from, which modes without friction it is made of");
  verb->add_option("--mode", options->mode,
                   "Number of the mode to explain or draw; default: the one that grows fastest")
      ->check(CLI::Range(1, 100000));
  verb->add_option("--shapes", options->shapes,
                   "Folder for a picture of the mode and its motion for ParaView (VTK); bodies "
                   "without a mesh show their nodes");
  verb->add_option("--uff", options->universal,
                   "Universal file to write: all modes at all nodes (datasets 2411, 2412, 82, 55)");
  verb->add_option("--compare", options->compared,
                   "Universal file of measured shapes (15 or 2411, 55) to set beside: frequencies and MAC");
  verb->add_option("--node", options->nodes,
                   "Which point a measured node is, NUMBER=BODY.POINT, where places do not tell; may be "
                   "repeated")
      ->take_all()
      ->allow_extra_args(false);
  verb->add_option("--figure", options->figure,
                   "Picture of the criteria of all computed and measured modes: .png, .svg or .pdf");
  add_force_option(*verb, options->stability.common);
  verb->callback([options, &action] { action = [options] { return eig(*options); }; });
}

}  // namespace stridor
