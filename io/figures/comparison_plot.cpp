#include "io/figures/comparison_plot.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <tuple>

#include "io/figures/axes.hpp"
#include "io/figures/history_plot.hpp"
#include "io/figures/run_panels.hpp"
#include "io/figures/spectrogram_plot.hpp"
#include "io/run_file/run_summary.hpp"

namespace stridor {
namespace {

/// A series of one run as a curve; empty where the run has no such series.
Curve curve_of(const RunFileReader& file, const std::string& series, const std::string& name) {
  if (!file.has(series)) return {{}, {}, name};
  return {file.times(), file.series(series), name};
}

/// The rows from `start` on: the start-up would set the scale.
IndexRange rows_from(double start, const RunFileReader& file) {
  const std::vector<double>& times = file.times();
  const auto first = std::lower_bound(times.begin(), times.end(), start);
  return {static_cast<std::size_t>(std::distance(times.begin(), first)), times.size()};
}

/// a − b at the times that both have.
Curve difference(const Curve& a, const Curve& b) {
  Curve result;
  const std::size_t size = std::min(a.times.size(), b.times.size());
  for (std::size_t i = 0; i < size; ++i) {
    result.times.push_back(a.times[i]);
    result.values.push_back(a.values[i] - b.values[i]);
  }
  return result;
}

/// Every run over the reference, which may hide it or be hidden by it, and below that the
/// difference of the two.
std::vector<Panel> over_reference(const std::vector<ComparisonRun>& runs,
                                  const std::vector<RunFileReader>& files,
                                  const std::string& series) {
  const std::string units = typeset_units(files.back().units(series));
  const std::string note = filter_note(files.back(), series);
  const std::string filtered = note.empty() ? "" : " (" + note + ")";
  const ComparisonRun& reference = runs.back();
  const Curve expected = curve_of(files.back(), series, reference.title);
  std::vector<Panel> panels;
  for (std::size_t i = 0; i + 1 < runs.size(); ++i) {
    const Curve curve = curve_of(files[i], series, runs[i].title);
    panels.push_back({runs[i].title + " over " + reference.title + filtered,
                      "acceleration",
                      units,
                      {expected, curve}});
    panels.push_back({runs[i].title + " minus " + reference.title,
                      "difference",
                      units,
                      {difference(curve, expected)}});
  }
  if (panels.empty())
    panels.push_back({reference.title + filtered,
                      "acceleration",
                      units,
                      {{expected.times, expected.values, ""}}});
  return panels;
}

/// Spectrograms of one series of all runs; a run that ended before a piece was full has none.
void draw_spectrograms(const std::vector<ComparisonRun>& runs,
                       const std::vector<RunFileReader>& files, const std::string& series,
                       const Scene& scene, const std::filesystem::path& figure) {
  const double interval = scene.record->interval;
  SpectrogramPicture picture;
  picture.units = files.back().units(series);
  picture.reference = standard_reference(picture.units);
  picture.max_frequency = scene.measure.band.size() == 2 ? scene.measure.band[1] : 0.4 / interval;
  SpectrogramParameters parameters;
  const double whole = files.back().times().back();
  parameters.length = std::max<std::size_t>(
      16,
      static_cast<std::size_t>(std::lround(std::sqrt(whole / picture.max_frequency) / interval)));
  picture.mean_lines = main_lobe_lines(parameters.window);
  std::vector<Spectrogram> spectrograms;
  spectrograms.reserve(runs.size());
  std::vector<SpectrogramPanel> panels;
  for (std::size_t i = 0; i < runs.size(); ++i) {
    if (!files[i].has(series) || files[i].times().size() < parameters.length) continue;
    spectrograms.push_back(make_spectrogram(files[i].series(series), interval, parameters));
    panels.push_back({runs[i].title, &spectrograms.back(), {}});
  }
  if (!panels.empty()) plot_spectrograms(panels, picture, figure);
}

}  // namespace

std::vector<std::filesystem::path> plot_comparison(const std::vector<ComparisonRun>& runs,
                                                   const std::filesystem::path& folder,
                                                   const Scene& scene) {
  std::vector<RunFileReader> files;
  files.reserve(runs.size());
  for (const ComparisonRun& run : runs) files.emplace_back(run.file);
  std::vector<std::filesystem::path> figures;

  if (const auto acceleration = acceleration_channel(files.back())) {
    figures.push_back(folder / "accelerations.png");
    plot_histories(over_reference(runs, files, *acceleration), figures.back(),
                   acceleration->substr(acceleration->rfind('/') + 1));
  }

  const std::string pair = scene.model.pairs().begin()->first;
  for (const auto& [quantity, label, name] :
       {std::tuple{"slip_velocity", "sliding velocity", "sliding_velocities.png"},
        std::tuple{"force", "contact force", "contact_forces.png"}}) {
    const std::string series = "/contact/" + pair + "/" + quantity;
    std::vector<Panel> panels;
    std::vector<std::string> missing;
    for (std::size_t i = 0; i < runs.size(); ++i) {
      if (!files[i].has(series)) continue;
      const IndexRange rows = rows_from(scene.measure.from, files[i]);
      if (rows.begin == rows.end) {
        missing.push_back(runs[i].title);
        continue;
      }
      panels.push_back(panel_of(files[i], series, rows));
      panels.back().title.replace(0, pair.size(), runs[i].title);
      panels.back().label = label;
    }
    if (panels.empty()) continue;
    figures.push_back(folder / name);
    const std::string note = missing.empty()
                                 ? ""
                                 : fmt::format("Without {}: ended before measure.from, {:g} s.",
                                               fmt::join(missing, ", "), scene.measure.from);
    plot_histories(panels, figures.back(), pair, note);
  }
  if (const auto acceleration = acceleration_channel(files.back())) {
    figures.push_back(folder / "spectrograms.png");
    draw_spectrograms(runs, files, *acceleration, scene, figures.back());
  }
  return figures;
}

}  // namespace stridor
