// stridor report: files of results as one page that needs nothing beside it.
#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <numeric>

#include "app/report/report_section.hpp"
#include "app/results/pictures.hpp"
#include "core/activity.hpp"
#include "core/errors.hpp"
#include "core/version.hpp"
#include "io/hdf5/damage_guard.hpp"

namespace stridor {
namespace {

namespace fs = std::filesystem;

/// Bytes from "8MiB", "500kB", "8000000".
double budget_bytes(const std::string& text) {
  const std::vector<std::pair<std::string, double>> units{
      {"GiB", 1073741824.0}, {"MiB", 1048576.0}, {"KiB", 1024.0}, {"kiB", 1024.0},
      {"GB", 1e9},           {"MB", 1e6},        {"kB", 1e3},     {"B", 1.0}};
  std::string number = text;
  double factor = 1.0;
  for (const auto& [unit, bytes] : units) {
    if (!text.ends_with(unit)) continue;
    number = text.substr(0, text.size() - unit.size());
    factor = bytes;
    break;
  }
  while (number.ends_with(' ')) number.pop_back();
  const double bytes = factor * option_value("--budget", number, "", Range::positive());
  constexpr double least = 2e5;
  if (bytes < least) {
    throw ConfigError(Refusal::too_large, "--budget",
                      fmt::format("'{}' is less than the page itself takes; give at least "
                                  "300kB",
                                  text));
  }
  return bytes;
}

void check_files(const ReportOptions& options) {
  if (fs::path(options.output).extension() != ".html" && fs::path(options.output).extension() != ".htm") {
    throw ConfigError(
        Refusal::wrong_value, "--output",
        fmt::format("'{}' does not end in .html, the form of reports", options.output));
  }
  for (const std::string& file : options.files) {
    std::error_code missing;
    if (fs::equivalent(file, options.output, missing))
      throw ConfigError(Refusal::doubled_name, "--output",
                        fmt::format("'{}' is also a file to report", options.output));
  }
  check_output(options.output, options.common.overwrite());
}

/// Windows of the loci among the files that are over the way of a run.
std::vector<WindowsOfScene> windows_of_files(const std::vector<ResultFile>& files) {
  std::vector<WindowsOfScene> all;
  for (const ResultFile& file : files) {
    if (file.kind() != "locus") continue;
    std::vector<TimedWindow> windows = read_locus_windows(file.path());
    const bool is_passed = std::any_of(windows.begin(), windows.end(), [](const TimedWindow& one) {
      return std::isfinite(one.from_time);
    });
    const SceneInFile scene{file.text("scene_hash"), file.text("scene_resolved")};
    if (is_passed) all.push_back({file.path(), scene, std::move(windows)});
  }
  return all;
}

/// The files whose sections take little first, runs last.
std::vector<std::size_t> in_order_of_size(const std::vector<ResultFile>& files) {
  const auto rank = [&](std::size_t i) {
    const std::string kind = files[i].kind();
    return kind == "run" ? 2 : kind == "locus" ? 1 : 0;
  };
  std::vector<std::size_t> order(files.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::ranges::stable_sort(order, {}, rank);
  return order;
}

/// Gives sections whose scenes have the same mechanics the same number, by which the page sets a
/// locus beside its runs.
void number_mechanics(Json& sections) {
  const auto scene_of = [](const Json& section) {
    return SceneInFile{section.value("scene_hash", ""), section["scene_resolved"]};
  };
  for (std::size_t i = 0; i < sections.size(); ++i) {
    if (!sections[i].contains("scene_resolved")) continue;
    std::size_t same = 0;
    while (same < i && !(sections[same].contains("mechanics") &&
                         has_same_mechanics(scene_of(sections[same]), scene_of(sections[i]))))
      ++same;
    sections[i]["mechanics"] = same < i ? sections[same]["mechanics"] : Json(i);
  }
}

/// The scenes, and what was computed of them.
std::string title_of(const std::vector<ResultFile>& files) {
  std::vector<std::string> scenes;
  std::vector<std::string> kinds;
  const auto add = [](const std::string& text, std::vector<std::string>& list) {
    if (std::find(list.begin(), list.end(), text) == list.end()) list.push_back(text);
  };
  for (const ResultFile& file : files) {
    const std::string scene = scene_name(file);
    add(scene.empty() ? fs::path(file.path()).filename().string() : scene, scenes);
    add(file.kind(), kinds);
  }
  constexpr std::size_t most = 3;
  const std::size_t num_more = scenes.size() > most ? scenes.size() - most : 0;
  scenes.resize(scenes.size() - num_more);
  std::string title = fmt::format("{}", fmt::join(scenes, ", "));
  if (num_more > 0) title += fmt::format(" and {} more", num_more);
  return fmt::format("{}: {} – stridor", title, fmt::join(kinds, ", "));
}

ExitCode report(const ReportOptions& options) {
  const double budget = budget_bytes(options.budget);
  check_files(options);
  std::optional<Activity> reading(std::in_place, "reading the files of the report");
  std::vector<std::unique_ptr<DamageGuard>> guards;
  std::vector<ResultFile> files;
  for (const std::string& path : options.files) {
    guards.push_back(std::make_unique<DamageGuard>(path));
    files.emplace_back(path);
  }
  reading.reset();
  ReportPage page(options.output, options.common.overwrite(), title_of(files));
  const double bytes_of_page = 3e5;  // of markup and scripts
  ReportContext context{options, page, 0.0, windows_of_files(files)};
  Json sections(files.size(), Json());
  std::size_t num_left = files.size();
  // The large ones get the bytes that the small ones do not need.
  for (const std::size_t i : in_order_of_size(files)) {
    const double spent = std::max(bytes_of_page, static_cast<double>(page.size()));
    context.bytes_per_file = std::max(1e5, budget - spent) / static_cast<double>(num_left--);
    sections[i] = report_section(files[i], context);
  }
  number_mechanics(sections);
  page.finish({{"format", 1},
               {"title", title_of(files)},
               {"version", std::string(version)},
               {"commit", std::string(commit)},
               {"command", options.command_line},
               {"sections", sections}});
  if (options.common.json) {
    Json object = {{"report", options.output}, {"bytes", page.size()}, {"sections", Json::array()}};
    for (const Json& section : sections) {
      object["sections"].push_back({{"file", section["file"]},
                                    {"kind", section["kind"]},
                                    {"verdict", section["verdict"]["text"]},
                                    {"remarks", section.value("remarks", Json::array())}});
    }
    print_json(object);
    return ExitCode::done;
  }
  for (const Json& section : sections) {
    fmt::print("{:<24}{}\n", section["file"].get<std::string>(),
               section["verdict"]["text"].get<std::string>());
    for (const Json& remark : section.value("remarks", Json::array()))
      fmt::print("{:<24}{}\n", "", remark.get<std::string>());
  }
  fmt::print("{} ({:.1f} MB); open it with any browser\n", options.output,
             1e-6 * static_cast<double>(page.size()));
  return ExitCode::done;
}

}  // namespace

void add_report_command(CLI::App& program, Action& action, const std::string& command_line) {
  auto options = std::make_shared<ReportOptions>();
  options->command_line = command_line;
  CLI::App* verb =
      program.add_subcommand("report", "Results as one page to look at, listen to and pass on (.html)");
  verb->add_option("files", options->files,
                   "Files of results (HDF5) of any verb; the windows of a locus are set beside the "
                   "bursts of runs of the same scene")
      ->required();
  verb->add_option("-o,--output", options->output, "Page to write; default: first FILE.html");
  verb->add_option("--channel", options->channels,
                   "Channel of runs to show (repeatable); default: the twelve of most use")
      ->take_all()
      ->allow_extra_args(false);
  verb->add_option("--budget", options->budget,
                   "Size that the page may have; beyond it histories are thinned to extremes")
      ->capture_default_str();
  verb->add_flag("--full", options->is_full, "Keep every sample, whatever the size");
  verb->add_flag("--no-shapes", options->without_shapes,
                 "Leave out the bodies: shapes of modes, and the slide of runs");
  add_json_option(*verb, options->common);
  add_force_option(*verb, options->common);
  verb->callback([options, &action] {
    if (options->output.empty())
      options->output = fs::path(options->files.front()).replace_extension(".html").string();
    action = [options] { return report(*options); };
  });
}

}  // namespace stridor
