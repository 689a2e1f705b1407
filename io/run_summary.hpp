// The numbers that a run is summed up in.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "analysis/bursts.hpp"
#include "io/run_file.hpp"
#include "io/scene.hpp"

namespace stridor {

/// Acceleration of the observed end over the window of `measure`.
struct AccelerationSummary {
  std::string channel;
  double peak = 0.0;  ///< largest absolute recorded value, m/s²
  double rms = 0.0;   ///< within `measure.band`, m/s²
  /// Bursts in the band; nothing where the scene gives none.
  std::optional<std::vector<Burst>> bursts;
};

/// Reads the acceleration of a free end off a run file: of the first channel
/// "<body>.free_end.y.acceleration", else of the first acceleration channel.
/// @return nothing where there is no such channel or the window holds no sample
/// @throws FileError if the file cannot be read
std::optional<AccelerationSummary> summarise_acceleration(const RunFileReader& file,
                                                          const MeasureParameters& measure);

}  // namespace stridor
