// stridor map: stability of a scene over two of its keys.
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <filesystem>
#include <thread>

#include "app/results/file_attributes.hpp"
#include "app/stability/axis_units.hpp"
#include "app/stability/map_study.hpp"
#include "app/stability/stability.hpp"
#include "app/stability/verdict.hpp"
#include "core/errors.hpp"
#include "core/memory.hpp"
#include "io/figures/gnuplot.hpp"
#include "io/figures/stability_map_plot.hpp"
#include "io/results/locus_file.hpp"
#include "models/set_up_estimate.hpp"

namespace stridor {
namespace {

struct MapOptions {
  StabilityOptions stability;
  std::vector<std::string> x;  ///< key, first value, last value, number of values
  std::vector<std::string> y;
  std::string scale = "linear";
  std::optional<std::string> x_scale;
  std::optional<std::string> y_scale;
  std::optional<std::string> output;
  std::optional<std::string> figure;
  std::string command_line;
};

KeyAxis make_axis(const StabilityScene& scene, const std::vector<std::string>& written,
                  const char* option, const std::string& scale) {
  KeyAxis axis{scene.find_key(written[0], option), {}, scale == "log"};
  const double from = parse_value(axis.key, written[1], option);
  const double to = parse_value(axis.key, written[2], option);
  if (!(from < to)) {
    throw ConfigError(Refusal::wrong_value, option,
                      fmt::format("'{}' must be less than '{}'", written[1], written[2]));
  }
  const NumericKey number{option, "", Range::between(2, 100000), true};
  axis.values =
      spaced_values(axis.key, from, to, static_cast<int>(parse_value(number, written[3], option)),
                    axis.is_logarithmic ? Spacing::logarithmic : Spacing::linear);
  return axis;
}

/// @param which eigenvalues the growth is of, as " of the 20 lowest eigenvalues"
void draw(const MapOptions& options, const std::array<KeyAxis, 2>& axes, const StabilityMap& map,
          const StabilityScene& loaded, const std::string& which) {
  StabilityMapPicture picture;
  const SceneNode* tree = &loaded.loaded().tree;
  const AxisUnit x_unit = axis_unit(axes[0].key, {options.x[1], options.x[2]}, tree);
  const AxisUnit y_unit = axis_unit(axes[1].key, {options.y[1], options.y[2]}, tree);
  const auto axis_of = [](const KeyAxis& axis, const AxisUnit& unit) {
    return MapAxis{axis.key.path, unit.name, unit.numbers(axis.values), axis.is_logarithmic};
  };
  picture.x = axis_of(axes[0], x_unit);
  picture.y = axis_of(axes[1], y_unit);
  picture.growth = map.growth;
  for (const BoundaryLine& line : map.boundary) {
    picture.boundary.emplace_back();
    for (const auto& point : line)
      picture.boundary.back().push_back({x_unit.number(point[0]), y_unit.number(point[1])});
  }
  picture.caption = fmt::format(
      "Largest growth rate{}{}, {} by {} values; line: boundary of stability. {}, scene {}.", which,
      loaded.about_text(options.stability), map.x.size(), map.y.size(),
      std::filesystem::path(options.stability.scene).filename().string(), loaded.loaded().hash());
  plot_stability_map(picture, *options.figure);
}

/// The map found, and what its outputs share.
struct FoundMap {
  const MapOptions& options;
  const StabilityScene& scene;
  const std::array<KeyAxis, 2>& axes;
  StabilityMap map;
  std::array<Locus, 2> resolution;
};

/// @throws ConfigError if the numbers of so many points do not fit into memory
void check_size(const std::array<KeyAxis, 2>& axes) {
  constexpr double bytes_per_point = 125.0;  // measured, with JSON
  require_memory_for(
      {"--x",
       fmt::format("a map of {} times {} points", axes[0].values.size(), axes[1].values.size()),
       "ask for fewer points along x or y",
       bytes_per_point * static_cast<double>(axes[0].values.size()) *
           static_cast<double>(axes[1].values.size())},
      memory_limit());
}

/// A word of a command as a shell takes it.
std::string shell_word(const std::string& word) {
  constexpr const char* plain =
      "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789_./=:,+-@";
  if (!word.empty() && word.find_first_not_of(plain) == std::string::npos) return word;
  std::string quoted = "'";
  for (const char c : word) quoted += c == '\'' ? "'\\''" : std::string(1, c);
  return quoted + "'";
}

/// Whether growth has a formula, of all eigenvalues at once.
bool is_by_formula(const FoundMap& found) {
  return found.resolution[0].method == growth_formula;
}

/// The command that gives the eigenvalues of one point of a map, with @X@ and @Y@ for its values.
std::string point_command(const FoundMap& found) {
  const StabilityOptions& stability = found.options.stability;
  std::string command = fmt::format("stridor eig {} --about {} --method {}",
                                    shell_word(stability.scene), stability.about, stability.method);
  if (stability.count && !is_by_formula(found))
    command += fmt::format(" --count {}", *stability.count);
  if (stability.below && !is_by_formula(found))
    command += " --below " + shell_word(*stability.below);
  for (const std::string& set : stability.common.sets) command += " --set " + shell_word(set);
  return command +
         fmt::format(" --set {}=@X@ --set {}=@Y@", found.axes[0].key.path, found.axes[1].key.path);
}

/// That taken along the lines, or growth_formula; that asked for where every point failed.
const std::string& method_of(const FoundMap& found) {
  const std::string& taken = found.resolution[0].method;
  return taken.empty() ? found.options.stability.method : taken;
}

void write_map(const FoundMap& found) {
  const StabilityOptions& stability = found.options.stability;
  Attributes attributes = source_attributes(found.scene.loaded(), found.options.command_line);
  for (const auto& [name, text] : {std::pair{"x", found.axes[0].key.path},
                                   {"y", found.axes[1].key.path},
                                   {"about", stability.about},
                                   {"method", method_of(found)},
                                   {"point_command", point_command(found)}})
    attributes.emplace_back(name, text);
  write_map_file(*found.options.output, stability.common.overwrite(), found.map,
                 printed_units(found.axes[0].key), printed_units(found.axes[1].key), attributes);
}

Json map_json(const FoundMap& found) {
  const StabilityOptions& stability = found.options.stability;
  Json object = {{"x_parameter", found.axes[0].key.path},
                 {"y_parameter", found.axes[1].key.path},
                 {"about", stability.about},
                 {"method", method_of(found)},
                 {"x", found.map.x},
                 {"y", found.map.y},
                 {"window", {0.0, number(found.map.highest_frequency)}},
                 {"growth", Json::array()},
                 {"boundary", found.map.boundary},
                 {"unresolved", {found.resolution[0].unresolved, found.resolution[1].unresolved}},
                 {"unverified", {found.resolution[0].unverified, found.resolution[1].unverified}}};
  for (const auto& row : found.map.growth) {
    Json numbers = Json::array();
    for (const double value : row) numbers.push_back(number(value));
    object["growth"].push_back(std::move(numbers));
  }
  object["failure"] = found.map.failure;
  object["failures"] = Json::array();
  for (const FailedPoints& one : failed_points(found.map))
    object["failures"].push_back(
        {{"number", one.number}, {"points", one.num_points}, {"reason", one.reason}});
  return object;
}

/// Why points have no growth rate, what most of them share first.
void print_failures(const StabilityMap& map) {
  constexpr std::size_t most_lines = 5;
  const std::vector<FailedPoints> all = failed_points(map);
  std::size_t num_points = 0;
  for (const FailedPoints& one : all) num_points += one.num_points;
  if (all.empty()) return;
  fmt::print("{} of {} points failed:\n", num_points, map.x.size() * map.y.size());
  for (std::size_t i = 0; i < std::min(most_lines, all.size()); ++i)
    fmt::print("  {:>6}  {}\n", all[i].num_points, all[i].reason);
  if (all.size() > most_lines)
    fmt::print("  and {} other reasons (-o FILE.h5 keeps all, in /failures)\n",
               all.size() - most_lines);
}

void print_map(const FoundMap& found) {
  std::size_t num_unstable = 0;
  for (const auto& row : found.map.growth)
    num_unstable += static_cast<std::size_t>(
        std::count_if(row.begin(), row.end(), [](double growth) { return growth > 0.0; }));
  fmt::print("{} of {} points are unstable; the boundary has {} line(s)\n", num_unstable,
             found.map.x.size() * found.map.y.size(), found.map.boundary.size());
  print_failures(found.map);
  fmt::print("{}\n", window_text(found.map.highest_frequency));
  for (std::size_t i = 0; i < 2; ++i) print_resolution(found.resolution[i], found.axes[i].key);
  for (const auto& file : {found.options.output, found.options.figure})
    if (file) fmt::print("{}\n", *file);
}

ExitCode map(MapOptions options) {
  StabilityOptions& stability = options.stability;
  if (options.output) check_output(*options.output, stability.common.overwrite());
  if (options.figure) check_figure(*options.figure, stability.common);
  const StabilityScene loaded = load_stability_scene(stability);
  const std::array<KeyAxis, 2> axes{
      make_axis(loaded, options.x, "--x", options.x_scale.value_or(options.scale)),
      make_axis(loaded, options.y, "--y", options.y_scale.value_or(options.scale))};
  if (axes[0].key.path == axes[1].key.path)
    throw ConfigError(Refusal::doubled_name, "--y",
                      fmt::format("'{}' is the key of --x already", axes[1].key.path));
  check_size(axes);
  FoundMap found{options, loaded, axes, {}, {}};
  found.map = make_stability_map(loaded, axes, stability, found.resolution);
  if (options.output) write_map(found);
  if (options.figure)
    draw(options, axes, found.map, loaded,
         is_by_formula(found) ? "" : " of the " + stability.window_words());
  if (stability.common.json) {
    print_json(map_json(found));
  } else {
    print_map(found);
  }
  return ExitCode::done;
}

}  // namespace

void add_map_command(CLI::App& program, Action& action, const std::string& command_line) {
  auto options = std::make_shared<MapOptions>();
  options->command_line = command_line;
  options->stability.common.threads =
      std::max(1, static_cast<int>(std::thread::hardware_concurrency()));
  CLI::App* verb = program.add_subcommand("map", "Stability of a scene over two of its keys");
  add_stability_options(*verb, options->stability);
  const auto add_axis = [&](const char* name, std::vector<std::string>& axis, const char* says) {
    verb->add_option(name, axis, says)->required()->expected(4)->type_name("KEY FROM TO POINTS");
  };
  add_axis("--x", options->x, "Key along x, its first and last value, and how many");
  add_axis("--y", options->y, "Key along y, likewise");
  const CLI::IsMember scales({"linear", "log"});
  verb->add_option("--scale", options->scale, "Spacing of the values: linear (default) or log")
      ->check(scales);
  verb->add_option("--x-scale", options->x_scale, "The same along x only")->check(scales);
  verb->add_option("--y-scale", options->y_scale, "The same along y only")->check(scales);
  verb->add_option("-o,--output", options->output, "File to write (HDF5)");
  verb->add_option("--figure", options->figure, "Picture to draw: .png, .svg or .pdf");
  add_force_option(*verb, options->stability.common);
  verb->callback([options, &action] { action = [options] { return map(*options); }; });
}

}  // namespace stridor
