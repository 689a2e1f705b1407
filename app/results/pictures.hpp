// Functions common to the verbs that make pictures of a run file.
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "analysis/spectrogram.hpp"
#include "analysis/statistics.hpp"
#include "app/terminal/command.hpp"
#include "core/schema.hpp"
#include "io/figures/run_panels.hpp"
#include "io/hdf5/damage_guard.hpp"
#include "io/run_file/run_file.hpp"
#include "io/run_file/run_summary.hpp"

namespace stridor {

/// Options as the user wrote them; nothing where an option was not given.
struct PictureOptions {
  CommonOptions common;
  std::string command_line;  ///< as typed, for files of data
  std::string file;
  std::string output;
  std::vector<std::string> channels;
  std::optional<std::string> from;
  std::optional<std::string> to;
  std::optional<std::string> window;
  std::optional<std::string> length;
  std::optional<std::string> overlap;
  std::optional<std::string> max_frequency;
  std::optional<std::string> reference;
  std::optional<std::string> range;
  std::optional<std::string> band;  ///< of bursts
  std::optional<std::string> data;
  std::optional<std::string> predict;  ///< locus file
};

/// --from, --to, --json, --force.
void add_picture_options(CLI::App& verb, PictureOptions& options);
/// Division of a signal into pieces, and display of levels.
void add_spectrum_options(CLI::App& verb, PictureOptions& options);
/// Checks before anything is computed that --data, where it is given, can be written.
/// @throws ConfigError if it is the run file or the figure; FileError as check_output()
void check_data_file(const PictureOptions& options);

/// --band, of verbs that tell the bursts of a run.
void add_band_option(CLI::App& verb, std::optional<std::string>& band);

/// The bursts of a run: those that it found, or those in the band of --band.
/// @param path of the file, for messages
/// @throws ConfigError if the band is none that the samples resolve, or there is no acceleration
///         to seek bursts in; FileError
std::vector<Burst> bursts_of(const RunFileReader& file, const std::string& path,
                             const std::optional<std::string>& band);

/// A number that the user wrote behind an option.
/// @param unit    SI unit of the result; a bare number is in it
/// @param allowed range of the result
/// @throws ConfigError naming the option if it is no such number or out of range
double option_value(const char* option, const std::string& text, const std::string& unit,
                    const Range& allowed);

/// A run file and the stretch of it that a picture shows.
struct RecordedStretch {
  std::unique_ptr<DamageGuard> guard;  ///< outlives the reader
  RunFileReader file;
  std::string path;     ///< of the file
  double interval = 0;  ///< between samples, s; 0 where there is one
  IndexRange samples;   ///< at least one

  double first_time() const { return file.times()[samples.begin]; }
  double last_time() const { return file.times()[samples.end - 1]; }
  double duration() const { return static_cast<double>(samples.size()) * interval; }
  /// The times, or the values of a series, of the stretch.
  std::vector<double> times() const;
  std::vector<double> values(const std::string& series) const;
  /// The values of a series. @throws FileError naming it where one is not finite
  std::vector<double> finite_values(const std::string& series) const;
};

/// Opens the run file and finds the samples between --from and --to.
/// @throws ConfigError if there are none; FileError if the file is not a valid run file
RecordedStretch open_stretch(const PictureOptions& options);

/// The series with this name.
/// @param key where the name was written, for messages
/// @throws ConfigError with a suggestion and all names if there is none
std::string find_series(const RecordedStretch& run, const std::string& channel, const char* key);

/// Division of a stretch into pieces for spectra, and their range of frequencies.
struct PieceSettings {
  SpectrogramParameters parameters;
  double max_frequency = 0.0;  ///< Hz
};

/// Settles window, length, overlap and end of the frequency axis: options of the command line win
/// over `section`, that over the defaults.
/// @param section         of the scene; empty members and an empty section mean the defaults
/// @param default_length  s, of a piece, given the highest frequency
/// @param default_overlap where neither the command line nor the scene gives one
/// @throws ConfigError if a piece does not fit the stretch or the sampling
PieceSettings settle_pieces(const PictureOptions& options, const RecordedStretch& run,
                            const RecordedSettings& settings,
                            const std::optional<SpectrogramSection>& section,
                            const std::function<double(double)>& default_length,
                            double default_overlap);

/// "Hann window of 12.3 ms, overlap 75 %, lines 81.6 Hz apart".
std::string pieces_text(const SpectrogramParameters& parameters, double interval);

/// "Low-passed to 40 kHz before thinning: contact.gap, contact.slip_velocity. Not filtered:
/// contact.force. "; empty where none is filtered.
std::string filters_text(const RunFileReader& file, const std::vector<std::string>& series);

/// "beam.h5, scene d46029402be1a948".
std::string source_text(const RecordedStretch& run);

/// --reference, or standard_reference().
double settle_reference(const PictureOptions& options, const std::string& units);

/// A burst as pictures name it: its number from 1, as listed by `run` and `info` for the same band.
struct NumberedBurst {
  std::size_t number = 0;
  Burst burst;
};

/// The bursts_of() the run that touch the stretch.
std::vector<NumberedBurst> bursts_in(const RecordedStretch& run, const PictureOptions& options);

/// Makes the spectrogram of a channel: figure, data and printed results.
/// @throws ConfigError, FileError
ExitCode draw_spectrogram(const PictureOptions& options);

}  // namespace stridor
