#include "io/comparison_plot.hpp"

#include <algorithm>
#include <cmath>
#include <tuple>

#include "io/axes.hpp"
#include "io/history_plot.hpp"
#include "io/run_summary.hpp"
#include "io/spectrogram_plot.hpp"

namespace stridor {
namespace {

/// A series of one run as a curve; empty where the run has no such series.
Curve curve_of(const RunFileReader& file, const std::string& series, const std::string& name) {
  if (!file.has(series)) return {{}, {}, name};
  return {file.times(), file.series(series), name};
}

/// What lies before `start` dropped: the start-up would set the scale.
Curve from(double start, Curve curve) {
  const auto first = std::lower_bound(curve.times.begin(), curve.times.end(), start);
  const auto dropped = std::distance(curve.times.begin(), first);
  curve.times.erase(curve.times.begin(), first);
  curve.values.erase(curve.values.begin(), curve.values.begin() + dropped);
  return curve;
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
  const ComparisonRun& reference = runs.back();
  std::vector<std::filesystem::path> figures;

  if (const auto acceleration = acceleration_channel(files.back())) {
    const std::string units = files.back().units(*acceleration);
    std::vector<Panel> panels;
    for (std::size_t i = 0; i + 1 < runs.size(); ++i) {
      panels.push_back({runs[i].title + " over " + reference.title,
                        "acceleration",
                        units,
                        {curve_of(files.back(), *acceleration, reference.title),
                         curve_of(files[i], *acceleration, runs[i].title)}});
    }
    if (panels.empty())
      panels.push_back(
          {reference.title, "acceleration", units, {curve_of(files.back(), *acceleration, "")}});
    figures.push_back(folder / "accelerations.png");
    plot_histories(panels, figures.back(), acceleration->substr(acceleration->rfind('/') + 1));
  }

  const std::string pair = scene.model.pairs().begin()->first;
  for (const auto& [quantity, label, name] :
       {std::tuple{"slip_velocity", "sliding velocity", "sliding_velocities.png"},
        std::tuple{"force", "contact force", "contact_forces.png"}}) {
    const std::string series = "/contact/" + pair + "/" + quantity;
    std::vector<Panel> panels;
    for (std::size_t i = 0; i < runs.size(); ++i) {
      if (!files[i].has(series)) continue;
      panels.push_back({runs[i].title,
                        label,
                        files[i].units(series),
                        {from(scene.measure.from, curve_of(files[i], series, ""))}});
    }
    if (panels.empty()) continue;
    figures.push_back(folder / name);
    plot_histories(panels, figures.back(), pair);
  }
  if (const auto acceleration = acceleration_channel(files.back())) {
    figures.push_back(folder / "spectrograms.png");
    draw_spectrograms(runs, files, *acceleration, scene, figures.back());
  }
  return figures;
}

}  // namespace stridor
