// stridor info: contents of a file of results.
#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <string>
#include <vector>

#include "app/results/burst_text.hpp"
#include "app/results/pictures.hpp"
#include "app/results/transient_results.hpp"
#include "app/runs/run_keeping.hpp"
#include "app/terminal/command.hpp"
#include "core/errors.hpp"
#include "io/figures/run_panels.hpp"
#include "io/hdf5/damage_guard.hpp"
#include "io/results/result_file.hpp"
#include "io/run_file/run_file.hpp"
#include "io/run_file/run_summary.hpp"

namespace stridor {
namespace {

struct InfoOptions {
  CommonOptions common;
  std::string file;
  std::optional<std::string> band;  ///< of bursts
};

Json attribute_json(const std::variant<std::string, double>& value) {
  if (const double* real = std::get_if<double>(&value)) return number(*real);
  return std::get<std::string>(value);
}

void print_line(const std::string& name, const std::string& value) {
  fmt::print("{:<48} {}\n", name, value);
}

std::vector<ResultArray> all_arrays(const ResultFile& file) {
  std::vector<ResultArray> all = file.arrays();
  const std::vector<ResultArray>& others = file.texts_and_numbers();
  all.insert(all.end(), others.begin(), others.end());
  std::ranges::sort(all, {}, &ResultArray::path);
  return all;
}

/// "41 x 20, 1/s", of a number without extents its unit alone.
std::string extents_text(const ResultArray& array) {
  if (array.shape.empty() || array.units.empty())
    return array.shape.empty() ? array.units : fmt::format("{}", fmt::join(array.shape, " x "));
  return fmt::format("{}, {}", fmt::join(array.shape, " x "), array.units);
}

/// Of a file of another verb than run: what made it, the attributes of its root, its arrays.
Json contents_json(const ResultFile& file) {
  Json object = {{"file", file.path()}, {"kind", file.kind()}};
  Json results = Json::object();
  for (const auto& [name, value] : file.attributes()) {
    const bool is_of_file = name == "version" || name == "commit" || name == "command" ||
                            name == "scene" || name == "scene_hash" || name == "date";
    // The scene is long, and the others say for programs that draw what stands here by itself.
    const bool is_for_viewers = name == "scene_resolved" || name == "kind" || name == "title" ||
                                name == "history" || name == "source" || name == "default";
    if (is_of_file) object[name] = attribute_json(value);
    if (!is_of_file && !is_for_viewers) results[name] = attribute_json(value);
  }
  object["series"] = Json::array();
  for (const ResultArray& array : all_arrays(file))
    object["series"].push_back(
        {{"path", array.path}, {"shape", array.shape}, {"units", array.units}});
  object["results"] = std::move(results);
  return object;
}

ExitCode info_of_results(const InfoOptions& options, const ResultFile& file) {
  if (options.band)
    throw ConfigError(Refusal::contradiction, "--band",
                      fmt::format("is for the bursts of a run; {} is of the kind '{}'",
                                  options.file, file.kind()));
  const Json object = contents_json(file);
  if (options.common.json) {
    print_json(object);
    return ExitCode::done;
  }
  print_line("kind", file.kind());
  print_line("made by", fmt::format("stridor {} ({}), {}", file.text("version"),
                                    file.text("commit"), file.text("date")));
  for (const char* name : {"command", "scene", "scene_hash"})
    if (const std::string text = file.text(name); !text.empty())
      print_line(name == std::string("scene_hash") ? "scene hash" : name, text);
  fmt::print("series\n");
  for (const ResultArray& array : all_arrays(file))
    print_line("  " + array.path, extents_text(array));
  fmt::print("results\n");
  for (const auto& [name, value] : object["results"].items())
    print_line("  " + name, value.is_string() ? value.get<std::string>() : value.dump());
  return ExitCode::done;
}

ExitCode info(const InfoOptions& options) {
  const DamageGuard guard(options.file);
  {
    const ResultFile any(options.file);
    if (!any.kind().empty() && any.kind() != "run") return info_of_results(options, any);
  }
  const RunFileReader file(options.file);
  const RunFileHeader& header = file.header();
  const std::vector<double>& times = file.times();
  Json object = {{"file", options.file},      {"kind", "run"},
                 {"version", header.version}, {"commit", header.commit},
                 {"command", header.command}, {"scene_hash", header.scene_hash},
                 {"date", header.date},       {"samples", times.size()}};
  object["time"] =
      times.empty() ? Json(nullptr) : Json{{"from", times.front()}, {"to", times.back()}};
  object["series"] = Json::array();
  for (const std::string& name : file.series_names()) {
    const auto attributes = file.attributes(name);
    const auto filter = attributes.find("filter");
    object["series"].push_back(
        {{"path", name},
         {"units", file.units(name)},
         {"filter", filter == attributes.end() ? Json(nullptr) : attribute_json(filter->second)}});
  }
  object["results"] = Json::object();
  for (const auto& [name, value] : file.results()) object["results"][name] = attribute_json(value);
  object["bursts"] = bursts_json(bursts_of(file, options.file, options.band));

  if (options.common.json) {
    print_json(object);
    return ExitCode::done;
  }
  print_line("made by",
             fmt::format("stridor {} ({}), {}", header.version, header.commit, header.date));
  print_line("command", header.command);
  print_line("scene hash", header.scene_hash);
  print_line("samples", times.empty() ? "none"
                                      : fmt::format("{} from {:g} to {:g} s", times.size(),
                                                    times.front(), times.back()));
  fmt::print("series\n");
  for (const std::string& name : file.series_names()) {
    const std::string note = filter_note(file, name);
    print_line("  " + name, file.units(name) + (note.empty() ? "" : ", " + note));
  }
  if (object["bursts"].empty()) print_line("bursts", "none");
  for (const auto& [name, text] : burst_lines(object["bursts"])) print_line(name, text);
  const Json results = stored_results(file);
  const Json tone = options.band ? Json(nullptr) : results.value("lasting_tone", Json(nullptr));
  if (!tone.is_null()) print_line("lasting tone", lasting_tone_text(tone));
  const std::string doubtful =
      doubtful_text(object["bursts"], tone, results.value("trusted_frequency", Json(nullptr)));
  if (!doubtful.empty()) print_line("doubtful", doubtful);
  fmt::print("results\n");
  for (const auto& [name, value] : object["results"].items()) {
    print_line("  " + name, value.is_string() ? value.get<std::string>() : value.dump());
  }
  return ExitCode::done;
}

}  // namespace

void add_info_command(CLI::App& program, Action& action) {
  auto options = std::make_shared<InfoOptions>();
  CLI::App* verb = program.add_subcommand("info", "What a file of results holds");
  verb->add_option("file", options->file, "File of a run or of any other verb (HDF5)")->required();
  add_band_option(*verb, options->band);
  add_json_option(*verb, options->common);
  verb->callback([options, &action] { action = [options] { return info(*options); }; });
}

}  // namespace stridor
