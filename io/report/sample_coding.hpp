// Numbers as bytes of a report, small enough for a page.
#pragma once

#include <cstddef>
#include <span>
#include <vector>

namespace stridor {

/// Samples that share an offset and a scale.
inline constexpr std::size_t samples_per_scale = 4096;

/// Samples in two bytes each.
///
/// Every piece of 4,096 samples has an offset o, the middle of its range, and a scale
/// c = (max − min)/(2·32767): a sample is o + c·i with an integer i in −32767 … 32767, hence right
/// to c/2, 7.6·10⁻⁶ of the range of its piece; quiet pieces keep their digits. i = −32768 stands for
/// a value that is not finite.
///
/// Layout: o and c of all pieces as doubles, one after the other, then the lower bytes of all
/// integers, then their upper bytes; little-endian. Bytes of a kind side by side pack better.
std::vector<unsigned char> coded_samples(std::span<const double> samples);

/// What coded_samples() stand for; NaN where a value was not finite.
/// @throws std::invalid_argument if there are not as many bytes as `count` samples have
std::vector<double> decoded_samples(std::span<const unsigned char> bytes, std::size_t count);

/// Numbers as doubles (8 bytes) or floats (4), the first bytes of all, then the second ones and so
/// on; little-endian.
std::vector<unsigned char> shuffled_doubles(std::span<const double> values);
std::vector<unsigned char> shuffled_floats(std::span<const double> values);

/// Least and largest of every `factor` samples, one after the other; NaN are passed over where a
/// piece holds others.
/// @param factor ≥ 1
std::vector<double> extremes(std::span<const double> samples, std::size_t factor);

}  // namespace stridor
