// Expectations of a scene about its results.
#pragma once

#include <optional>
#include <vector>

#include "app/terminal/command.hpp"
#include "io/scene/scene.hpp"

namespace stridor {

/// An expectation and the number that a run has for it.
struct JudgedExpectation {
  Expectation expectation;
  std::optional<double> value;  ///< nothing where the run has no such number
  bool is_met = false;
};

/// @param results JSON object; an expectation names a number in it by "a.b.c", an entry of a list by
///                its index from 0
std::vector<JudgedExpectation> judged(const std::vector<Expectation>& expectations,
                                      const Json& results);

/// Compares results with the `expect` block of a scene and reports on stderr how many were met.
/// @param results as of judged()
/// @throws NumericalError with a line for each that is not met or not there
void check_expectations(const std::vector<Expectation>& expectations, const Json& results);

}  // namespace stridor
