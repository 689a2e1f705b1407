// Any text as a universal file: it is read or refused with a place.
#include <cstddef>
#include <cstdint>
#include <string>

#include "core/errors.hpp"
#include "io/imports/uff_contents.hpp"
#include "io/imports/uff_file.hpp"
#include "io/imports/uff_functions.hpp"
#include "tests/fuzz/mesh_checks.hpp"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using stridor::fuzz::expect_that;
  const stridor::SourceText source{"fuzz.uff",
                                   std::string(reinterpret_cast<const char*>(data), size)};
  try {
    const stridor::ModalTest test = stridor::read_uff(source);
    expect_that(!test.modes.empty());
    for (const stridor::TestMode& mode : test.modes)
      expect_that(!mode.shape.empty() && mode.frequency >= 0.0);
  } catch (const stridor::ConfigError& error) {
    stridor::fuzz::expect_placed(error, "fuzz.uff");
  }
  try {
    for (const stridor::UffFunction& one : stridor::read_uff_functions(source).functions)
      expect_that(one.abscissa.size() == one.values.size());
  } catch (const stridor::ConfigError& error) {
    stridor::fuzz::expect_placed(error, "fuzz.uff");
  }
  try {
    const stridor::UffHoldings held = stridor::read_uff_holdings(source);
    for (const auto& line : held.shapes.lines) expect_that(line.size() > 1);
    for (const stridor::TestElement& element : held.shapes.elements)
      expect_that(element.nodes.size() ==
                  static_cast<std::size_t>(stridor::facts_of(element.shape).num_nodes));
  } catch (const stridor::ConfigError& error) {
    stridor::fuzz::expect_placed(error, "fuzz.uff");
  }
  return 0;
}
