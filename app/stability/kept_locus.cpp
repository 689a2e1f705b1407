#include "app/stability/kept_locus.hpp"

#include <cmath>
#include <optional>
#include <utility>

#include "app/results/file_attributes.hpp"
#include "app/stability/passing_times.hpp"
#include "app/stability/verdict.hpp"

namespace stridor {

std::vector<TimedWindow> timed_windows(const Locus& locus, const NumericKey& key,
                                       const StabilityScene& scene, StabilityFamily& family) {
  std::optional<PassingTimes> times;
  const bool is_path = key.path == drive_displacement_name || scene.default_key() == key.path;
  if (scene.loaded().scene.time && is_path)
    times.emplace(scene.loaded().scene, dynamic_cast<BodyStabilityFamily&>(family));
  return timed_windows(locus, times);
}

void write_locus(const std::string& path, const Locus& locus,
                 const std::vector<TimedWindow>& windows, const LocusSource& source) {
  const std::string units = printed_units(source.key);
  Attributes attributes = source_attributes(source.scene.loaded(), source.command_line);
  for (const auto& [name, text] : {std::pair{"parameter", source.key.path},
                                   {"units", units},
                                   {"about", source.options.about},
                                   {"method", locus.method}})
    attributes.emplace_back(name, text);
  const double highest = verdict_limit(locus, source.options.window(), source.trusted);
  for (const auto& [name, value] :
       {std::pair{"highest_frequency", highest}, {"trusted_frequency", source.trusted}})
    if (std::isfinite(value)) attributes.emplace_back(name, value);
  write_locus_file(path, source.options.common.overwrite(), locus, windows, units, attributes);
}

}  // namespace stridor
