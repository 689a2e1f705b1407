// stridor sound: what a channel of a run sounds like, as a sound file.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <numbers>
#include <numeric>

#include "analysis/resampling.hpp"
#include "app/results/pictures.hpp"
#include "core/activity.hpp"
#include "core/errors.hpp"
#include "io/hdf5/part_file.hpp"
#include "io/results/wave_file.hpp"

namespace stridor {
namespace {

namespace fs = std::filesystem;

/// A stretch of a run in PictureOptions, and how it is played.
struct SoundOptions {
  PictureOptions run;
  double slow = 1.0;  ///< times as slow
  int rate = 48000;   ///< Hz
};

/// Channels as they are played.
struct Sound {
  std::vector<std::string> names;
  std::string units;
  std::vector<std::vector<double>> samples;  ///< of each, at the rate of the file
  double full_scale = 0.0;                   ///< in units; 0 where there is nothing to be heard
  double lost = 0.0;  ///< largest part of the power of a channel that lies above what the file holds
};

std::vector<std::string> played_series(const PictureOptions& options, const RecordedStretch& run) {
  if (options.channels.size() > 2)
    throw ConfigError(Refusal::wrong_value, "--channel",
                      "a sound has one channel, or a left and a right one");
  std::vector<std::string> played;
  for (const std::string& channel : options.channels)
    played.push_back(find_series(run, channel, "--channel"));
  if (!played.empty()) return played;
  if (const auto series = acceleration_channel(run.file)) return {*series};
  std::vector<std::string> names;
  for (const std::string& series : run.file.series_names()) names.push_back(channel_name(series));
  throw ConfigError(Refusal::not_recorded, "--channel",
                    fmt::format("{} has no acceleration; name one of its channels: {}", run.path,
                                fmt::join(names, ", ")));
}

double mean_square(const std::vector<double>& values) {
  return std::inner_product(values.begin(), values.end(), values.begin(), 0.0) /
         static_cast<double>(values.size());
}

void remove_mean(std::vector<double>& values) {
  const double mean =
      std::accumulate(values.begin(), values.end(), 0.0) / static_cast<double>(values.size());
  for (double& value : values) value -= mean;
}

/// Lets a sound begin and end without a click: half a period of a cosine of 5 ms.
void fade(std::vector<double>& values, int rate) {
  const std::size_t length = std::min(values.size() / 2, static_cast<std::size_t>(rate / 200));
  for (std::size_t i = 0; i < length; ++i) {
    const double angle =
        std::numbers::pi * (static_cast<double>(i) + 0.5) / static_cast<double>(length);
    const double level = 0.5 * (1.0 - std::cos(angle));
    values[i] *= level;
    values[values.size() - 1 - i] *= level;
  }
}

/// A channel about its mean at the rate of the file.
std::vector<double> played(const std::vector<double>& recorded, double ratio,
                           const SoundOptions& options, Sound& sound) {
  std::vector<double> values = recorded;
  remove_mean(values);
  const double power = mean_square(values);
  std::vector<double> samples = resampled(values, ratio);
  if (power > 0.0) sound.lost = std::max(sound.lost, 1.0 - mean_square(samples) / power);
  fade(samples, options.rate);
  return samples;
}

Sound make_sound(const SoundOptions& options, const RecordedStretch& run) {
  constexpr double peak = 0.9;  // 1 dB below the most that the file holds
  Sound sound;
  double largest = 0.0;
  const double ratio = run.interval * options.slow * options.rate;
  for (const std::string& shown : played_series(options.run, run)) {
    const std::string series = spectral_series(run.file, shown);
    const std::string units = run.file.units(series);
    if (!sound.names.empty() && units != sound.units) {
      throw ConfigError(Refusal::wrong_unit, "--channel",
                        fmt::format("{} is in {}, {} in {}; a left and a right channel are in one "
                                    "unit, as both are played at the same level",
                                    sound.names[0], sound.units, channel_name(series), units));
    }
    sound.units = units;
    sound.names.push_back(channel_name(series));
    sound.samples.push_back(played(run.finite_values(series), ratio, options, sound));
    for (const double value : sound.samples.back()) largest = std::max(largest, std::abs(value));
  }
  sound.full_scale = largest / peak;
  for (std::vector<double>& channel : sound.samples) {
    for (double& value : channel) value = largest > 0.0 ? value / sound.full_scale : 0.0;
  }
  return sound;
}

/// Refuses what would become no sound, or none that a file holds.
void check_length(const SoundOptions& options, const RecordedStretch& run) {
  if (run.samples.size() < 2) {
    throw ConfigError(Refusal::not_recorded, "--from",
                      "one sample makes no sound; choose a longer stretch with --from, "
                      "--to");
  }
  const double frames = run.duration() * options.slow * options.rate;
  constexpr double most_frames = 5e8;  // of two channels in memory, 8 GB
  if (frames > most_frames) {
    throw ConfigError(Refusal::too_large, "--slow",
                      fmt::format("{:.3g} s of sound do not fit into a file; lower --slow "
                                  "or choose a shorter stretch with --from, --to",
                                  run.duration() * options.slow));
  }
}

void print_sound(const SoundOptions& options, const RecordedStretch& run, const Sound& sound) {
  const double highest = std::min(0.5 / run.interval, 0.5 * options.rate * options.slow);
  if (options.run.common.json) {
    print_json({{"sound", options.run.output},
                {"channels", sound.names},
                {"units", sound.units},
                {"full_scale", sound.full_scale},
                {"rate", options.rate},
                {"slow", options.slow},
                {"duration", static_cast<double>(sound.samples[0].size()) / options.rate},
                {"from", run.first_time()},
                {"to", run.last_time()},
                {"max_frequency", highest},
                {"lost", sound.lost}});
    return;
  }
  fmt::print("{}\n{:.3g} s of {}{}, loudest {:.3g} {}\n", options.run.output,
             static_cast<double>(sound.samples[0].size()) / options.rate,
             fmt::join(sound.names, " (left) and "), sound.names.size() > 1 ? " (right)" : "",
             0.9 * sound.full_scale, sound.units);
  if (sound.full_scale == 0.0) fmt::print("nothing moves: the sound is silent\n");
  constexpr double notable = 0.01;
  if (sound.lost > notable) {
    fmt::print("{:.0f} % of the power lies above {:.3g} kHz and is not in it; --slow {:.0f} plays it "
               "deeper\n",
               100.0 * sound.lost, 1e-3 * highest, std::ceil(2.0 * options.slow));
  }
}

ExitCode sound(const SoundOptions& options) {
  if (fs::path(options.run.output).extension() != ".wav") {
    throw ConfigError(Refusal::wrong_value, "--output",
                      fmt::format("'{}' does not end in .wav, the form of sound files "
                                  "that is written",
                                  options.run.output));
  }
  check_output(options.run.output, options.run.common.overwrite());
  const RecordedStretch run = open_stretch(options.run);
  check_length(options, run);
  const Activity converting("converting to the rate of the sound");
  const Sound made = make_sound(options, run);
  write_text_file(options.run.output, wave_bytes(made.samples, options.rate));
  print_sound(options, run, made);
  return ExitCode::done;
}

}  // namespace

void add_sound_command(CLI::App& program, Action& action) {
  auto options = std::make_shared<SoundOptions>();
  CLI::App* verb = program.add_subcommand("sound", "What a channel of a run sounds like (.wav)");
  verb->add_option("file", options->run.file, "Run file (HDF5)")->required();
  verb->add_option("-o,--output", options->run.output,
                   "Sound to write: .wav of 24 bits; default: FILE.wav");
  verb->add_option("--channel", options->run.channels,
                   "Channel to play, given twice the left and the right one; default: the "
                   "acceleration in which bursts are sought")
      ->take_all()
      ->allow_extra_args(false);
  verb->add_option("--slow", options->slow,
                   "Play so many times as slowly, all frequencies divided by it")
      ->check(CLI::Range(1e-3, 1e6))
      ->capture_default_str();
  verb->add_option("--rate", options->rate, "Sampling rate of the sound, Hz")
      ->check(CLI::Range(8000, 384000))
      ->capture_default_str();
  add_picture_options(*verb, options->run);
  verb->callback([options, &action] {
    if (options->run.output.empty())
      options->run.output = fs::path(options->run.file).replace_extension(".wav").string();
    action = [options] { return sound(*options); };
  });
}

}  // namespace stridor
