// The numbers that a run is summed up in, and what pictures of it need to know.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "analysis/bursts.hpp"
#include "io/run_file/run_file.hpp"
#include "io/scene/scene.hpp"

namespace stridor {

/// Acceleration of the observed end over the window of `measure`.
struct AccelerationSummary {
  std::string channel;
  double peak = 0.0;  ///< largest absolute recorded value, m/s²
  double rms = 0.0;   ///< within `measure.band`, m/s²
  /// Bursts in the band; nothing where the scene gives none.
  std::optional<std::vector<Burst>> bursts{};
  std::optional<LastingTone> lasting{};  ///< likewise
};

/// The path of the acceleration that a run is summed up by: the first channel
/// "<body>.free_end.y.acceleration", else the first acceleration channel.
std::optional<std::string> acceleration_channel(const RunFileReader& file);

/// The same channel of the run that a scene will make, "<body>.<point>.<x|y>.acceleration".
std::optional<std::string> acceleration_channel(const RecordParameters& record);

/// Sums up an acceleration, in blocks (find_vibration()): what it takes does not grow with its
/// length.
/// @param channel  its name
/// @param first    time of the first sample, s
/// @param interval of the samples, s
/// @param values   m/s²
/// @return nothing where the window of `measure` holds no sample
std::optional<AccelerationSummary> summarise_acceleration(const std::string& channel, double first,
                                                          double interval,
                                                          const SampleSource& values,
                                                          const MeasureParameters& measure);

/// Reads the acceleration_channel() of a run file.
/// @return nothing where there is no such channel or the window holds no sample
/// @throws FileError if the file cannot be read
std::optional<AccelerationSummary> summarise_acceleration(const RunFileReader& file,
                                                          const MeasureParameters& measure);

/// The bursts that `run` stored under /bursts; empty where it found none or did not look. Their
/// `growth` and `peak_time` are not stored and NaN.
/// @param path of the file, for messages
/// @throws FileError naming the dataset if one is missing, unlike the others in length, not finite,
///         or a burst ends before it starts
std::vector<Burst> recorded_bursts(const RunFileReader& file, const std::string& path);

/// The bursts of a run in another band than the one of its scene, sought as `run` does.
/// @param measure of its scene
/// @return nothing where there is no acceleration, or no sample in the window of `measure`
/// @throws FileError naming the channel if one of its samples is not finite
/// @throws std::invalid_argument unless 0 < lower < upper < half the sampling rate
std::optional<std::vector<Burst>> bursts_in_band(const RunFileReader& file, const std::string& path,
                                                 MeasureParameters measure, Band band);

/// What the scene in a run file says of how its results are read.
struct RecordedSettings {
  MeasureParameters measure;
  std::optional<SpectrogramSection> spectrogram;
};

/// Reads these sections of /scene/resolved, and no others, which another version of the program may
/// have written.
/// @param path of the file, for messages
/// @throws FileError naming /scene/resolved if they cannot be read
RecordedSettings recorded_settings(const RunFileReader& file, const std::string& path);

/// Time between the samples of a run file, s.
/// @param path of the file, for messages
/// @return 0 where there are fewer than two samples
/// @throws FileError naming /time if the samples are not equidistant within 10⁻³ of the interval
double sampling_interval(const RunFileReader& file, const std::string& path);

}  // namespace stridor
