#include "io/scene/scene_mechanics.hpp"

#include <algorithm>
#include <array>
#include <sstream>
#include <string_view>

namespace stridor {
namespace {

/// Sections of a scene that do not change its bodies, contacts and drives.
constexpr std::array<std::string_view, 8> beside_mechanics = {
    "time", "initial", "record", "measure", "spectrogram", "checkpoint", "cycle", "expect"};

/// A resolved scene without them. Its sections begin in the first column.
std::string mechanical_part(const std::string& resolved) {
  std::istringstream lines(resolved);
  std::string part;
  bool is_kept = true;
  for (std::string line; std::getline(lines, line);) {
    if (!line.empty() && line.front() != ' ' && line.front() != '-') {
      const std::string_view name = std::string_view(line).substr(0, line.find(':'));
      is_kept = std::ranges::find(beside_mechanics, name) == beside_mechanics.end();
    }
    if (is_kept) part += line + "\n";
  }
  return part;
}

}  // namespace

bool has_same_mechanics(const SceneInFile& one, const SceneInFile& other) {
  if (one.hash == other.hash) return true;
  return one.resolved != other.resolved &&
         mechanical_part(one.resolved) == mechanical_part(other.resolved);
}

}  // namespace stridor
