// Element types of Abaqus and CalculiX.
#pragma once

#include <optional>
#include <string>
#include <string_view>

#include "substructures/elements/mesh.hpp"

namespace stridor {

struct InpType {
  ElementShape shape = ElementShape::tri3;
  bool is_shell = false;  ///< its edges are E1, E2, ..., and S1 would be its face
};

/// @param name in capital letters: "C3D10"
std::optional<InpType> inp_type(std::string_view name);

/// Why a type is not read: "elements of type B31 are not supported; expected ...".
std::string refused_inp_type(std::string_view name);

}  // namespace stridor
