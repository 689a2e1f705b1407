// Pictures of modes.
#pragma once

#include <cstddef>
#include <filesystem>
#include <string>
#include <vector>

#include "app/stability/analysed_spectrum.hpp"

namespace stridor {

/// Draws one mode as mode_NN.png, and writes a period of it for ParaView.
/// @param folder made where it does not exist
/// @param right  right eigenvector of the member's pencil
/// @param number of the mode in the list of the spectrum, from 1
/// @return the files, the picture first
/// @throws ConfigError if no body can be drawn, or the mode moves none of those that can; FileError
std::vector<std::string> write_mode_pictures(
    const std::filesystem::path& folder, const StabilityOptions& options, const LoadedScene& loaded,
    const SceneFamily::Member& member, const SlidingState& state, const Eigenvalue& eigenvalue,
    const Eigen::VectorXcd& right, std::size_t number);

}  // namespace stridor
