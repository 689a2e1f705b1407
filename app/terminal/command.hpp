// Functions common to all verbs of the command line.
#pragma once

#include <CLI/CLI.hpp>
#include <filesystem>
#include <functional>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

#include "core/errors.hpp"
#include "io/run_file/run_file.hpp"

namespace stridor {

/// Exit codes of the program.
enum class ExitCode {
  done = 0,
  internal = 1,
  bad_input = 2,
  numbers_failed = 3,
  file_trouble = 4,
  stopped = 5
};

/// Keeps the order of the keys as they were set.
using Json = nlohmann::ordered_json;

/// Options that several verbs have.
struct CommonOptions {
  std::vector<std::string> sets;
  bool json = false;
  bool force = false;
  int threads = 1;

  Overwrite overwrite() const { return force ? Overwrite::yes : Overwrite::no; }
};

void add_scene_options(CLI::App& verb, CommonOptions& options);
void add_json_option(CLI::App& verb, CommonOptions& options);
void add_force_option(CLI::App& verb, CommonOptions& options);

/// Refuses a figure before anything is computed for it.
/// @throws ConfigError for a name without a known ending
/// @throws FileError   for one that exists and may not be overwritten
void check_figure(const std::filesystem::path& figure, const CommonOptions& options);

/// Code, place, key and message of each problem; of a failure without a place code and message
/// alone. `dataset` where one of a file is meant.
Json problems_json(const std::vector<Problem>& problems);

/// Warns on stderr of input that is probably not intended but does not stop a verb. The JSON object
/// of the verb then has a list `warnings`, empty where there are none.
void print_warnings(const std::vector<Problem>& warnings);

/// Takes the one JSON object that a verb prints. It is printed when the verb has ended, since a
/// failure that comes after it belongs into it.
void print_json(Json object);

/// Ends a verb that was asked for JSON: prints what print_json() took, with a list `errors` where
/// there are any, and of a verb that failed before it {"errors": [...]} alone.
void finish_json(const std::vector<Problem>& errors);

/// A number for JSON; null where it is not finite.
Json number(double value);
Json number_or_null(const std::optional<double>& value);

/// The number to which a pointer into an object leads; NaN where there is none.
double pointed_number(const Json& object, const char* pointer);

/// Values at equal ratios from {first, last, number of them}.
/// @throws ConfigError naming the option if they are not 0 < first < last and 4 to 1000 of them
std::vector<double> spaced_values(const char* option, const std::vector<double>& range);

/// Each verb declares itself; `action` receives its work when it was given.
using Action = std::function<ExitCode()>;
void add_contact_command(CLI::App& program, Action& action, const std::string& command_line);
void add_fit_command(CLI::App& program, Action& action);
void add_cycle_command(CLI::App& program, Action& action, const std::string& command_line);
void add_sweep_command(CLI::App& program, Action& action, const std::string& command_line);
void add_run_command(CLI::App& program, Action& action, const std::string& command_line);
void add_check_command(CLI::App& program, Action& action);
void add_import_command(CLI::App& program, Action& action);
void add_info_command(CLI::App& program, Action& action);
void add_draw_command(CLI::App& program, Action& action);
void add_plot_command(CLI::App& program, Action& action, const std::string& command_line);
void add_schema_command(CLI::App& program, Action& action);
void add_compare_command(CLI::App& program, Action& action, const std::string& command_line);
void add_precision_command(CLI::App& program, Action& action, const std::string& command_line);
void add_eig_command(CLI::App& program, Action& action, const std::string& command_line);
void add_locus_command(CLI::App& program, Action& action, const std::string& command_line);
void add_map_command(CLI::App& program, Action& action, const std::string& command_line);
void add_threshold_command(CLI::App& program, Action& action, const std::string& command_line);
void add_spectrogram_command(CLI::App& program, Action& action, const std::string& command_line);
void add_sound_command(CLI::App& program, Action& action);
void add_report_command(CLI::App& program, Action& action, const std::string& command_line);
/// Verbs that no user calls: pages of the manual.
void add_hidden_commands(CLI::App& program, Action& action);
/// For shells: what the last word may go on to, a line each, what it is behind a tab.
void print_candidates(const CLI::App& program, const std::vector<std::string>& words,
                      const std::vector<std::string>& behind);
void add_frf_command(CLI::App& program, Action& action, const std::string& command_line);

}  // namespace stridor
