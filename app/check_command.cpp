// stridor check: all errors of a scene at once.
#include <fmt/format.h>

#include "app/command.hpp"
#include "core/errors.hpp"
#include "io/contact_scene.hpp"
#include "io/linear_scene.hpp"
#include "io/scene.hpp"
#include "io/sphere_scene.hpp"
#include "solvers/simulation.hpp"

namespace stridor {
namespace {

struct CheckOptions {
  CommonOptions common;
  std::string scene;
};

/// Reads the scene, builds its model and checks the step, as `run` would; a scene of a sliding
/// contact is only read.
void check_scene(const CheckOptions& options) {
  SceneNode tree = read_scene_file(options.scene);
  for (const std::string& assignment : options.common.sets) set_value(tree, assignment);
  if (is_contact_scene(tree)) {
    (void)load_contact_scene(options.scene, options.common.sets);
    return;
  }
  if (is_linear_scene(tree)) {
    (void)load_linear_scene(options.scene, options.common.sets).model();
    return;
  }
  if (is_sphere_scene(tree)) {
    (void)load_sphere_scene(options.scene, options.common.sets);
    return;
  }
  const LoadedScene loaded = load_scene(options.scene, options.common.sets);
  const Model model = build_model(loaded);
  try {
    const Simulation simulation(model.system, loaded.scene.time);
  } catch (const ConfigError& error) {
    throw loaded.located(error);
  }
}

Json problem_json(const Problem& problem) {
  return {{"file", problem.source},
          {"line", problem.line},
          {"column", problem.column},
          {"key", problem.key},
          {"message", problem.message}};
}

ExitCode check(const CheckOptions& options) {
  std::vector<Problem> problems;
  try {
    check_scene(options);
  } catch (const ConfigError& error) {
    if (!options.common.json) throw;
    problems = error.problems();
  }
  if (options.common.json) {
    Json errors = Json::array();
    for (const Problem& problem : problems) errors.push_back(problem_json(problem));
    fmt::print("{}\n", Json{{"errors", errors}}.dump(2));
  } else {
    fmt::print("{}: no errors\n", options.scene);
  }
  return problems.empty() ? ExitCode::done : ExitCode::bad_input;
}

}  // namespace

void add_check_command(CLI::App& program, Action& action) {
  auto options = std::make_shared<CheckOptions>();
  CLI::App* verb = program.add_subcommand("check", "All errors of a scene at once");
  verb->add_option("scene", options->scene, "Scene file (YAML)")->required();
  add_scene_options(*verb, options->common);
  add_json_option(*verb, options->common);
  verb->callback([options, &action] { action = [options] { return check(*options); }; });
}

}  // namespace stridor
