// stridor compare: the contact assumptions on the same work.
#include <fmt/format.h>

#include <array>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <memory>

#include "analysis/band_pass.hpp"
#include "app/results/file_attributes.hpp"
#include "app/results/output_folder.hpp"
#include "app/runs/comparison_file.hpp"
#include "app/runs/transient.hpp"
#include "app/runs/turns.hpp"
#include "app/terminal/command.hpp"
#include "core/errors.hpp"
#include "core/stop_token.hpp"
#include "io/figures/comparison_plot.hpp"

namespace stridor {
namespace {

namespace fs = std::filesystem;

struct CompareOptions {
  CommonOptions common;
  std::string scene;
  std::string folder;
  double window = 0.0;  ///< s of the run in the published form; 0: none
  std::string command_line;
};

struct Assumption {
  const char* name;
  const char* title;
  ContactAssumption value;
};
constexpr std::array<Assumption, 4> assumptions{{{"subs_a", "Subs-a", ContactAssumption::subs_a},
                                                 {"subs_b", "Subs-b", ContactAssumption::subs_b},
                                                 {"subs_c", "Subs-c", ContactAssumption::subs_c},
                                                 {"film", "FiLM", ContactAssumption::film}}};
constexpr std::size_t film = 3;

/// A folder for temporary files; removed with everything in it.
class ScratchFolder {
 public:
  ScratchFolder() {
    std::string name = (fs::temp_directory_path() / "stridor-compare-XXXXXX").string();
    if (mkdtemp(name.data()) == nullptr)
      throw FileError(Refusal::cannot_write, name, "", "cannot be made");
    path_ = name;
  }
  ~ScratchFolder() {
    std::error_code ignored;
    fs::remove_all(path_, ignored);
  }
  ScratchFolder(const ScratchFolder&) = delete;
  ScratchFolder& operator=(const ScratchFolder&) = delete;
  const fs::path& path() const { return path_; }

 private:
  OrderlyStop until_removed_;
  fs::path path_;
};

LoadedScene with_assumption(const LoadedScene& loaded, ContactAssumption assumption) {
  LoadedScene changed = loaded;
  ModelParameters& model = changed.scene.model;
  if (model.contact) model.contact->assumption = assumption;
  for (auto& [name, pair] : model.contacts) pair.assumption = assumption;
  return changed;
}

/// Force and sliding velocity of the first contact are drawn, whether the scene records them or
/// not.
void record_contact(Scene& scene) {
  std::vector<std::string>& channels = scene.record->channels;
  const std::string pair = scene.model.pairs().begin()->first;
  for (const char* quantity : {".force", ".slip_velocity"}) {
    if (std::find(channels.begin(), channels.end(), pair + quantity) == channels.end())
      channels.push_back(pair + quantity);
  }
}

/// Transient of one assumption and its results.
struct Candidate {
  LoadedScene scene;
  std::string file;
  std::unique_ptr<Transient> transient;
  MarchEnd end = MarchEnd::finished;
  Json results;
};

using Candidates = std::vector<Candidate>;

/// Of the transients that have begun: nobody asked for these files without the comparison.
void remove_files(Candidates& candidates) {
  for (Candidate& candidate : candidates) {
    if (!candidate.transient) continue;
    candidate.transient.reset();
    std::error_code ignored;
    fs::remove(candidate.file, ignored);
  }
}

/// Runs the transients interleaved, a hundredth of the run at a time, so that other load on the
/// machine affects all of them alike.
Candidates run_interleaved(const LoadedScene& loaded, Coordinates coordinates, double end,
                           const fs::path& folder, const CompareOptions& options) {
  const char* suffix = coordinates == Coordinates::modal ? "" : "_published";
  Candidates candidates(assumptions.size());
  for (std::size_t i = 0; i < assumptions.size(); ++i) {
    Candidate& candidate = candidates[i];
    candidate.scene = with_assumption(loaded, assumptions[i].value);
    candidate.scene.scene.time->coordinates = coordinates;
    candidate.scene.scene.time->end = end;
    candidate.file = (folder / fmt::format("{}{}.h5", assumptions[i].name, suffix)).string();
    try {
      candidate.transient = std::make_unique<Transient>(
          candidate.scene,
          RunOutput{candidate.file, options.common.overwrite(), options.command_line});
    } catch (...) {
      remove_files(candidates);
      throw;
    }
  }
  constexpr int turns = 100;
  run_in_turns(coordinates == Coordinates::modal ? "modal" : "published form",
               std::vector<double>(candidates.size(), 1.0), turns, [&](std::size_t i, int turn) {
                 Candidate& candidate = candidates[i];
                 if (candidate.end != MarchEnd::finished) return assumptions[i].title;
                 candidate.end = turn < turns ? candidate.transient->run_until(end * turn / turns)
                                              : candidate.transient->run_to_end();
                 if (candidate.end == MarchEnd::stopped) {
                   throw Interrupted(fmt::format("at t = {:.4g} of {:.4g} s; nothing was compared",
                                                 candidate.transient->time(), end));
                 }
                 return assumptions[i].title;
               });
  for (Candidate& candidate : candidates) candidate.results = candidate.transient->finish();
  return candidates;
}

/// r.m.s. of a − b over that of b, over the window and within the band of `measure`; the shorter of
/// the two says how far.
std::optional<double> relative_difference(const std::vector<double>& a,
                                          const std::vector<double>& b, double interval,
                                          const MeasureParameters& measure) {
  const std::size_t size = std::min(a.size(), b.size());
  if (size < 2) return std::nullopt;
  std::vector<double> difference(size);
  for (std::size_t i = 0; i < size; ++i) difference[i] = a[i] - b[i];
  std::vector<double> reference(b.begin(), b.begin() + static_cast<std::ptrdiff_t>(size));
  if (measure.band.size() == 2) {
    const Band band{measure.band[0], measure.band[1]};
    difference = band_pass(difference, interval, band);
    reference = band_pass(reference, interval, band);
  }
  const Window window{measure.from, measure.to.value_or(std::numeric_limits<double>::infinity())};
  const IndexRange range = samples_in(window, 0.0, interval, size);
  if (range.is_empty()) return std::nullopt;
  const double scale = rms(range.of(reference));
  if (!(scale > 0.0)) return std::nullopt;
  return rms(range.of(difference)) / scale;
}

std::string status_of(const Candidate& candidate) {
  if (candidate.end == MarchEnd::finished) return "done";
  return "failed: " + with_code(candidate.transient->failure(), candidate.transient->refusal());
}

Json rows_of(const Candidates& candidates, const char* coordinates) {
  const double film_step = candidates[film].results["step_ns"].get<double>();
  const RunFileReader film_file(candidates[film].file);
  const auto channel = acceleration_channel(film_file);
  Json rows = Json::array();
  for (std::size_t i = 0; i < candidates.size(); ++i) {
    const Candidate& candidate = candidates[i];
    const Json& results = candidate.results;
    const Json& acceleration = results["free_end_acceleration"];
    Json difference = nullptr;
    if (channel) {
      const auto value = relative_difference(
          RunFileReader(candidate.file).series(*channel), film_file.series(*channel),
          candidate.scene.scene.record->interval, candidate.scene.scene.measure);
      if (value) difference = *value;
    }
    rows.push_back({{"assumption", assumptions[i].name},
                    {"coordinates", coordinates},
                    {"wall_s", results["wall_s"]},
                    // Per step, so that a run that stopped early is compared fairly.
                    {"ratio", number(results["step_ns"].get<double>() / film_step)},
                    {"step_ns", results["step_ns"]},
                    {"steps", results["steps"]},
                    {"peak", acceleration.is_null() ? Json(nullptr) : acceleration["peak"]},
                    {"rms", acceleration.is_null() ? Json(nullptr) : acceleration["rms"]},
                    {"difference", difference},
                    {"contact_force",
                     results.contains("contact_force") ? results["contact_force"] : Json(nullptr)},
                    {"stick_fraction", results["stick_fraction"]},
                    {"free_fraction", results["free_fraction"]},
                    {"bursts", results["bursts"]},
                    {"status", status_of(candidate)}});
  }
  return rows;
}

void print_rows(const Json& rows) {
  const auto text = [](const Json& value, const char* form) {
    return value.is_null() ? std::string("-")
                           : fmt::format(fmt::runtime(form), value.get<double>());
  };
  fmt::print("{:<10} {:<14} {:>9} {:>9} {:>7} {:>11} {:>11} {:>11} {:>7}  {}\n", "assumption",
             "coordinates", "wall s", "ns/step", "ratio", "peak m/s^2", "rms m/s^2", "difference",
             "bursts", "status");
  for (const Json& row : rows) {
    const std::string status = row["status"].get<std::string>();
    fmt::print(
        "{:<10} {:<14} {:>9} {:>9} {:>7} {:>11} {:>11} {:>11} {:>7}  {}\n",
        row["assumption"].get<std::string>(), row["coordinates"].get<std::string>(),
        text(row["wall_s"], "{:.4g}"), text(row["step_ns"], "{:.0f}"), text(row["ratio"], "{:.3f}"),
        text(row["peak"], "{:.5g}"), text(row["rms"], "{:.5g}"), text(row["difference"], "{:.3g}"),
        row["bursts"].is_null() ? std::string("-") : std::to_string(row["bursts"].size()), status);
  }
}

/// The published form is that of one integrator with all modes.
void check_published_form(const CompareOptions& options, const TimeParameters& time) {
  if (!(options.window > 0.0)) return;
  if (time.integrator == Integrator::central_difference && !time.retain) return;
  throw ConfigError(
      Refusal::contradiction, "--published-window",
      fmt::format("the published form takes time.integrator: central_difference with all modes, "
                  "but the scene has {}; leave the option away, or set it",
                  time.retain ? "time.retain" : "integrator: exact"));
}

ComparisonRun drawn(const Candidate& candidate, const char* title) {
  return {title, candidate.file};
}

ExitCode compare(const CompareOptions& options) {
  LoadedScene loaded = load_scene(options.scene, options.common.sets);
  for (const char* section : {"time", "contact"}) loaded.require_section(section, "compare");
  if (!loaded.scene.record) {
    throw loaded.located(ConfigError(Refusal::missing, "record",
                                     "missing: compare needs an acceleration to compare by"));
  }
  if (loaded.scene.time->is_event_driven()) {
    throw loaded.located(ConfigError(Refusal::contradiction, "time.integrator",
                                     "event_driven knows no contact assumptions to compare"));
  }
  check_published_form(options, *loaded.scene.time);
  record_contact(loaded.scene);
  const bool is_kept = !options.folder.empty();
  std::optional<ScratchFolder> scratch;
  fs::path folder = options.folder;
  if (is_kept) {
    prepare_folder(folder,
                   {"comparison.json", "comparison.h5", "accelerations.png",
                    "sliding_velocities.png", "contact_forces.png", "spectrograms.png"},
                   options.common.overwrite());
  } else {
    scratch.emplace();
    folder = scratch->path();
  }

  const Candidates modal =
      run_interleaved(loaded, Coordinates::modal, loaded.scene.time->end, folder, options);
  Json comparison{{"scene", options.scene}, {"rows", rows_of(modal, "modal")}};
  if (options.window > 0.0) {
    const double end = std::min(options.window, loaded.scene.time->end);
    const Candidates published =
        run_interleaved(loaded, Coordinates::craig_bampton, end, folder, options);
    for (const Json& row : rows_of(published, "craig_bampton")) comparison["rows"].push_back(row);
    comparison["published_window"] = end;
  }
  if (is_kept) {
    std::vector<ComparisonRun> runs;
    for (std::size_t i = 0; i < modal.size(); ++i)
      runs.push_back(drawn(modal[i], assumptions[i].title));
    plot_comparison(runs, folder, loaded.scene);
    write_json(folder / "comparison.json", comparison);
    write_comparison_file(folder / "comparison.h5", options.common.overwrite(), comparison["rows"],
                          source_attributes(loaded, options.command_line));
  }

  if (options.common.json) {
    print_json(comparison);
  } else {
    print_rows(comparison["rows"]);
    if (is_kept)
      fmt::print("\nrun files, figures, comparison.json and comparison.h5 in {}\n",
                 folder.string());
  }
  return ExitCode::done;
}

}  // namespace

void add_compare_command(CLI::App& program, Action& action, const std::string& command_line) {
  auto options = std::make_shared<CompareOptions>();
  options->command_line = command_line;
  CLI::App* verb = program.add_subcommand(
      "compare", "Subs-a, Subs-b, Subs-c and FiLM on the same scene: time, results, bursts");
  verb->add_option("scene", options->scene, "Scene file (YAML)")->required();
  verb->add_option(
      "-o,--output", options->folder,
      "Folder for run files, figures, comparison.json and comparison.h5; without it none is kept");
  verb->add_option("--published-window", options->window,
                   "Time the published dense form as well, over this many seconds of the run")
      ->check(CLI::NonNegativeNumber);
  add_scene_options(*verb, options->common);
  add_json_option(*verb, options->common);
  add_force_option(*verb, options->common);
  verb->callback([options, &action] { action = [options] { return compare(*options); }; });
}

}  // namespace stridor
