// Pictures of spectrograms: amplitude over time and frequency as colour, with marks on it.
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "analysis/spectrogram.hpp"

namespace stridor {

/// Origin of a mark on a spectrogram; decides how it is drawn.
enum class MarkStyle {
  found,      ///< in the signal: white, dashed
  predicted,  ///< by something else: red, dotted
};

/// A stretch of time with a frequency, to be marked on a spectrogram.
struct SpectrogramMark {
  double from = 0.0;        ///< s
  double to = 0.0;          ///< s
  double frequency = 0.0;   ///< Hz
  std::string label;        ///< e.g. "1: 3.53 kHz"; may be empty
  std::string short_label;  ///< where there is no room for the label, e.g. "1"; may be empty
  MarkStyle style = MarkStyle::found;
};

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

/// Amplitudes on the raster of a picture. The cells are equal and fill the rectangle.
struct AmplitudeRaster {
  Eigen::MatrixXd amplitude;   ///< row per frequency, from low to high; column per time
  double from = 0.0;           ///< s, left edge
  double to = 0.0;             ///< s, right edge
  double max_frequency = 0.0;  ///< Hz, upper edge; the lower one is 0
};

/// Brings a spectrogram onto the raster of a picture, coarser or finer, by taking maxima.
///
/// A column of the spectrogram represents the time up to half-way to its neighbours, the first and
/// the last one for all of their piece; a line for the frequencies up to half-way to its
/// neighbours. A cell of the raster is the largest amplitude of all that it touches, so that a
/// burst of a single column, or a single line, does not vanish from the picture.
///
/// @param spectrogram   at least one column
/// @param max_frequency upper edge of the raster, Hz, positive; at most the last line is used up to
///                      half a line above itself
/// @param rows, columns of the raster, positive
/// @throws std::invalid_argument if one of these is out of range
AmplitudeRaster rasterise(const Spectrogram& spectrogram, double max_frequency, Eigen::Index rows,
                          Eigen::Index columns);

/// The amplitude with which the colours end: the largest up to a frequency.
/// @param mean_lines lines from 0 Hz on that do not count unless all others are 0
double highest_amplitude(const Spectrogram& spectrogram, double max_frequency,
                         std::size_t mean_lines);

/// A rectangle on a picture, cm.
struct PictureBox {
  double left = 0.0;
  double right = 0.0;
  double bottom = 0.0;
  double top = 0.0;
};

/// The axes onto which marks are laid: the lower left corner of the map is (0, 0).
struct MapArea {
  double width = 0.0;          ///< cm
  double height = 0.0;         ///< cm
  double from = 0.0;           ///< s
  double to = 0.0;             ///< s
  double max_frequency = 0.0;  ///< Hz
  double half_box = 0.3;       ///< cm, from the frequency of a mark to the edge of its box
  double font_size = 11.0;     ///< pt, of the labels
};

/// Position of a mark and its label.
struct MarkPlace {
  std::size_t mark = 0;              ///< index into the marks given
  PictureBox box;                    ///< around the mark, within the map
  std::string text;                  ///< the label, or the short one
  std::optional<PictureBox> label;   ///< around the text; nothing where there is no room
  std::optional<PictureBox> leader;  ///< vertical line to a label apart from its box
};

/// Lays out marks on a map.
///
/// Marks that do not touch the map are omitted; the others are cut at its edges. A label is
/// right above or below its box where it covers neither another label nor a box, else in rows
/// farther away with a line to its box. Where there is no room the short label is tried.
///
/// @param marks `from` ≤ `to`
/// @return in the order of the marks
std::vector<MarkPlace> place_marks(const std::vector<SpectrogramMark>& marks, const MapArea& map);

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
