// Marks on a spectrogram: boxes around frequencies that last a while, with labels that cover
// neither each other nor a box.
#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

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

}  // namespace stridor
