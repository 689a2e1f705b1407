#include "io/results/wave_file.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <stdexcept>

namespace stridor {
namespace {

constexpr std::uint64_t bytes_per_sample = 3;

/// Appends the lowest bytes of a number, the lowest first.
void append(std::string& bytes, std::uint64_t number, std::uint64_t count) {
  for (std::uint64_t i = 0; i < count; ++i)
    bytes += static_cast<char>(static_cast<unsigned char>((number >> (8 * i)) & 0xff));
}

std::uint64_t quantised(double value) {
  constexpr double full_scale = 8388607.0;  // 2²³ − 1
  const double level = std::round(full_scale * std::clamp(value, -1.0, 1.0));
  return static_cast<std::uint64_t>(static_cast<std::int64_t>(level));
}

}  // namespace

std::string wave_bytes(std::span<const std::vector<double>> channels, int rate) {
  if (channels.empty() || channels.size() > 2)
    throw std::invalid_argument("wave_bytes: a sound has one or two channels");
  const std::size_t length = channels.front().size();
  for (const std::vector<double>& channel : channels) {
    if (channel.size() != length)
      throw std::invalid_argument("wave_bytes: the channels are not of the same length");
  }
  if (rate <= 0) throw std::invalid_argument("wave_bytes: the sampling rate must be positive");
  const std::uint64_t frame = bytes_per_sample * channels.size();
  const std::uint64_t data = frame * length;
  const std::uint64_t padding = data % 2;
  constexpr std::uint64_t header = 36;
  if (header + data + padding > std::numeric_limits<std::uint32_t>::max())
    throw std::invalid_argument("wave_bytes: the sound is longer than a file of 4 GB holds");

  const auto unsigned_rate = static_cast<std::uint64_t>(rate);
  std::string bytes;
  bytes.reserve(header + 8 + data + padding);
  bytes += "RIFF";
  append(bytes, header + data + padding, 4);
  bytes += "WAVEfmt ";
  append(bytes, 16, 4);  // bytes of this part
  append(bytes, 1, 2);   // linear PCM
  append(bytes, channels.size(), 2);
  append(bytes, unsigned_rate, 4);
  append(bytes, unsigned_rate * frame, 4);
  append(bytes, frame, 2);
  append(bytes, 8 * bytes_per_sample, 2);
  bytes += "data";
  append(bytes, data, 4);
  for (std::size_t i = 0; i < length; ++i) {
    for (const std::vector<double>& channel : channels)
      append(bytes, quantised(channel[i]), bytes_per_sample);
  }
  bytes.append(padding, '\0');
  return bytes;
}

}  // namespace stridor
