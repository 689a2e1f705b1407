// stridor info: contents of a run file.
#include <fmt/format.h>

#include "app/results/burst_text.hpp"
#include "app/results/pictures.hpp"
#include "app/results/transient_results.hpp"
#include "app/runs/run_keeping.hpp"
#include "app/terminal/command.hpp"
#include "io/figures/run_panels.hpp"
#include "io/hdf5/damage_guard.hpp"
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

ExitCode info(const InfoOptions& options) {
  const DamageGuard guard(options.file);
  const RunFileReader file(options.file);
  const RunFileHeader& header = file.header();
  const std::vector<double>& times = file.times();
  Json object = {
      {"file", options.file},      {"version", header.version},       {"commit", header.commit},
      {"command", header.command}, {"scene_hash", header.scene_hash}, {"date", header.date},
      {"samples", times.size()}};
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
  const auto line = [](const std::string& name, const std::string& value) {
    fmt::print("{:<48} {}\n", name, value);
  };
  line("made by", fmt::format("stridor {} ({}), {}", header.version, header.commit, header.date));
  line("command", header.command);
  line("scene hash", header.scene_hash);
  line("samples", times.empty() ? "none"
                                : fmt::format("{} from {:g} to {:g} s", times.size(), times.front(),
                                              times.back()));
  fmt::print("series\n");
  for (const std::string& name : file.series_names()) {
    const std::string note = filter_note(file, name);
    line("  " + name, file.units(name) + (note.empty() ? "" : ", " + note));
  }
  if (object["bursts"].empty()) line("bursts", "none");
  for (const auto& [name, text] : burst_lines(object["bursts"])) line(name, text);
  const Json results = stored_results(file);
  const Json tone = options.band ? Json(nullptr) : results.value("lasting_tone", Json(nullptr));
  if (!tone.is_null()) line("lasting tone", lasting_tone_text(tone));
  const std::string doubtful =
      doubtful_text(object["bursts"], tone, results.value("trusted_frequency", Json(nullptr)));
  if (!doubtful.empty()) line("doubtful", doubtful);
  fmt::print("results\n");
  for (const auto& [name, value] : object["results"].items()) {
    line("  " + name, value.is_string() ? value.get<std::string>() : value.dump());
  }
  return ExitCode::done;
}

}  // namespace

void add_info_command(CLI::App& program, Action& action) {
  auto options = std::make_shared<InfoOptions>();
  CLI::App* verb = program.add_subcommand("info", "What a run file holds");
  verb->add_option("file", options->file, "Run file (HDF5)")->required();
  add_band_option(*verb, options->band);
  add_json_option(*verb, options->common);
  verb->callback([options, &action] { action = [options] { return info(*options); }; });
}

}  // namespace stridor
