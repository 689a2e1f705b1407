// Pictures by gnuplot, run as a program of its own.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace stridor {

/// Size of a figure as it is laid out; lengths in the script's coordinates follow from it.
///
/// Text of 13 pt on 16 cm width has 6.5 pt when the figure is printed at half the width of a page.
struct FigureSize {
  double width = 16.0;      ///< cm
  double height = 9.0;      ///< cm
  double font_size = 13.0;  ///< pt, DejaVu Sans
};

/// Size of the text below the panels of a figure, pt.
inline constexpr double caption_font = 10.5;

/// Text as a gnuplot string, in single quotes; line breaks become blanks.
std::string gnuplot_string(const std::string& text);

/// Throws unless a figure of this name can be drawn; no file is touched.
/// @throws ConfigError unless the name ends with .png, .svg or .pdf
void check_figure_name(const std::filesystem::path& figure);

/// Draws a figure.
///
/// The script is run by gnuplot without the user's start-up files, through no shell, after
/// terminal, encoding and output have been set from the ending of the name: .png (pngcairo, or png
/// where gnuplot was built without cairo; 254 dots per inch), .svg, .pdf (pdfcairo). The picture is
/// drawn under a temporary name in the same folder and replaces `figure` only when gnuplot has
/// succeeded.
///
/// @param figure file to make or replace
/// @param script gnuplot commands; data best as data blocks; user's text through gnuplot_string()
/// @param size   positive
/// @throws ConfigError as check_figure_name()
/// @throws FileError if gnuplot or all fonts are missing, gnuplot fails or complains (its message
/// is
///         in the error), or the file cannot be written; an existing figure is untouched then
/// @throws std::invalid_argument if the size is not positive
void draw_figure(const std::filesystem::path& figure, const std::string& script,
                 FigureSize size = {});

/// Whether there is a scalable font in or below one of the folders; those that do not exist are
/// skipped.
bool has_fonts(const std::vector<std::filesystem::path>& folders);

}  // namespace stridor
