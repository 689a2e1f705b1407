#include "io/report/sample_coding.hpp"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <limits>
#include <stdexcept>

namespace stridor {
namespace {

static_assert(std::endian::native == std::endian::little, "reports hold little-endian numbers");

constexpr double largest_code = 32767.0;
constexpr std::int16_t code_of_none = -32768;

struct PieceScale {
  double offset = 0.0;
  double scale = 0.0;
};

PieceScale scale_of(std::span<const double> piece) {
  double least = std::numeric_limits<double>::infinity();
  double most = -least;
  for (const double value : piece) {
    if (!std::isfinite(value)) continue;
    least = std::min(least, value);
    most = std::max(most, value);
  }
  if (!(least <= most)) return {};
  // Halves first: the range of finite numbers may not be one.
  const double half = 0.5 * most - 0.5 * least;
  // Rounded down, so that the largest code of the widest range stands for a number.
  return {least + half, std::nextafter(half / largest_code, 0.0)};
}

template <typename Number>
std::vector<unsigned char> shuffled(std::span<const double> values) {
  std::vector<unsigned char> bytes(values.size() * sizeof(Number));
  for (std::size_t i = 0; i < values.size(); ++i) {
    const auto number = static_cast<Number>(values[i]);
    unsigned char one[sizeof(Number)];
    std::memcpy(one, &number, sizeof(Number));
    for (std::size_t k = 0; k < sizeof(Number); ++k) bytes[k * values.size() + i] = one[k];
  }
  return bytes;
}

std::size_t num_pieces(std::size_t count) {
  return (count + samples_per_scale - 1) / samples_per_scale;
}

}  // namespace

std::vector<unsigned char> coded_samples(std::span<const double> samples) {
  const std::size_t count = samples.size();
  const std::size_t head = num_pieces(count) * 2 * sizeof(double);
  std::vector<unsigned char> bytes(head + 2 * count);
  for (std::size_t begin = 0, piece = 0; begin < count; begin += samples_per_scale, ++piece) {
    const std::size_t end = std::min(count, begin + samples_per_scale);
    const PieceScale coding = scale_of(samples.subspan(begin, end - begin));
    std::memcpy(bytes.data() + piece * 2 * sizeof(double), &coding.offset, sizeof(double));
    std::memcpy(bytes.data() + (piece * 2 + 1) * sizeof(double), &coding.scale, sizeof(double));
    for (std::size_t i = begin; i < end; ++i) {
      std::int16_t code = code_of_none;
      if (std::isfinite(samples[i])) {
        const double steps =
            coding.scale > 0.0 ? std::round((samples[i] - coding.offset) / coding.scale) : 0.0;
        code = static_cast<std::int16_t>(std::clamp(steps, -largest_code, largest_code));
      }
      const auto bits = static_cast<std::uint16_t>(code);
      bytes[head + i] = static_cast<unsigned char>(bits & 255U);
      bytes[head + count + i] = static_cast<unsigned char>(bits >> 8);
    }
  }
  return bytes;
}

std::vector<double> decoded_samples(std::span<const unsigned char> bytes, std::size_t count) {
  const std::size_t head = num_pieces(count) * 2 * sizeof(double);
  if (bytes.size() != head + 2 * count)
    throw std::invalid_argument("decoded_samples: another number of bytes is expected");
  std::vector<double> samples(count);
  for (std::size_t i = 0; i < count; ++i) {
    PieceScale coding;
    const std::size_t piece = i / samples_per_scale;
    std::memcpy(&coding.offset, bytes.data() + piece * 2 * sizeof(double), sizeof(double));
    std::memcpy(&coding.scale, bytes.data() + (piece * 2 + 1) * sizeof(double), sizeof(double));
    const auto bits = static_cast<std::uint16_t>(bytes[head + i] | (bytes[head + count + i] << 8));
    const auto code = static_cast<std::int16_t>(bits);
    samples[i] = code == code_of_none ? std::numeric_limits<double>::quiet_NaN()
                                      : coding.offset + coding.scale * code;
  }
  return samples;
}

std::vector<unsigned char> shuffled_doubles(std::span<const double> values) {
  return shuffled<double>(values);
}

std::vector<unsigned char> shuffled_floats(std::span<const double> values) {
  return shuffled<float>(values);
}

std::vector<double> extremes(std::span<const double> samples, std::size_t factor) {
  if (factor < 1) throw std::invalid_argument("extremes: the factor must be at least 1");
  std::vector<double> found;
  found.reserve(2 * (samples.size() / factor + 1));
  for (std::size_t begin = 0; begin < samples.size(); begin += factor) {
    const std::size_t end = std::min(samples.size(), begin + factor);
    double least = std::numeric_limits<double>::quiet_NaN();
    double most = least;
    for (std::size_t i = begin; i < end; ++i) {
      // fmin and fmax give the other number where one is NaN.
      least = std::fmin(least, samples[i]);
      most = std::fmax(most, samples[i]);
    }
    found.push_back(least);
    found.push_back(most);
  }
  return found;
}

}  // namespace stridor
