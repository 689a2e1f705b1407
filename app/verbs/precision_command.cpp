// stridor precision: error against run time of the ways to integrate a scene.
#include <fmt/format.h>

#include <cstdio>
#include <filesystem>
#include <memory>

#include "app/results/output_folder.hpp"
#include "app/results/pictures.hpp"
#include "app/runs/event_precision.hpp"
#include "app/runs/precision_file.hpp"
#include "app/runs/reduction_report.hpp"
#include "app/terminal/remark.hpp"

namespace stridor {
namespace {

namespace fs = std::filesystem;

/// The error of the reductions alone.
ExitCode precision_of_reductions(const PrecisionOptions& options, const LoadedScene& loaded) {
  const Json reductions = reductions_json(loaded, options.frequencies);
  if (!options.folder.empty()) {
    prepare_folder(options.folder, {precision_json_name}, options.common.overwrite());
    write_json(fs::path(options.folder) / precision_json_name, {{"reduction", reductions}});
  }
  if (options.common.json) {
    print_json({{"reduction", reductions}});
  } else {
    print_reductions(reductions);
  }
  return ExitCode::done;
}

ExitCode precision(const PrecisionOptions& options) {
  LoadedScene loaded = load_scene(options.scene, options.common.sets);
  if (options.only_reduction) return precision_of_reductions(options, loaded);
  loaded.require_section("time", "precision");
  if (loaded.scene.time->is_event_driven()) return precision_of_events(options, loaded);
  std::optional<double> wanted;
  if (options.tune) wanted = option_value("--tune", *options.tune, "", Range::inside(0.0, 1.0));
  const PrecisionStudy study = make_precision_study(options, std::move(loaded));
  const bool is_kept = !options.folder.empty();
  if (is_kept) {
    prepare_folder(options.folder,
                   {precision_figure_name, precision_json_name, precision_file_name},
                   options.common.overwrite());
  }

  const Json reductions = reductions_json(study.loaded, options.frequencies);
  PrecisionResult result = measure_precision(study, options);
  if (wanted) result.tuned = cheapest_within(result, *wanted);

  Json object = precision_json(study, options, result, wanted);
  object["reduction"] = reductions;
  if (is_kept) {
    const fs::path folder = options.folder;
    draw_precision(study, options, result, wanted, folder / precision_figure_name);
    write_json(folder / precision_json_name, object);
    write_precision_file(folder / precision_file_name, object, options, study.loaded);
  }
  if (options.common.json) {
    print_json(object);
  } else {
    print_precision(study, options, result, wanted);
    print_reductions(reductions);
    if (is_kept)
      fmt::print("\n{}, {} and {} in {}\n", precision_figure_name, precision_json_name,
                 precision_file_name, options.folder);
  }
  if (wanted && !result.tuned) {
    print_remark(
        "stridor: no setting measured is within {:g}, with the error of the reference, "
        "{:.2g}, on top\n",
        *wanted, result.own_error);
    return ExitCode::numbers_failed;
  }
  return ExitCode::done;
}

}  // namespace

void add_precision_command(CLI::App& program, Action& action, const std::string& command_line) {
  auto options = std::make_shared<PrecisionOptions>();
  options->command_line = command_line;
  CLI::App* verb = program.add_subcommand(
      "precision", "Error against run time over integrators, steps and retained modes");
  verb->add_option("scene", options->scene, "Scene file (YAML)")->required();
  verb->add_option(
      "-o,--output", options->folder,
      "Folder for precision.json, precision.h5 (which `report` takes) and precision.png");
  verb->add_option("--tune", options->tune,
                   "Name the cheapest setting within this relative error, as lines of a scene");
  verb->add_option("--norm", options->norm,
                   "Error that counts: envelope (default), acceleration, "
                   "force")
      ->check(CLI::IsMember({"envelope", "acceleration", "force"}));
  verb->add_option("--until", options->until, "Take the run only to this time, s");
  verb->add_option("--retain", options->retain,
                   "Frequencies up to which modes move, Hz: 25kHz,50kHz; default: 5/3, 10/3 and "
                   "20/3 of the upper end of the band")
      ->delimiter(',');
  std::vector<std::string> names;
  for (const auto& [name, value] : assumption_names()) names.push_back(name);
  verb->add_option("--assumptions", options->assumptions,
                   "Contact assumptions beside the scene's own: subs_a,film; default: all")
      ->delimiter(',')
      ->check(CLI::IsMember(names));
  verb->add_flag("--reduction", options->only_reduction,
                 "Only how far the reduced bodies answer from the full ones; nothing is run");
  verb->add_option("--frequencies", options->frequencies,
                   "Where reduced bodies are compared with full ones: 500Hz,2kHz; default: 1/16 to "
                   "1 of what a reduction is trusted to")
      ->delimiter(',');
  verb->add_option("--points", options->points, "Steps measured per method")
      ->check(CLI::Range(2, 100))
      ->capture_default_str();
  verb->add_option(
          "--published-window", options->published_window,
          "Seconds of the run that the published dense forms are timed over; 0: not at all")
      ->check(CLI::NonNegativeNumber)
      ->capture_default_str();
  add_scene_options(*verb, options->common);
  add_json_option(*verb, options->common);
  add_force_option(*verb, options->common);
  verb->callback([options, &action] { action = [options] { return precision(*options); }; });
}

}  // namespace stridor
