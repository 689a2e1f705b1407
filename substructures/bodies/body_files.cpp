#include "substructures/bodies/body_files.hpp"

#include <algorithm>
#include <array>
#include <cctype>
#include <filesystem>
#include <string_view>

namespace stridor {

bool is_geometry(const std::string& name) {
  std::string ending = std::filesystem::path(name).extension().string();
  std::transform(ending.begin(), ending.end(), ending.begin(),
                 [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  constexpr std::array<std::string_view, 6> endings{".geo",  ".step", ".stp",
                                                    ".brep", ".iges", ".igs"};
  return std::find(endings.begin(), endings.end(), ending) != endings.end();
}

}  // namespace stridor
