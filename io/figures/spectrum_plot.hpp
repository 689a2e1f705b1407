// Amplitude spectra as curves, stacked by unit.
#pragma once

#include <cstddef>
#include <filesystem>
#include <string>
#include <vector>

#include "analysis/spectrogram.hpp"

namespace stridor {

/// A curve and its name in the key.
struct SpectrumCurve {
  std::string name;
  Spectrum spectrum;
};

/// One diagram of a stack: curves of one unit.
struct SpectrumPanel {
  std::string units;                  ///< as in a run file
  double reference = 1.0;             ///< of the levels, in `units`, positive
  std::vector<SpectrumCurve> curves;  ///< at least one
};

enum class AmplitudeScale {
  level,   ///< dB
  linear,  ///< the amplitude itself
};

/// A frequency to be marked.
struct FrequencyMark {
  double frequency = 0.0;  ///< Hz
  std::string name;        ///< short, e.g. "1"
};

/// Contents of a picture of spectra besides the curves.
struct SpectrumPicture {
  AmplitudeScale scale = AmplitudeScale::level;
  double max_frequency = 0.0;  ///< Hz, end of the axis, positive
  double range = 120.0;        ///< dB, most that is shown below the highest level, positive
  /// Lines from 0 Hz on that do not count for the range of the axis, because they hold the mean.
  std::size_t mean_lines = 0;
  std::vector<FrequencyMark> marks;
  std::string caption;  ///< below; may be empty
};

/// Marks whose frequencies lie so close that they get one label.
struct MarkGroup {
  double lower = 0.0;  ///< Hz, the lowest of them
  double upper = 0.0;  ///< Hz, the highest
  std::string label;   ///< "1: 3.53 kHz", "1, 2: 3.52–3.53 kHz"
};

/// Gathers marks into groups: a mark less than `distance` above the last one of a group joins it.
/// @return by frequency; names in the order given
std::vector<MarkGroup> grouped(const std::vector<FrequencyMark>& marks, double distance);

/// Draws spectra, one panel below the other over one frequency axis, 16 cm wide. Marks within the
/// axis are dashed lines through all panels.
///
/// @param panels at least one
/// @param figure .png, .svg or .pdf; replaced if it exists
/// @throws std::invalid_argument if there is no panel, a panel has no curve, or a number of the
///         picture is out of range
/// @throws ConfigError, FileError as draw_figure()
void plot_spectra(const std::vector<SpectrumPanel>& panels, const SpectrumPicture& picture,
                  const std::filesystem::path& figure);

}  // namespace stridor
