#include "core/memory.hpp"

#include <fmt/format.h>
#include <malloc.h>
#include <sys/resource.h>

#include <fstream>
#include <optional>
#include <sstream>

namespace stridor {
namespace {

namespace fs = std::filesystem;

/// The number at the beginning of a file; nothing where there is none ("max").
std::optional<double> number_in(const fs::path& path) {
  std::ifstream file(path);
  double value = 0.0;
  if (!(file >> value)) return std::nullopt;
  return value;
}

void lower(MemoryLimit& limit, double bytes, const char* source) {
  if (bytes > 0.0 && bytes < limit.bytes) limit = {bytes, source};
}

/// A group is held by the limits of those it is in, too.
void lower_by_groups(MemoryLimit& limit, const fs::path& mount, const std::string& group,
                     const char* name) {
  fs::path path = group;
  while (true) {
    if (const auto bytes = number_in(mount / path.relative_path() / name))
      lower(limit, *bytes, "the memory of its control group");
    if (!path.has_relative_path()) return;
    path = path.parent_path();
  }
}

}  // namespace

MemoryLimit memory_limit(const fs::path& root, double address_space) {
  MemoryLimit limit;
  std::ifstream machine(root / "proc/meminfo");
  for (std::string line; std::getline(machine, line);) {
    std::istringstream words(line);
    std::string name;
    double kibibytes = 0.0;
    if (words >> name >> kibibytes && name == "MemTotal:")
      lower(limit, 1024.0 * kibibytes, "the memory of this machine");
  }
  // Lines "number:controllers:group"; version 2 has one with neither number nor controllers.
  std::ifstream groups(root / "proc/self/cgroup");
  const fs::path mount = root / "sys/fs/cgroup";
  for (std::string line; std::getline(groups, line);) {
    const std::size_t first = line.find(':');
    const std::size_t second = line.find(':', first + 1);
    if (first == std::string::npos || second == std::string::npos) continue;
    const std::string controllers = fmt::format(",{},", line.substr(first + 1, second - first - 1));
    const std::string group = line.substr(second + 1);
    if (controllers == ",,") lower_by_groups(limit, mount, group, "memory.max");
    if (controllers.find(",memory,") != std::string::npos)
      lower_by_groups(limit, mount / "memory", group, "memory.limit_in_bytes");
  }
  lower(limit, address_space, "the limit of its address space (ulimit -v)");
  return limit;
}

MemoryLimit memory_limit() {
  // Read once: every system of a family asks, thousands of times in a locus.
  static const MemoryLimit limit = [] {
    rlimit space{};
    const bool is_limited = getrlimit(RLIMIT_AS, &space) == 0 && space.rlim_cur != RLIM_INFINITY;
    return memory_limit("/", is_limited ? static_cast<double>(space.rlim_cur)
                                        : std::numeric_limits<double>::infinity());
  }();
  return limit;
}

void keep_freed_memory() {
#ifdef __GLIBC__
  constexpr int largest_kept = 32 << 20;  // the largest that mallopt() takes here
  constexpr int all_free = 1 << 30;
  mallopt(M_MMAP_THRESHOLD, largest_kept);
  mallopt(M_TRIM_THRESHOLD, all_free);
#endif
}

std::string memory_text(double bytes) {
  if (bytes < 1e9) return fmt::format("{:.3g} MB", 1e-6 * bytes);
  if (bytes < 1e12) return fmt::format("{:.3g} GB", 1e-9 * bytes);
  return fmt::format("{:.3g} TB", 1e-12 * bytes);
}

}  // namespace stridor
