#include "analysis/locus.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <numbers>
#include <optional>
#include <stdexcept>
#include <utility>

#include "analysis/window_finder.hpp"
#include "core/activity.hpp"

namespace stridor {
namespace {

/// Im s of a branch, by its samples; nothing outside them.
std::optional<double> height_at(const Branch& branch, double value) {
  if (value < branch.values.front() || value > branch.values.back()) return std::nullopt;
  const auto upper = std::upper_bound(branch.values.begin(), branch.values.end(), value);
  if (upper == branch.values.end()) return branch.s.back().imag();
  const auto i = static_cast<std::size_t>(upper - branch.values.begin());
  const double fraction =
      (value - branch.values[i - 1]) / (branch.values[i] - branch.values[i - 1]);
  return (1.0 - fraction) * branch.s[i - 1].imag() + fraction * branch.s[i].imag();
}

/// Drops the results of eigenvalues that were not asked for.
void keep_wanted(Locus& locus, const LocusOptions& options) {
  const auto is_wanted = [&](const UnstableWindow& window) {
    if (window.frequency > options.window.frequency) return false;
    int below = 0;
    for (std::size_t b = 0; b < locus.branches.size(); ++b) {
      if (static_cast<int>(b) == window.branch) continue;
      const auto height = height_at(locus.branches[b], window.value_max);
      if (height && *height > 0.0 && *height < 2.0 * std::numbers::pi * window.frequency) ++below;
    }
    return !options.window.count || below < *options.window.count;
  };
  std::erase_if(locus.unstable, [&](const UnstableWindow& window) { return !is_wanted(window); });
  std::erase_if(locus.crossings, [&](const Crossing& crossing) {
    return std::none_of(locus.unstable.begin(), locus.unstable.end(), [&](const auto& window) {
      return window.branch == crossing.branch &&
             (window.from == crossing.value || window.to == crossing.value);
    });
  });
}

void check(const PencilFamily& family, const std::vector<double>& values,
           const LocusOptions& options) {
  const auto reject = [](const std::string& message) {
    throw std::invalid_argument("locus: " + message);
  };
  if (!family.place) reject("there is no family");
  if (values.empty()) reject("there are no values");
  for (std::size_t i = 0; i < values.size(); ++i) {
    if (!std::isfinite(values[i]) || (i > 0 && values[i] <= values[i - 1])) {
      reject(fmt::format("the values must ascend, but value {} is {:g}", i + 1, values[i]));
    }
  }
  if (!std::is_sorted(family.kinks.begin(), family.kinks.end())) reject("the kinks must ascend");
  check_window(options);
  if (!(options.resolution > 0.0)) {
    reject(fmt::format("the resolution must be positive, is {:g}", options.resolution));
  }
}

}  // namespace

void check_window(const LocusOptions& options) {
  if (options.window.count && *options.window.count < 1) {
    throw std::invalid_argument(
        fmt::format("locus: {} eigenvalues are none", *options.window.count));
  }
  if (!(options.window.frequency > 0.0)) {
    throw std::invalid_argument(
        fmt::format("locus: no eigenvalues below {:g} Hz", options.window.frequency));
  }
}

std::vector<double> kinks_along_drive(const System& system) {
  std::vector<double> kinks;
  for (const ContactPoint& contact : system.contacts) {
    if (contact.has_two_tangents()) continue;  // no place along a curve
    const MasterSurface& surface = system.surfaces[static_cast<std::size_t>(contact.surface)];
    const double share = system.path_share(contact);
    for (int i = 0; share != 0.0 && i + 1 < surface.num_segments(); ++i) {
      const Segment segment = surface.undeformed_segment(i);
      const Eigen::Vector2d along = segment.second - segment.first;
      if (along.x() == 0.0) continue;
      kinks.push_back(along.dot(segment.second - contact.slave_position) / (along.x() * share));
    }
  }
  std::sort(kinks.begin(), kinks.end());
  return kinks;
}

PencilFamily undeformed_family(const System& system, double friction, double direction,
                               double origin) {
  PencilFamily family;
  family.place = [&system, friction, direction, origin](double value, Pencil& pencil) {
    if (pencil.num_modes() == 0) pencil = make_modal_pencil(system);
    place_undeformed(pencil, system, value - origin, friction, direction);
  };
  family.kinks = kinks_along_drive(system);
  for (double& kink : family.kinks) kink += origin;
  return family;
}

Locus trace_locus(const PencilFamily& family, const std::vector<double>& values,
                  const LocusOptions& options) {
  check(family, values, options);
  Locus locus;
  locus.values = values;
  const std::unique_ptr<SpectrumSource> source =
      make_spectrum_source(family, values.front(), options);
  const Grid grid = make_grid(values, family.kinks);
  std::vector<Track> tracks = follow_branches(*source, options, grid, locus);
  for (std::size_t b = 0; b < tracks.size(); ++b) {
    Activity refining(fmt::format("branch {} of {}", b + 1, tracks.size()));
    refining.report(static_cast<double>(b) / static_cast<double>(tracks.size()));
    find_windows(*source, options, grid, tracks[b], static_cast<int>(b), locus);
    locus.branches.push_back(std::move(tracks[b].branch));
  }
  keep_wanted(locus, options);
  std::sort(locus.unstable.begin(), locus.unstable.end(),
            [](const auto& a, const auto& b) { return a.from < b.from; });
  std::sort(locus.crossings.begin(), locus.crossings.end(),
            [](const auto& a, const auto& b) { return a.value < b.value; });
  return locus;
}

}  // namespace stridor
