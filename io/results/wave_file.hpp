// Sound files.
#pragma once

#include <span>
#include <string>
#include <vector>

namespace stridor {

/// The bytes of a sound file: RIFF WAVE, linear PCM of 24 bits, one or two channels.
///
/// @param channels samples of each, of the same number, within [−1, 1]; what is beyond is cut off
/// @param rate     sampling rate, Hz
/// @throws std::invalid_argument for no or more than two channels or unequal numbers of samples, or if
///         the file would be larger than the 4 GB that its form allows
std::string wave_bytes(std::span<const std::vector<double>> channels, int rate);

}  // namespace stridor
