// Available memory.
#pragma once

#include <filesystem>
#include <limits>
#include <string>

namespace stridor {

/// Largest memory that this process may hold, and the origin of the limit.
struct MemoryLimit {
  double bytes = std::numeric_limits<double>::infinity();
  std::string source;  ///< "physical memory", ...
};

/// The least of: the memory of the machine, that of the control groups the process is in, and the
/// limit of its address space (`ulimit -v`). Infinite without a limit. Read once in a process.
MemoryLimit memory_limit();

/// The same from other files than those of this machine.
/// @param root          in the place of "/", for /proc and /sys
/// @param address_space limit of it, bytes; may be infinite
MemoryLimit memory_limit(const std::filesystem::path& root, double address_space);

/// Lets this process keep blocks that it has freed, to be used again. Given back, they come anew as
/// pages that the kernel clears, for one thread of a process at a time.
void keep_freed_memory();

/// "18.9 GB", in powers of 1000.
std::string memory_text(double bytes);

}  // namespace stridor
