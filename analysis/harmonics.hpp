// Bursts that are overtones of louder ones.
#pragma once

#include <span>

#include "analysis/bursts.hpp"

namespace stridor {

/// Says of every burst whether it is a harmonic of a louder one: whether, over the moments that both
/// courses have, its frequency is on average (weighted with its level) within 1/(8 T) of a multiple n ≥ 2 of the other's.
///
/// A periodic vibration that is not a sine, as where a contact lifts off or sticks, has lines at all
/// multiples of its frequency; they rise and fall with it and are no modes of their own. Only bursts
/// that share three moments, and half of those of the fainter one, are set side by side. Of several louder ones,
/// that of the least order is named. Two independent sounds meet by chance once in about 4 T times
/// the frequency of the louder one.
///
/// @param bursts    with the courses of find_bursts(); `harmonic` of each is set
/// @param smoothing T in s, of find_bursts()
void name_harmonics(std::span<Burst> bursts, double smoothing);

}  // namespace stridor
