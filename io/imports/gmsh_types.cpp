#include "io/imports/gmsh_types.hpp"

#include <fmt/format.h>

#include <algorithm>

namespace stridor {
namespace {

constexpr std::array<std::uint8_t, 20> as_in_gmsh{0,  1,  2,  3,  4,  5,  6,  7,  8,  9,
                                                  10, 11, 12, 13, 14, 15, 16, 17, 18, 19};

constexpr std::array<GmshType, 13> types_read{{
    {15, 0, 1, 1, std::nullopt, as_in_gmsh},
    {1, 1, 2, 2, std::nullopt, as_in_gmsh},
    {8, 1, 2, 3, std::nullopt, as_in_gmsh},
    {2, 2, 3, 3, ElementShape::tri3, as_in_gmsh},
    {9, 2, 3, 6, ElementShape::tri6, as_in_gmsh},
    {3, 2, 4, 4, ElementShape::quad4, as_in_gmsh},
    {16, 2, 4, 8, ElementShape::quad8, as_in_gmsh},
    {4, 3, 4, 4, ElementShape::tet4, as_in_gmsh},
    {11, 3, 4, 10, ElementShape::tet10, {0, 1, 2, 3, 4, 5, 6, 7, 9, 8}},
    {5, 3, 8, 8, ElementShape::hex8, as_in_gmsh},
    {17, 3, 8, 20, ElementShape::hex20, {0,  1, 2,  3,  4,  5,  6,  7,  8,  11,
                                         13, 9, 16, 18, 19, 17, 10, 12, 14, 15}},
    {6, 3, 6, 6, ElementShape::wedge6, as_in_gmsh},
    {18, 3, 6, 15, ElementShape::wedge15, {0, 1, 2, 3, 4, 5, 6, 9, 7, 12, 14, 13, 8, 10, 11}},
}};

}  // namespace

const GmshType* gmsh_type(std::int64_t number) {
  const auto* type = std::find_if(types_read.begin(), types_read.end(),
                                  [&](const GmshType& known) { return known.number == number; });
  return type == types_read.end() ? nullptr : type;
}

std::string refused_gmsh_type(std::int64_t number) {
  const char* incomplete =
      "have nodes inside of faces or volumes; mesh with Mesh.ElementOrder = 2 and "
      "Mesh.SecondOrderIncomplete = 1";
  switch (number) {
    case 10:
      return fmt::format("quadrangles of 9 nodes (type 10) {}", incomplete);
    case 12:
      return fmt::format("hexahedra of 27 nodes (type 12) {}", incomplete);
    case 13:
      return fmt::format("prisms of 18 nodes (type 13) {}", incomplete);
    case 7:
    case 14:
    case 19:
      return fmt::format(
          "pyramids (type {}) are not supported; mesh with tetrahedra, hexahedra and prisms alone",
          number);
    default:
      return fmt::format(
          "elements of type {} are not supported; mesh with Mesh.ElementOrder = 1 or 2 and "
          "Mesh.SecondOrderIncomplete = 1",
          number);
  }
}

}  // namespace stridor
