// The line of a text that a message is about, as compilers show it.
#pragma once

#include <string>
#include <string_view>

namespace stridor {

/// A line with its number in the margin, and below it a caret under one of its characters:
///
///      12 |     thicknes: 1.5 mm
///         |     ^
///
/// Fits into a terminal of 80 columns: a longer line is cut to the surroundings of the caret. The
/// caret is under its character whatever tabs, wide characters and marks are before it; tabs
/// become spaces; bytes that are not UTF-8 or would control the terminal become '?'.
///
/// @param line   without its line break
/// @param number 1-based, for the margin; 0: none is shown
/// @param column 1-based, in bytes; beyond the end means just behind it; 0: no caret
/// @return the two lines, or the first alone, without a line break at the end
std::string excerpt_of(std::string_view line, int number, int column);

}  // namespace stridor
