// stridor check: all errors of a scene at once.
#include <fmt/format.h>

#include <algorithm>
#include <map>
#include <optional>
#include <utility>

#include "analysis/step_guard.hpp"
#include "app/results/body_report.hpp"
#include "app/results/import_report.hpp"
#include "app/results/step_stability_report.hpp"
#include "app/runs/contact_study.hpp"
#include "app/runs/cycle_motion.hpp"
#include "app/terminal/command.hpp"
#include "core/activity.hpp"
#include "core/errors.hpp"
#include "io/run_file/initial_state.hpp"
#include "io/scene/scene.hpp"
#include "io/scene/scene_warnings.hpp"
#include "models/body_cache.hpp"
#include "solvers/transient/simulation.hpp"

namespace stridor {
namespace {

struct CheckOptions {
  CommonOptions common;
  std::string scene;
  bool stability = false;
  int places = 101;
};

/// Report on a scene without errors.
struct Report {
  std::vector<Problem> warnings;
  std::optional<StepStabilityReport> stability{};
  Json bodies = Json::object();  ///< given by matrices, see matrix_bodies_json()
  std::map<std::string, ImportFacts> imports{};  ///< by body
};

/// Contents of the files of bodies.
std::map<std::string, ImportFacts> imports_of(const Model& model) {
  std::map<std::string, ImportFacts> imports;
  for (const auto& [name, body] : model.substructures) {
    if (auto facts = body->import_facts()) imports.emplace(name, std::move(*facts));
  }
  return imports;
}

/// Of what has no steps. @throws ConfigError
void refuse_stability(const CheckOptions& options, const char* reason) {
  if (options.stability) throw ConfigError(Refusal::wrong_value, "--stability", reason);
}

/// Whether only `contact` can do something with a scene.
bool is_for_contact(const Scene& scene) {
  const auto pairs = scene.model.pairs();
  return scene.model.substructures.empty() ||
         (!scene.time && std::any_of(pairs.begin(), pairs.end(), [](const auto& pair) {
           return pair.second.slave.empty() || pair.second.normal.is_solved();
         }));
}

/// Reads the scene and does what `run` does before its first step; a scene that is only for
/// `contact` is only read.
Report check_scene(const CheckOptions& options) {
  const LoadedScene loaded = load_scene(options.scene, options.common.sets);
  if (is_for_contact(loaded.scene)) {
    refuse_stability(options,
                     "is that of the steps of a run, and without bodies to march there are only "
                     "normal laws, which the verb `contact` evaluates");
    (void)viscoelastic_contacts(loaded);
    return {key_warnings(Scene::schema(), &loaded.scene, loaded.tree)};
  }
  if (options.stability) loaded.require_section("time", "check --stability");
  BodyCache cache;
  Model model = build_model(loaded, cache);
  if (!loaded.scene.time) {
    return {scene_warnings(loaded, model), {}, matrix_bodies_json(model), imports_of(model)};
  }
  try {
    require_modes(model);
    const Activity preparing("preparing the first step");
    (void)set_initial_state(model.system, loaded);
    if (loaded.scene.time->is_event_driven()) {
      (void)sliding_equilibrium(oscillator_of(loaded, model.system, "time.integrator"));
      refuse_stability(options,
                       "is that of time.step, and event_driven has no steps of a given length; the "
                       "vibrations are followed by eig and locus");
    } else {
      const Simulation simulation(model.system, *loaded.scene.time, accounts_of(loaded.scene));
      // The report on stability shows what a run would be refused for.
      if (!options.stability) require_no_own_growth(model.system, *loaded.scene.time);
    }
  } catch (const ConfigError& error) {
    throw loaded.located(error);
  }
  Report report{scene_warnings(loaded, model), {}, matrix_bodies_json(model), imports_of(model)};
  if (options.stability)
    report.stability = check_step_stability(model, *loaded.scene.time, options.places);
  return report;
}

ExitCode check(const CheckOptions& options) {
  std::vector<Problem> problems;
  Report report;
  try {
    report = check_scene(options);
  } catch (const ConfigError& error) {
    if (!options.common.json) throw;
    problems = error.problems();
  }
  const std::size_t num_warnings = report.warnings.size();
  if (options.common.json) {
    Json object = {{"errors", problems_json(problems)},
                   {"warnings", problems_json(report.warnings)}};
    if (!report.bodies.empty()) object["matrix_bodies"] = report.bodies;
    for (const auto& [name, facts] : report.imports) object["imports"][name] = import_json(facts);
    if (report.stability) object["stability"] = step_stability_json(*report.stability);
    print_json(object);
  } else {
    print_warnings(report.warnings);
    fmt::print("{}: no errors{}\n", options.scene,
               num_warnings == 0   ? ""
               : num_warnings == 1 ? ", 1 warning"
                                   : fmt::format(", {} warnings", num_warnings));
    print_matrix_bodies(report.bodies);
    for (const auto& [name, facts] : report.imports) {
      fmt::print("{}:\n", name);
      print_import(facts, "  ");
    }
    if (report.stability) print_step_stability(*report.stability);
  }
  if (!problems.empty()) return ExitCode::bad_input;
  const bool steps_grow = report.stability && report.stability->steps_grow();
  return steps_grow ? ExitCode::numbers_failed : ExitCode::done;
}

}  // namespace

void add_check_command(CLI::App& program, Action& action) {
  auto options = std::make_shared<CheckOptions>();
  CLI::App* verb =
      program.add_subcommand("check", "All errors of a scene at once, and what is hardly meant");
  verb->add_option("scene", options->scene, "Scene file (YAML)")->required();
  add_scene_options(*verb, options->common);
  add_json_option(*verb, options->common);
  verb->add_flag("--stability", options->stability,
                 "Also whether the steps are stable along the path: spectral radius of a step with "
                 "the sliding held, against the growth of the bodies themselves");
  verb->add_option("--places", options->places, "How many places of the path (default 101)")
      ->check(CLI::Range(1, 100000));
  verb->callback([options, &action] { action = [options] { return check(*options); }; });
}

}  // namespace stridor
