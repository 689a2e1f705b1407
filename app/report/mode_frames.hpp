// Shapes of modes in a report, at some values of the key along which the page moves.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "app/report/report_section.hpp"

namespace stridor {

/// Where the scene of a result file is to be had.
struct FramedScene {
  std::string resolved;  ///< as the file holds it: with the values that expressions had
  std::string source;    ///< of it, for messages
  std::string path;      ///< of the scene as written; it is taken where it still has the same hash
  std::string hash;
};

/// Along what modes are shown.
struct FramedRange {
  std::string parameter;       ///< key of the scene
  std::vector<double> values;  ///< ascending
  std::string about;           ///< of StabilityOptions; empty: the default of the scene
  std::vector<double> wanted{};  ///< values to be among those shown, the most wanted first
  /// Modes up to this frequency are looked at, Hz, and those that grow are shown first; else the
  /// lowest ones.
  std::optional<double> highest{};
};

/// How much of a page they may take.
struct FrameBudget {
  double bytes = 0.0;
  int most_values = 1;
};

/// Computes the modes of a scene at equally spaced values of a key and those wanted and adds them
/// to a section as a view, with the places of all nodes there, and the times at which a run of the
/// scene passes the values. What cannot be computed or drawn becomes a remark of the section: files
/// that the scene names may be gone, the values may have no equilibrium.
///
/// @param range    nothing: the scene as it stands, or along the whole way of its drive
void add_mode_frames(const FramedScene& scene, const std::optional<FramedRange>& range,
                     const FrameBudget& budget, ReportPage& page, Json& section);

}  // namespace stridor
