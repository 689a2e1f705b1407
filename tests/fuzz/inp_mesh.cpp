// Any text as an input of Abaqus or CalculiX, the part behind the first line "**FILE" as a file
// that it includes: it is read or refused with a place.
#include <cstdint>
#include <string>

#include "io/imports/inp_mesh.hpp"
#include "tests/fuzz/mesh_checks.hpp"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const std::string text(reinterpret_cast<const char*>(data), size);
  const std::string separator = "\n**FILE\n";
  const std::size_t end = text.find(separator);
  const std::string included = end == std::string::npos ? "" : text.substr(end + separator.size());
  const auto reader = [&](const std::string&, const std::string& file) -> stridor::SourceText {
    if (file != "a")
      throw stridor::FileError(stridor::Refusal::cannot_read, "fuzz.inp", "", "is not there");
    return {"fuzz.inp", included};
  };
  try {
    stridor::fuzz::expect_consistent(
        stridor::read_inp_mesh({"main.inp", text.substr(0, end)}, reader));
  } catch (const stridor::ConfigError& error) {
    stridor::fuzz::expect_placed(
        error, error.problems().front().source == "main.inp" ? "main.inp" : "fuzz.inp");
  }
  return 0;
}
