// A checksum that finds accidents, not attacks.
#pragma once

#include <cstdint>
#include <span>
#include <string_view>

namespace stridor {

/// FNV-1a with 64 bits: a handful of lines without a further library, the same on every machine,
/// and taken piece by piece: pass the result of the piece before. Two contents that differ by
/// accident have the same one with a probability of 2⁻⁶⁴.
inline std::uint64_t fnv1a(std::span<const unsigned char> bytes,
                           std::uint64_t sum = 14695981039346656037ULL) {
  for (const unsigned char byte : bytes) sum = (sum ^ byte) * 1099511628211ULL;
  return sum;
}

inline std::uint64_t fnv1a(std::string_view text, std::uint64_t sum = 14695981039346656037ULL) {
  return fnv1a(std::span(reinterpret_cast<const unsigned char*>(text.data()), text.size()), sum);
}

}  // namespace stridor
