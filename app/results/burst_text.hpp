// A burst or a tone in one line, as `run` and `info` list it.
#pragma once

#include <string>
#include <utility>
#include <vector>

#include "app/terminal/command.hpp"

namespace stridor {

/// "0.875 to 0.929 s, 6406 Hz, peak 179.6 m/s^2, gain 4.61".
/// @param burst object with the numbers start, end (s), frequency (Hz), peak (m/s^2) and gain; one
///              that is null, because it is not finite, is shown as "nan"
std::string burst_text(const Json& burst);

/// "2199 Hz, 3290 m/s^2 r.m.s. throughout, 99 % of the power in the band".
/// @param tone object with the numbers frequency (Hz), rms (m/s^2) and share
std::string lasting_tone_text(const Json& tone);

/// The lines that list bursts, as name and value: of more than 20 the loudest 20 in order of time,
/// by their numbers, and how many are not listed.
/// @param bursts array of objects as of burst_text(), or null
std::vector<std::pair<std::string, std::string>> burst_lines(const Json& bursts);

/// The line that says which bursts, and whether a lasting tone, lie above what the bodies resolve;
/// empty where none does.
/// @param bursts  array of objects with a frequency, Hz, or null
/// @param tone    null without
/// @param trusted trusted_frequency(), Hz, or null
std::string doubtful_text(const Json& bursts, const Json& tone, const Json& trusted);

}  // namespace stridor
