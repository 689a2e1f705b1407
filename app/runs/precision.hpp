// Measurements of the verb precision and their report.
#pragma once

#include <filesystem>
#include <limits>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "analysis/precision_study.hpp"
#include "app/runs/studied_scene.hpp"
#include "app/terminal/command.hpp"

namespace stridor {

/// Files in the folder of a study.
inline constexpr const char* precision_figure_name = "precision.png";
inline constexpr const char* precision_json_name = "precision.json";

/// Options of the command line, as written.
struct PrecisionOptions {
  CommonOptions common;
  std::string scene;
  std::string folder;
  std::string norm = "envelope";
  std::optional<std::string> tune;
  std::optional<std::string> until;
  std::vector<std::string> retain;
  std::vector<std::string> assumptions;
  std::vector<std::string> frequencies;  ///< at which reduced bodies are compared with full ones
  bool only_reduction = false;
  int points = 7;
  double published_window = 0.005;
  std::string command_line;
};

/// The contact assumptions by their keys.
const std::vector<std::pair<std::string, ContactAssumption>>& assumption_names();

struct PrecisionStudy : StudiedScene {
  StudyParameters parameters;
  PrecisionPlan plan;
};

/// @throws ConfigError with places in the scene, FileError, NumericalError
PrecisionStudy make_precision_study(const PrecisionOptions& options, LoadedScene loaded);

/// One setting, its run and what came of it.
struct PrecisionRow {
  PrecisionMethod method;
  Coordinates coordinates = Coordinates::modal;
  int steps_per_sample = 1;
  int modes = 0;
  TimeParameters time;
  std::int64_t num_samples = 0;  ///< that it is run for
  std::unique_ptr<TimedRun> run;
  RunErrors errors{};
  double error = std::numeric_limits<double>::quiet_NaN();
  bool is_stable = false;
  bool is_on_front = false;
  RunCost cost;
  double whole_steps = 0.0;  ///< of the whole run

  /// Time of stepping through the whole run at the pace of the fastest stretch, s.
  double least_seconds() const { return cost.least_step * whole_steps; }
  double seconds() const {
    return cost.steps > 0 ? cost.stepping / static_cast<double>(cost.steps) * whole_steps : 0.0;
  }
  bool is_measured() const { return coordinates == Coordinates::modal; }
};

using PrecisionRows = std::vector<PrecisionRow>;

/// All rows and what they are measured against.
struct PrecisionResult {
  PrecisionRows rows;      ///< reference first, its check second
  RunErrors own_errors;    ///< of the reference
  double own_error = 0.0;  ///< in the norm chosen
  std::optional<std::size_t> tuned;
  ContactAssumption own_assumption;

  const PrecisionRow& reference() const { return rows[0]; }
};

/// Runs the reference and all settings of the plan interleaved, and judges them.
/// @throws Interrupted, and NumericalError where the reference fails
PrecisionResult measure_precision(const PrecisionStudy& study, const PrecisionOptions& options);

/// The cheapest setting whose error, with that of the reference on top, is within what was asked.
std::optional<std::size_t> cheapest_within(const PrecisionResult& result, double wanted);

/// The JSON object of `precision`.
Json precision_json(const PrecisionStudy& study, const PrecisionOptions& options,
                    const PrecisionResult& result, std::optional<double> wanted);
/// The same as a table on stdout.
void print_precision(const PrecisionStudy& study, const PrecisionOptions& options,
                     const PrecisionResult& result, std::optional<double> wanted);
/// The same as a figure.
void draw_precision(const PrecisionStudy& study, const PrecisionOptions& options,
                    const PrecisionResult& result, std::optional<double> wanted,
                    const std::filesystem::path& figure);

}  // namespace stridor
