// stridor import: what files of meshes, matrices and modal tests hold.
#include <fmt/format.h>

#include <filesystem>

#include "app/results/import_report.hpp"
#include "app/results/universal_report.hpp"
#include "app/terminal/command.hpp"
#include "core/units.hpp"
#include "io/figures/mesh_picture.hpp"
#include "io/figures/mesh_plot.hpp"
#include "io/figures/modal_test_plot.hpp"
#include "io/imports/mesh_file.hpp"
#include "io/imports/named_files.hpp"
#include "io/imports/uff_contents.hpp"
#include "substructures/bodies/matrix_body.hpp"

namespace stridor {
namespace {

struct ImportOptions {
  CommonOptions common;
  std::vector<std::string> files;
  MatrixNodesParameters nodes;
  int num_frequencies = 10;
  double thickness = 1.0;
  std::string figure;
};

double length_of(const std::string& unit) {
  try {
    return parse_quantity("1 " + unit, "m");
  } catch (const std::invalid_argument& error) {
    throw ConfigError(Refusal::wrong_unit, "--length-unit", error.what());
  }
}

/// The matrices among some files.
NamedMatrices read_matrices_of(const ImportedFiles& files, MatrixBodyParameters& body,
                               MatrixNodesParameters& nodes) {
  for (const auto& [name, text, from] :
       {std::tuple("mass", &body.mass, &files.mass), std::tuple("damping", &body.damping, &files.damping),
        std::tuple("stiffness", &body.stiffness, &files.stiffness)}) {
    if (!from->empty()) *text = {*from};
    if (from->empty() && text != &body.damping)
      throw ConfigError(Refusal::unknown_name, "files",
                        fmt::format("there is no {0}; give {0}=FILE too", name));
  }
  if (!files.unknowns.empty()) nodes.unknowns = files.unknowns;
  nodes.nodes = files.nodes;
  nodes.mesh = files.mesh;
  const NamedFiles paths([](const std::string&, const std::string& name) { return name; });
  return read_matrices(body, nodes, paths);
}

/// The same files as a scene would name them.
std::string scene_lines(const ImportedFiles& files, const MatrixNodesParameters& nodes) {
  std::string text = "substructures:\n  part:\n";
  const auto line = [&](const char* key, const std::string& value) {
    if (!value.empty()) text += fmt::format("    {}: {}\n", key, value);
  };
  if (!files.has_matrices()) {
    text += "    type: mesh\n";
    line("file", files.mesh);
    line("length_unit", nodes.length_unit == "m" ? "" : nodes.length_unit);
    return text + "    material: {youngs_modulus: ..., poissons_ratio: ..., density: ...}\n";
  }
  text += "    type: matrices\n";
  line("mass", files.mass);
  line("damping", files.damping);
  line("stiffness", files.stiffness);
  line("unknowns", nodes.unknowns);
  line("mesh", files.mesh);
  line("nodes", files.nodes);
  line("length_unit", nodes.length_unit == "m" ? "" : nodes.length_unit);
  line("force_unit", nodes.force_unit == "N" ? "" : nodes.force_unit);
  line("time_unit", nodes.time_unit == "s" ? "" : nodes.time_unit);
  return text;
}

Json summary_json(const MeshSummary& summary) {
  return {{"format", summary.format},
          {"dropped_nodes", summary.dropped_nodes},
          {"skipped", summary.skipped}};
}

void print_mesh(const MeshSummary& summary) {
  std::string skipped;
  for (const std::string& word : summary.skipped)
    skipped += (skipped.empty() ? "" : ", ") + word;
  fmt::print("{:<26} {}\n", "format", summary.format);
  if (summary.dropped_nodes > 0)
    fmt::print("{:<26} {}\n", "nodes of no element", summary.dropped_nodes);
  if (!skipped.empty()) fmt::print("{:<26} {}\n", "passed over", skipped);
}

/// A file of a test stands alone: it belongs to no mesh or matrices.
ExitCode import_universal(const ImportOptions& options, const std::string& file) {
  if (options.files.size() > 1) {
    throw ConfigError(Refusal::wrong_value, "files",
                      fmt::format("'{}' is a universal file, which is given alone", file));
  }
  const UffHoldings held = read_uff_holdings_file(file);
  if (!options.figure.empty()) {
    const ModalTest& test = held.shapes;
    if (test.nodes.empty())
      throw ConfigError(Refusal::missing, "--output",
                        fmt::format("'{}' has no nodes to draw (datasets 15, 2411)", file));
    draw_mesh_picture(
        modal_test_picture(
            test, fmt::format("{}: {} nodes, {} lines, {} elements.",
                              std::filesystem::path(file).filename().string(), test.nodes.size(),
                              test.lines.size(), test.elements.size())),
        options.figure);
  }
  if (options.common.json) {
    print_json({{"universal", universal_json(held)}});
  } else {
    print_universal(held, file);
  }
  return ExitCode::done;
}

ExitCode import_files(const ImportOptions& options) {
  if (!options.figure.empty()) check_figure(options.figure, options.common);
  const ImportedFiles files = sort_out_files(options.files);
  if (!files.universal.empty()) return import_universal(options, files.universal);
  MatrixNodesParameters nodes = options.nodes;
  ImportFacts facts;
  Mesh mesh;
  std::optional<MeshSummary> summary;
  const double length = length_of(nodes.length_unit);
  if (files.has_matrices()) {
    MatrixBodyParameters body;
    const NamedMatrices matrices = read_matrices_of(files, body, nodes);
    facts.matrices = matrix_facts(matrices, body, nodes, options.num_frequencies);
    mesh = matrices.mesh;
  } else {
    if (files.mesh.empty())
      throw ConfigError(Refusal::wrong_value, "files",
                        "hold neither a mesh nor matrices; give one of them");
    ImportedMesh read = read_mesh_file(files.mesh);
    mesh = std::move(read.mesh);
    summary = std::move(read.summary);
  }
  mesh.nodes *= length;
  if (mesh.num_elements() > 0) {
    try {
      facts.mesh = mesh_facts(mesh, options.thickness);
    } catch (const std::invalid_argument& error) {
      throw ConfigError(Refusal::wrong_value, "files",
                        fmt::format("{}: {}", files.mesh, error.what()));
    }
  }
  if (!options.figure.empty()) {
    if (!facts.mesh)
      throw ConfigError(Refusal::wrong_value, "--output",
                        "there is no mesh to draw; give mesh=FILE too");
    plot_mesh(mesh, files.mesh, options.figure);
  }
  Json object = import_json(facts);
  if (summary) object["mesh"].update(summary_json(*summary));
  if (options.common.json) {
    print_json(object);
    return ExitCode::done;
  }
  if (summary) print_mesh(*summary);
  print_import(facts, "");
  fmt::print("\nIn a scene:\n\n{}", scene_lines(files, nodes));
  return ExitCode::done;
}

}  // namespace

void add_import_command(CLI::App& program, Action& action) {
  auto options = std::make_shared<ImportOptions>();
  CLI::App* verb = program.add_subcommand(
      "import",
      "What files of meshes, matrices and modal tests hold, before they are used in a scene");
  verb->add_option(
          "files", options->files,
          "A mesh (.msh, .inp), a universal file (.uff, .unv), or the matrices of a body with "
          "what belongs to them; KEY=FILE where the name does not tell: mass, damping, "
          "stiffness, unknowns, mesh, nodes, universal")
      ->required();
  verb->add_option("--unknowns", options->nodes.unknowns,
                   "all_of_mesh: the rows are all displacements of all nodes of the mesh");
  verb->add_option("--length-unit", options->nodes.length_unit, "Unit of length (default m)");
  verb->add_option("--force-unit", options->nodes.force_unit, "Unit of force (default N)");
  verb->add_option("--time-unit", options->nodes.time_unit, "Unit of time (default s)");
  verb->add_option("--thickness", options->thickness, "Of a planar mesh, m (default 1)")
      ->check(CLI::PositiveNumber);
  verb->add_option("--frequencies", options->num_frequencies,
                   "How many of the lowest frequencies of matrices to find (default 10)")
      ->check(CLI::Range(0, 1000));
  verb->add_option("-o,--output", options->figure,
                   "Also draw the mesh with its surfaces in colours, or the nodes, lines and "
                   "elements of a universal file: "
                   "FIG.png, .svg or .pdf");
  add_json_option(*verb, options->common);
  add_force_option(*verb, options->common);
  verb->callback([options, &action] { action = [options] { return import_files(*options); }; });
}

}  // namespace stridor
