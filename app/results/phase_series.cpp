#include "app/results/phase_series.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <map>

#include "core/errors.hpp"

namespace stridor {
namespace {

constexpr const char* no_silent_derivatives =
    "nothing is integrated or differentiated for a picture";

/// Partner of a quantity in a phase plot: displacement with velocity, position along the master
/// with the slip velocity; empty where there is none.
std::string partner_of(const std::string& name) {
  static const std::map<std::string, std::string> partners{{"displacement", "velocity"},
                                                           {"velocity", "displacement"},
                                                           {"position", "slip_velocity"},
                                                           {"slip_velocity", "position"}};
  const auto [place, quantity] = split_name(name);
  const auto found = partners.find(quantity);
  return found == partners.end() ? "" : place + "." + found->second;
}

bool is_derivative(const std::string& name) {
  const std::string quantity = split_name(name).second;
  return quantity == "velocity" || quantity == "slip_velocity";
}

/// The pair that a phase plot shows where the user names no channel.
std::pair<std::string, std::string> default_pair(const RecordedStretch& run,
                                                 const std::vector<std::string>& names) {
  for (const char* quantity : {"position", "displacement"}) {
    for (const std::string& name : names) {
      const std::string partner = partner_of(name);
      if (split_name(name).second == quantity &&
          std::find(names.begin(), names.end(), partner) != names.end())
        return {name, partner};
    }
  }
  std::string remedy;
  for (const std::string& name : names) {
    const auto [place, quantity] = split_name(name);
    if (const std::string partner = partner_of(name); !partner.empty()) {
      remedy = fmt::format("record {} with {}", partner, name);
      break;
    }
    if (quantity == "acceleration" && remedy.empty())
      remedy = fmt::format("record {0}.displacement and {0}.velocity", place);
  }
  if (remedy.empty()) remedy = "record a displacement and the velocity of the same point";
  throw ConfigError(
      Refusal::not_recorded, "--channel",
      fmt::format("{} holds no displacement with its velocity, and {}; {} (record.channels of the "
                  "scene), or name two channels: --channel A --channel B",
                  run.path, no_silent_derivatives, remedy));
}

}  // namespace

std::pair<std::string, std::string> phase_series(const std::vector<std::string>& channels,
                                                 const RecordedStretch& run) {
  std::vector<std::string> names;
  for (const std::string& series : run.file.series_names()) names.push_back(channel_name(series));
  const auto series_of = [&](const std::string& name) {
    return find_series(run, name, "--channel");
  };
  if (channels.size() > 2)
    throw ConfigError(Refusal::wrong_value, "--channel",
                      "a phase plot shows one channel against one other");
  if (channels.size() == 2) return {series_of(channels[0]), series_of(channels[1])};
  if (channels.empty()) {
    const auto [across, up] = default_pair(run, names);
    return {series_of(across), series_of(up)};
  }
  const std::string series = series_of(channels[0]);
  const std::string partner = partner_of(channels[0]);
  if (std::find(names.begin(), names.end(), partner) == names.end()) {
    throw ConfigError(
        Refusal::not_recorded, "--channel",
        partner.empty()
            ? fmt::format("name a second channel against which to show {}", channels[0])
            : fmt::format("{} is not recorded, and {}; add it to record.channels of the scene, or "
                          "name another channel against which to show {}",
                          partner, no_silent_derivatives, channels[0]));
  }
  return is_derivative(channels[0]) ? std::pair{series_of(partner), series}
                                    : std::pair{series, series_of(partner)};
}

std::string resolution_text(const PhaseAxis& axis, double interval) {
  constexpr double enough = 12.0;
  const auto samples = samples_per_period(axis.values);
  if (!samples || *samples >= enough) return "";
  return fmt::format(
      "Only {:.2g} samples per period: corners are those of the sampling, every {}; record at a "
      "shorter interval (record.interval of the scene) for a smooth path. ",
      *samples, quantity_text(interval, "s"));
}

}  // namespace stridor
