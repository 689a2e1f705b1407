#include "io/comparison_plot.hpp"

#include <algorithm>
#include <tuple>

#include "io/history_plot.hpp"
#include "io/run_summary.hpp"

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

}  // namespace

std::vector<std::filesystem::path> plot_comparison(const std::vector<ComparisonRun>& runs,
                                                   const std::filesystem::path& folder,
                                                   const Scene& scene) {
  std::vector<RunFileReader> files;
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
  return figures;
}

}  // namespace stridor
