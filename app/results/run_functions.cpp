#include "app/results/run_functions.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cstddef>
#include <exception>
#include <filesystem>
#include <functional>
#include <optional>

#include "core/activity.hpp"
#include "core/errors.hpp"
#include "core/stop_token.hpp"

namespace stridor {
namespace {

/// The point and direction of "/channels/<body>.<point>.<x|y|z>.<motion>"; nothing of other series.
std::optional<std::pair<std::string, int>> point_of_series(const std::string& series) {
  const std::string name = channel_name(series);
  const auto [place, motion] = split_name(name);
  if (motion != "displacement" && motion != "velocity" && motion != "acceleration")
    return std::nullopt;
  if (place.size() < 3 || place[place.size() - 2] != '.') return std::nullopt;
  const std::size_t direction = std::string("xyz").find(place.back());
  if (direction == std::string::npos) return std::nullopt;
  return std::pair(place.substr(0, place.size() - 2), static_cast<int>(direction));
}

/// A function of a series without its numbers.
UffFunction described(const RecordedStretch& run, const std::string& series, PointNodes& points) {
  UffFunction function;
  function.id = channel_name(series);
  function.note = filter_note(run.file, series);
  function.units = run.file.units(series);
  function.ordinate_quantity = static_cast<int>(quantity_in(function.units));
  if (const auto point = point_of_series(series))
    function.response = points.dof(point->first, point->second);
  return function;
}

/// The places of points where the scene of the run has them; its files may be gone.
std::vector<UffNode> places_in_run(const RecordedStretch& run, const PointNodes& points,
                                   std::string& remark) {
  const std::string source = run.path + ":/scene/resolved";
  try {
    return points.placed(load_resolved_scene(run.file.header().scene_resolved, source));
  } catch (const Interrupted&) {
    throw;
  } catch (const std::exception& error) {  // places are no reason to lose the numbers
    remark = error.what();
  }
  remark = "places of points are not in the file (2411): " + remark.substr(0, remark.find('\n'));
  return {};
}

/// @param filled gives a function of a series its numbers
WrittenFunctions write_functions(const std::string& file, const RecordedStretch& run,
                                 const std::vector<std::string>& series, const char* what,
                                 const std::function<void(std::size_t, UffFunction&)>& filled,
                                 const UniversalOptions& options) {
  PointNodes points;
  for (const std::string& one : series) described(run, one, points);
  WrittenFunctions written{series.size(), ""};
  UffContents contents = headed_contents(
      fmt::format("{} of {}", what, std::filesystem::path(run.path).filename().string()));
  contents.nodes = places_in_run(run, points, written.remark);
  Activity writing("writing the functions");
  write_text_file(file, [&](const TextSink& sink) {
    write_uff(contents, "--data", sink);
    for (std::size_t i = 0; i < series.size(); ++i) {
      throw_if_stopped();
      UffFunction function = described(run, series[i], points);
      filled(i, function);
      write_uff_function(function, i + 1, contents, "--data", sink, options.numbers());
      writing.report(static_cast<double>(i + 1) / static_cast<double>(series.size()));
    }
  });
  return written;
}

}  // namespace

WrittenFunctions write_history_functions(const std::string& file, const RecordedStretch& run,
                                         const std::vector<std::string>& series,
                                         const UniversalOptions& options) {
  const std::vector<double> times = run.times();
  const auto fill = [&](std::size_t i, UffFunction& function) {
    function.type = static_cast<int>(UffFunctionType::time_response);
    function.abscissa_quantity = static_cast<int>(UffQuantity::time);
    function.abscissa = times;
    const std::vector<double> values = run.finite_values(series[i]);
    function.values.assign(values.begin(), values.end());
  };
  return write_functions(file, run, series, "histories", fill, options);
}

WrittenFunctions write_spectrum_functions(
    const std::string& file, const RecordedStretch& run,
    const std::vector<std::pair<std::string, Spectrum>>& spectra, const WrittenSpectra& how,
    const UniversalOptions& options) {
  const SpectrogramParameters& parameters = how.parameters;
  std::vector<std::string> series;
  for (const auto& entry : spectra) series.push_back(entry.first);
  const auto fill = [&](std::size_t i, UffFunction& function) {
    const Spectrum& spectrum = spectra[i].second;
    function.type = static_cast<int>(UffFunctionType::spectrum);
    function.note = fmt::format(
        "peak amplitudes, r.m.s. of {} pieces of {} samples, {}, overlap {:g}", spectrum.num_pieces,
        parameters.length, window_name(parameters.window), parameters.overlap);
    function.abscissa_quantity = static_cast<int>(UffQuantity::frequency);
    const auto end = std::upper_bound(spectrum.frequencies.begin(), spectrum.frequencies.end(),
                                      how.max_frequency);
    function.abscissa.assign(spectrum.frequencies.begin(), end);
    const auto count = static_cast<std::ptrdiff_t>(function.abscissa.size());
    function.values.assign(spectrum.amplitude.begin(), spectrum.amplitude.begin() + count);
  };
  return write_functions(file, run, series, "spectra", fill, options);
}

}  // namespace stridor
