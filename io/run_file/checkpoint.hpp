// State from which a run resumes, as bytes in its run file.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "core/state.hpp"

namespace stridor {

/// The state of a run at a moment at which `rows` rows were in its file.
struct Checkpoint {
  std::uint64_t number = 0;  ///< 1 for the first of a run
  std::uint64_t rows = 0;
  State state;
};

/// The bytes of a checkpoint, with a checksum.
std::vector<unsigned char> encode(const Checkpoint& checkpoint);

/// The checkpoint at the beginning of `bytes`; nothing where they are damaged or incomplete.
std::optional<Checkpoint> decode(std::span<const unsigned char> bytes);

}  // namespace stridor
