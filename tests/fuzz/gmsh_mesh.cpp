// Any bytes as a mesh of Gmsh: it is read or refused with a place.
#include <cstdint>
#include <string>

#include "io/imports/gmsh_mesh.hpp"
#include "tests/fuzz/mesh_checks.hpp"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const std::string text(reinterpret_cast<const char*>(data), size);
  try {
    stridor::fuzz::expect_consistent(stridor::read_gmsh_mesh({"fuzz.msh", text}));
  } catch (const stridor::ConfigError& error) {
    stridor::fuzz::expect_placed(error, "fuzz.msh");
  }
  return 0;
}
