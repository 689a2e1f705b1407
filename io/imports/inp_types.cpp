#include "io/imports/inp_types.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <utility>

#include "io/imports/source_text.hpp"

namespace stridor {
namespace {

// Variants of integration and the like have the same nodes.
constexpr std::array<std::pair<std::string_view, InpType>, 36> inp_types{{
    {"CPS3", {ElementShape::tri3, false}},     {"CPE3", {ElementShape::tri3, false}},
    {"S3", {ElementShape::tri3, true}},        {"S3R", {ElementShape::tri3, true}},
    {"CPS6", {ElementShape::tri6, false}},     {"CPE6", {ElementShape::tri6, false}},
    {"CPS6M", {ElementShape::tri6, false}},    {"CPE6M", {ElementShape::tri6, false}},
    {"S6", {ElementShape::tri6, true}},        {"STRI65", {ElementShape::tri6, true}},
    {"CPS4", {ElementShape::quad4, false}},    {"CPE4", {ElementShape::quad4, false}},
    {"CPS4R", {ElementShape::quad4, false}},   {"CPE4R", {ElementShape::quad4, false}},
    {"CPS4I", {ElementShape::quad4, false}},   {"CPE4I", {ElementShape::quad4, false}},
    {"S4", {ElementShape::quad4, true}},       {"S4R", {ElementShape::quad4, true}},
    {"CPS8", {ElementShape::quad8, false}},    {"CPE8", {ElementShape::quad8, false}},
    {"CPS8R", {ElementShape::quad8, false}},   {"CPE8R", {ElementShape::quad8, false}},
    {"S8", {ElementShape::quad8, true}},       {"S8R", {ElementShape::quad8, true}},
    {"C3D4", {ElementShape::tet4, false}},     {"C3D10", {ElementShape::tet10, false}},
    {"C3D10M", {ElementShape::tet10, false}},  {"C3D10T", {ElementShape::tet10, false}},
    {"C3D8", {ElementShape::hex8, false}},     {"C3D8I", {ElementShape::hex8, false}},
    {"C3D8R", {ElementShape::hex8, false}},    {"C3D20", {ElementShape::hex20, false}},
    {"C3D20R", {ElementShape::hex20, false}},  {"C3D6", {ElementShape::wedge6, false}},
    {"C3D15", {ElementShape::wedge15, false}}, {"C3D20RI", {ElementShape::hex20, false}},
}};

}  // namespace

std::optional<InpType> inp_type(std::string_view name) {
  const auto* found = std::find_if(inp_types.begin(), inp_types.end(),
                                   [&](const auto& known) { return known.first == name; });
  return found == inp_types.end() ? std::nullopt : std::optional(found->second);
}

std::string refused_inp_type(std::string_view name) {
  const bool is_truss = name == "T3D2" || name == "T3D3";
  return fmt::format(
      "elements of type {} are not supported; expected C3D4, C3D10, C3D6, C3D15, C3D8, C3D20, or "
      "CPS3, CPS6, CPS4, CPS8 and their variants{}",
      shown(name), is_truss ? ": Gmsh writes its curves so, save the mesh as .msh instead" : "");
}

}  // namespace stridor
