// Pictures of spectrograms: amplitude over time and frequency as colour, with marks on it.
#pragma once

#include <cstddef>
#include <filesystem>
#include <string>
#include <vector>

#include "analysis/spectrogram.hpp"
#include "io/figures/spectrogram_marks.hpp"

namespace stridor {

/// Contents of a picture of a spectrogram besides the amplitudes.
struct SpectrogramPicture {
  std::string title;           ///< above; may be empty
  std::string units;           ///< of the amplitudes, as in a run file
  double max_frequency = 0.0;  ///< Hz, end of the axis, positive
  double reference = 1.0;      ///< of the levels, in `units`, positive
  double range = 60.0;         ///< dB that the colours span below the highest level, positive
  /// Lines from 0 Hz on that do not count for the highest level, because they hold the mean value.
  std::size_t mean_lines = 0;
  std::vector<SpectrogramMark> marks;
  std::string caption;  ///< below; may be empty
};

/// The amplitude with which the colours end: the largest up to a frequency.
/// @param mean_lines lines from 0 Hz on that do not count unless all others are 0
double highest_amplitude(const Spectrogram& spectrogram, double max_frequency,
                         std::size_t mean_lines);

/// Draws a spectrogram, 16 cm wide, as levels in dB on a perceptually uniform scale of colours.
///
///     level = 20 log₁₀(amplitude/reference)
///
/// Levels more than `range` below the highest one have the lowest colour. The picture holds
/// rasterise() of at most 1000 × 600 cells, however long the run.
///
/// @param spectrogram at least one column; may be zero everywhere
/// @param picture     see there
/// @param figure      .png, .svg or .pdf; replaced if it exists
/// @throws std::invalid_argument if a number of the picture is out of range
/// @throws ConfigError, FileError as draw_figure()
void plot_spectrogram(const Spectrogram& spectrogram, const SpectrogramPicture& picture,
                      const std::filesystem::path& figure);

/// One of several spectrograms over a common time axis.
struct SpectrogramPanel {
  std::string title;  ///< above; may be empty
  const Spectrogram* spectrogram = nullptr;
  std::vector<SpectrogramMark> marks;
};

/// Draws spectrograms one below the other, on one scale of colours, as plot_spectrogram().
///
/// @param panels  at least one
/// @param picture its title and marks are not used
/// @throws as plot_spectrogram()
void plot_spectrograms(const std::vector<SpectrogramPanel>& panels,
                       const SpectrogramPicture& picture, const std::filesystem::path& figure);

}  // namespace stridor
