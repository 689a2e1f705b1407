// stridor map: stability of a scene over two of its keys.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <limits>
#include <memory>
#include <thread>

#include "analysis/boundary_continuation.hpp"
#include "app/stability/axis_units.hpp"
#include "app/stability/family_locus.hpp"
#include "app/stability/stability.hpp"
#include "app/stability/verdict.hpp"
#include "app/terminal/progress.hpp"
#include "core/activity.hpp"
#include "core/errors.hpp"
#include "core/memory.hpp"
#include "core/tasks.hpp"
#include "core/version.hpp"
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

struct Axis {
  NumericKey key;
  std::vector<double> values;
  bool is_logarithmic = false;
};

Axis make_axis(const StabilityScene& scene, const std::vector<std::string>& written,
               const char* option, const std::string& scale) {
  Axis axis{scene.find_key(written[0], option), {}, scale == "log"};
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

/// Results along one line of the grid.
struct LineResult {
  std::vector<double> growth;                                ///< at every value, 1/s
  std::vector<double> changes;                               ///< of stability, ascending
  double highest = std::numeric_limits<double>::infinity();  ///< up to where all were looked at, Hz
  Locus resolution;  ///< only its unresolved and unverified, of all parts of the line
};

/// Adds what may have been missed of one locus to that of others.
void add_resolution(Locus& all, const Locus& one) {
  all.unresolved = std::max(all.unresolved, one.unresolved);
  all.unverified.insert(all.unverified.end(), one.unverified.begin(), one.unverified.end());
}

double largest_growth(const std::vector<std::complex<double>>& eigenvalues) {
  double largest = -std::numeric_limits<double>::infinity();
  for (const std::complex<double>& s : eigenvalues) largest = std::max(largest, s.real());
  return largest;
}

std::vector<std::complex<double>> eigenvalues_at(StabilityFamily& family,
                                                 const std::vector<double>& values,
                                                 const LocusOptions& options) {
  const SpectrumMethod how = family.method(values);
  if (how == SpectrumMethod::counted)
    return family.spectra(0, values, options).at(values[0]).eigenvalues;
  const bool is_dense = options.method == LocusMethod::dense || how == SpectrumMethod::sampled;
  const EigenvalueMethod method = is_dense ? EigenvalueMethod::dense : EigenvalueMethod::secular;
  std::vector<std::complex<double>> found;
  for (const Eigenvalue& one :
       lowest_eigenvalues(family.pencil(values), method, {options.count, options.frequency}))
    found.push_back(one.s);
  return found;
}

/// Appends the values at which the stability changes along one line.
void add_changes(LineResult& result, const Axis& axis, const Locus& locus) {
  for (const StabilityChange& change : stability_changes(locus)) {
    double value = change.value;
    if (axis.key.is_integer) {
      const auto after = std::find(axis.values.begin(), axis.values.end(), value);
      value = 0.5 * (*(after - 1) + value);
    }
    if (result.changes.empty() || value > result.changes.back()) result.changes.push_back(value);
  }
}

/// A line on which there is no equilibrium somewhere: what there is at the single values, and the
/// changes between neighbours where there is one.
LineResult trace_broken_line(StabilityFamily& family, const Axis& axis, std::size_t varied,
                             std::vector<double> values, const LocusOptions& options) {
  LineResult result;
  for (const double value : axis.values) {
    values[varied] = value;
    double growth = std::numeric_limits<double>::quiet_NaN();
    try {
      const std::vector<std::complex<double>> found = eigenvalues_at(family, values, options);
      result.highest =
          std::min(result.highest, verdict_limit(found, {options.count, options.frequency},
                                                 family.trusted_frequency(values)));
      growth = largest_growth(found);
    } catch (const NumericalError&) {
    }
    result.growth.push_back(growth);
  }
  const auto is_known = [](double growth) { return !std::isnan(growth); };
  auto begin = std::find_if(result.growth.begin(), result.growth.end(), is_known);
  while (begin != result.growth.end()) {
    const auto end = std::find_if_not(begin, result.growth.end(), is_known);
    const std::vector<double> part(axis.values.begin() + (begin - result.growth.begin()),
                                   axis.values.begin() + (end - result.growth.begin()));
    values[varied] = part.front();
    try {
      if (part.size() > 1) {
        const Locus locus =
            locus_along(family, axis.key, varied, values, part, options, SearchFor::stability);
        add_changes(result, axis, locus);
        add_resolution(result.resolution, locus);
      }
    } catch (const NumericalError&) {
      // Between two values there may be none either.
    }
    begin = std::find_if(end, result.growth.end(), is_known);
  }
  return result;
}

/// @param varied index of the key along the line: 0 for x
LineResult trace_line(StabilityFamily& family, const std::array<Axis, 2>& axes, std::size_t varied,
                      double other, const LocusOptions& options) {
  const Axis& axis = axes[varied];
  std::vector<double> values(2, other);
  values[varied] = axis.values.front();
  try {
    const Locus locus =
        locus_along(family, axis.key, varied, values, axis.values, options, SearchFor::stability);
    LineResult result;
    result.highest =
        verdict_limit(locus, {options.count, options.frequency}, family.trusted_frequency(values));
    for (const auto& eigenvalues : locus.eigenvalues)
      result.growth.push_back(largest_growth(eigenvalues));
    add_changes(result, axis, locus);
    add_resolution(result.resolution, locus);
    return result;
  } catch (const NumericalError&) {
    return trace_broken_line(family, axis, varied, values, options);
  }
}

/// Traces all rows, then all columns. Every line is a task of its own and begins from nothing, so
/// that the results do not depend on which thread takes it.
std::vector<LineResult> trace_lines(const StabilityScene& loaded, const std::array<Axis, 2>& axes,
                                    const StabilityOptions& stability) {
  const std::size_t num_rows = axes[1].values.size();
  const std::size_t num_lines = num_rows + axes[0].values.size();
  // The dense method lives in LAPACK, which two threads must not enter at once (core/tasks.hpp).
  const bool is_dense = stability.locus_options().method == LocusMethod::dense;
  const int num_threads = is_dense || loaded.needs_one_thread() ? 1 : stability.common.threads;
  std::vector<std::unique_ptr<StabilityFamily>> families(
      static_cast<std::size_t>(std::max(num_threads, 1)));
  std::vector<LineResult> results(num_lines);
  const auto trace = [&](std::size_t line, std::size_t thread) {
    std::unique_ptr<StabilityFamily>& family = families[thread];
    if (!family) family = loaded.family({axes[0].key, axes[1].key}, stability.geometry());
    const bool is_row = line < num_rows;
    results[line] = trace_line(*family, axes, is_row ? 0 : 1,
                               is_row ? axes[1].values[line] : axes[0].values[line - num_rows],
                               stability.locus_options());
  };
  Progress progress("map");
  run_tasks(num_lines, num_threads, trace, [&](std::size_t num_done, std::size_t) {
    progress.report(static_cast<double>(num_done) / static_cast<double>(num_lines),
                    fmt::format("line {} of {}", num_done, num_lines));
  });
  progress.finish();
  return results;
}

/// @param resolution what may have been missed along x and along y
StabilityMap make_map(const StabilityScene& loaded, const std::array<Axis, 2>& axes,
                      const StabilityOptions& stability, std::array<Locus, 2>& resolution) {
  StabilityMap map;
  map.x = axes[0].values;
  map.y = axes[1].values;
  const auto make_field = [&] { return loaded.growth_field({axes[0].key, axes[1].key}); };
  if (make_field() != nullptr) {
    const Activity tracing("growth at every point, then the boundary");
    GrowthMap found = make_growth_map(make_field, map.x, map.y, stability.common.threads);
    map.growth = std::move(found.growth);
    // Between the lines of the grid, on which it is known, the boundary is followed.
    const auto field = make_field();
    const auto spacing = [](const Axis& axis) {
      return axis.is_logarithmic ? GridSpacing::logarithmic : GridSpacing::linear;
    };
    map.boundary =
        trace_boundary([&](double x, double y) { return field->margin(x, y); },
                       {map.x, map.y, {spacing(axes[0]), spacing(axes[1])}}, found.boundary);
    return map;
  }
  const std::vector<LineResult> lines = trace_lines(loaded, axes, stability);
  GridCrossings crossings{map.x, map.y, {}, {}};
  for (std::size_t i = 0; i < lines.size(); ++i) {
    const bool is_row = i < map.y.size();
    if (is_row) map.growth.push_back(lines[i].growth);
    map.highest_frequency = std::min(map.highest_frequency, lines[i].highest);
    add_resolution(resolution[is_row ? 0 : 1], lines[i].resolution);
    (is_row ? crossings.along_x : crossings.along_y).push_back(lines[i].changes);
  }
  map.boundary = boundary_lines(crossings);
  return map;
}

void draw(const MapOptions& options, const std::array<Axis, 2>& axes, const StabilityMap& map,
          const StabilityScene& loaded) {
  StabilityMapPicture picture;
  const SceneNode* tree = &loaded.loaded().tree;
  const AxisUnit x_unit = axis_unit(axes[0].key, {options.x[1], options.x[2]}, tree);
  const AxisUnit y_unit = axis_unit(axes[1].key, {options.y[1], options.y[2]}, tree);
  const auto axis_of = [](const Axis& axis, const AxisUnit& unit) {
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
      "Largest growth rate of the {} lowest eigenvalues{}, {} by {} values; line: boundary of "
      "stability. {}, scene {}.",
      options.stability.count, loaded.about_text(options.stability), map.x.size(), map.y.size(),
      std::filesystem::path(options.stability.scene).filename().string(), loaded.loaded().hash());
  plot_stability_map(picture, *options.figure);
}

/// The map found, and what its outputs share.
struct FoundMap {
  const MapOptions& options;
  const StabilityScene& scene;
  const std::array<Axis, 2>& axes;
  StabilityMap map;
  std::array<Locus, 2> resolution;
};

/// @throws ConfigError if the numbers of so many points do not fit into memory
void check_size(const std::array<Axis, 2>& axes) {
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

/// The command that gives the eigenvalues of one point of a map, with @X@ and @Y@ for its values.
std::string point_command(const FoundMap& found) {
  const StabilityOptions& stability = found.options.stability;
  std::string command = fmt::format("stridor eig {} --about {} --method {}",
                                    shell_word(stability.scene), stability.about, stability.method);
  if (stability.count_option != nullptr && stability.count_option->count() > 0)
    command += fmt::format(" --count {}", stability.count);
  if (stability.below) command += " --below " + shell_word(*stability.below);
  for (const std::string& set : stability.common.sets) command += " --set " + shell_word(set);
  return command +
         fmt::format(" --set {}=@X@ --set {}=@Y@", found.axes[0].key.path, found.axes[1].key.path);
}

void write_map(const FoundMap& found) {
  const StabilityOptions& stability = found.options.stability;
  write_map_file(*found.options.output, stability.common.overwrite(), found.map,
                 printed_units(found.axes[0].key), printed_units(found.axes[1].key),
                 {{"x", found.axes[0].key.path},
                  {"y", found.axes[1].key.path},
                  {"about", stability.about},
                  {"method", stability.method},
                  {"scene", stability.scene},
                  {"point_command", point_command(found)},
                  {"scene_hash", found.scene.loaded().hash()},
                  {"scene_resolved", found.scene.loaded().resolved()},
                  {"command", found.options.command_line},
                  {"version", std::string(version)},
                  {"commit", std::string(commit)},
                  {"date", utc_now()}});
}

Json map_json(const FoundMap& found) {
  const StabilityOptions& stability = found.options.stability;
  Json object = {{"x_parameter", found.axes[0].key.path},
                 {"y_parameter", found.axes[1].key.path},
                 {"about", stability.about},
                 {"method", stability.method},
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
  return object;
}

void print_map(const FoundMap& found) {
  std::size_t num_unstable = 0;
  for (const auto& row : found.map.growth)
    num_unstable += static_cast<std::size_t>(
        std::count_if(row.begin(), row.end(), [](double growth) { return growth > 0.0; }));
  fmt::print("{} of {} points are unstable; the boundary has {} line(s)\n", num_unstable,
             found.map.x.size() * found.map.y.size(), found.map.boundary.size());
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
  const std::array<Axis, 2> axes{
      make_axis(loaded, options.x, "--x", options.x_scale.value_or(options.scale)),
      make_axis(loaded, options.y, "--y", options.y_scale.value_or(options.scale))};
  if (axes[0].key.path == axes[1].key.path)
    throw ConfigError(Refusal::doubled_name, "--y",
                      fmt::format("'{}' is the key of --x already", axes[1].key.path));
  check_size(axes);
  FoundMap found{options, loaded, axes, {}, {}};
  found.map = make_map(loaded, axes, stability, found.resolution);
  if (options.output) write_map(found);
  if (options.figure) draw(options, axes, found.map, loaded);
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
