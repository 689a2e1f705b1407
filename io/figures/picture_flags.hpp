// Labels above a picture, each on a line to what it names.
#pragma once

#include <span>
#include <vector>

namespace stridor {

/// A label: where on the page it stands, cm, and how wide its text is.
struct FlagRequest {
  double x = 0.0;
  double width = 0.0;
};

/// Rows of labels, 0 the lowest, so that none overlaps another or the line of another.
///
/// Each text begins at its x and reaches to the right; its line goes straight down. A label is
/// above all to its right that its text reaches over, so lines pass to the left of lower texts.
/// @param gap least distance between a text and the next line, cm
/// @param most_rows there are; −1 for a label that finds none
std::vector<int> flag_rows(std::span<const FlagRequest> flags, double gap, int most_rows);

}  // namespace stridor
