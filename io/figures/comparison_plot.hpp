// Pictures that set the transients of one scene under several contact assumptions side by side.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "io/scene/scene.hpp"

namespace stridor {

/// One of the transients.
struct ComparisonRun {
  std::string title;  ///< e.g. "Subs-b"
  std::string file;   ///< its run file
};

/// Draws into a folder, as PNG:
///
///   accelerations       the acceleration of every run over that of the last one, the reference
///   sliding_velocities  of the first pair, over the window of `measure`
///   contact_forces      likewise; runs that ended before the window are named below
///   spectrograms        of the accelerations, on one scale of colours
///
/// @param runs at least one, with the series of `scene`
/// @return the names of the figures drawn; those whose series no run holds are left out
/// @throws FileError, ConfigError as the readers and draw_figure()
std::vector<std::filesystem::path> plot_comparison(const std::vector<ComparisonRun>& runs,
                                                   const std::filesystem::path& folder,
                                                   const Scene& scene);

}  // namespace stridor
