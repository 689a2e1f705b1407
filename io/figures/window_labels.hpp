// Labels with the frequencies of unstable windows, laid out beside or above a diagram so that none
// covers another.
#pragma once

#include <cstddef>
#include <string>
#include <vector>

namespace stridor {

/// A stretch of the parameter on which an eigenvalue has a positive real part.
struct LocusWindow {
  double from = 0.0;
  double to = 0.0;
  double frequency = 0.0;   ///< Hz, where it grows fastest
  double growth_max = 0.0;  ///< 1/s
};

/// The label of a window above a diagram, written upwards.
struct WindowLabel {
  std::size_t window = 0;  ///< index into the windows
  std::string text;        ///< "3.52 kHz"
  double x = 0.0;          ///< of its middle, cm from the left edge of the diagram
};

/// Lays out labels over the middles of windows, moved apart to at least `spacing`. Where there is
/// no room for all of them, those of the windows with the least growth are omitted.
/// @param from, to parameter at the left and right edge
/// @param width    of the diagram, cm
/// @param spacing  cm, > 0
/// @return from left to right
std::vector<WindowLabel> place_window_labels(const std::vector<LocusWindow>& windows, double from,
                                             double to, double width, double spacing);

/// The label of a window beside a diagram, with a line to where its branch is farthest right.
struct BranchLabel {
  std::string text;
  double growth = 0.0;     ///< 1/s, of the tip
  double frequency = 0.0;  ///< Hz, likewise
  double height = 0.0;     ///< cm above the lower edge of the diagram, of the text
};

/// Lays out labels beside a diagram; windows of one branch, whose labels say the same, get one.
/// @param unlabelled gets those for which there is no room, of the least growth
std::vector<BranchLabel> place_branch_labels(const std::vector<LocusWindow>& windows,
                                             double frequency_limit, double height, double spacing,
                                             std::vector<std::string>& unlabelled);

/// " Without room for a label: 3.5 kHz, 7 kHz."; empty where all have one.
std::string unlabelled_text(const std::vector<std::string>& labels);

}  // namespace stridor
