#include "app/runs/studied_scene.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "app/results/pictures.hpp"
#include "core/errors.hpp"
#include "io/run_file/initial_state.hpp"
#include "io/run_file/run_summary.hpp"
#include "io/scene/channels.hpp"

namespace stridor {
namespace {

/// The acceleration by which `run` sums up, else the first channel of a point.
std::optional<Channel> compared_channel(const Scene& scene) {
  const auto acceleration = acceleration_channel(*scene.record);
  for (const Channel& one : parse_channels(*scene.record, scene.model)) {
    if (acceleration ? one.name == *acceleration : one.point.has_value()) return one;
  }
  return std::nullopt;
}

/// Window and band: those of the scene, else from the end of the ramp on and 1 to 15 kHz as far as
/// the samples allow.
NormParameters norms_of(const StudiedScene& study, const char* end_key) {
  const double end = study.end();
  const Scene& scene = study.loaded.scene;
  NormParameters norms;
  const bool is_given = study.loaded.tree.entry("measure") != nullptr;
  norms.window.from = is_given ? scene.measure.from : study.model.system.drives_constant_from();
  norms.window.to = std::min(end, scene.measure.to.value_or(end));
  const double clean = 0.4 / study.interval;
  norms.band = scene.measure.band.size() == 2
                   ? Band{scene.measure.band[0], scene.measure.band[1]}
                   : Band{std::min(1e3, 0.1 * clean), std::min(15e3, clean)};
  const double needed = norms.window.from + 10.0 * study.interval;
  if (!(norms.window.to >= needed)) {
    throw ConfigError(Refusal::wrong_value, end_key,
                      fmt::format("the run ends at {:.6g} s, but errors are taken from "
                                  "{:.6g} s on (measure.from, or the end of the ramp)",
                                  end, norms.window.from));
  }
  return norms;
}

}  // namespace

StudiedScene study_scene(LoadedScene loaded, const std::optional<std::string>& until) {
  StudiedScene study{};
  study.loaded = std::move(loaded);
  const Scene& scene = study.loaded.scene;
  const std::optional<Channel> channel =
      scene.record ? compared_channel(scene) : std::optional<Channel>();
  if (!channel) {
    throw study.loaded.located(
        ConfigError(Refusal::missing, "record",
                    "no motion of a point among the channels: errors need one to compare by"));
  }
  study.channel = channel->name;
  study.model = build_model(study.loaded);
  (void)set_initial_state(study.model.system, study.loaded);
  const Model::Point& point = study.model.points.at(*channel->point);
  study.observed = {point.body, point.rows.row(channel->direction)};
  study.interval = scene.record->interval;
  double end = scene.time->end;
  if (until) {
    end = option_value("--until", *until, "s", Range::positive());
    if (end > scene.time->end) {
      throw ConfigError(
          Refusal::wrong_value, "--until",
          fmt::format("{:.6g} s is beyond the end of the scene, {:.6g} s", end, scene.time->end));
    }
  }
  study.num_samples = static_cast<std::int64_t>(std::floor(end / study.interval + 1e-6));
  if (until) {
    study.norms = norms_of(study, "--until");
    return study;
  }
  try {
    study.norms = norms_of(study, "time.end");
  } catch (const ConfigError& error) {
    throw study.loaded.located(error);
  }
  return study;
}

}  // namespace stridor
