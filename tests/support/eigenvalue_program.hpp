// The verbs of small motion by their JSON.
#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <complex>
#include <nlohmann/json.hpp>
#include <numbers>
#include <string>
#include <utility>
#include <vector>

#include "tests/support/program.hpp"

namespace stridor::test {

using Json = nlohmann::json;

// The scenes of the paper.
inline const std::string trailing = scene_path("beam_on_beam.yaml");
inline const std::string leading = scene_path("beam_on_beam_leading.yaml");

/// The JSON object that the program prints; null, with a failure, where it does not end well.
inline Json json_of(std::vector<std::string> arguments) {
  arguments.emplace_back("--json");
  const ProgramResult result = Program(arguments).run();
  EXPECT_EQ(result.exit_code, 0) << result.err;
  return result.exit_code == 0 ? Json::parse(result.out) : Json();
}

/// The same with values set in the scene.
inline Json scene_json(std::vector<std::string> arguments,
                       const std::vector<std::string>& sets = {}) {
  for (const std::string& set : sets) arguments.insert(arguments.end(), {"--set", set});
  return json_of(std::move(arguments));
}

inline std::complex<double> complex_of(const Json& eigenvalue) {
  return {eigenvalue[0].get<double>(), eigenvalue[1].get<double>()};
}

/// Those with positive imaginary part.
inline std::vector<std::complex<double>> vibrations(const Json& eigenvalues) {
  std::vector<std::complex<double>> found;
  for (const Json& one : eigenvalues)
    if (one[1] > 0.0) found.push_back(complex_of(one));
  return found;
}

struct Mode {
  double growth;     ///< 1/s
  double frequency;  ///< Hz
};

inline Mode mode_of(const Json& eigenvalue) {
  return {eigenvalue[0].get<double>(), eigenvalue[1].get<double>() / (2.0 * std::numbers::pi)};
}

inline std::vector<Mode> modes_of(const Json& eigenvalues) {
  std::vector<Mode> modes;
  for (const Json& one : eigenvalues) modes.push_back(mode_of(one));
  return modes;
}

struct Growth {
  int num_unstable = 0;
  double largest = -1e300;
};

inline Growth growth_of(const Json& eig) {
  Growth growth;
  for (const Json& s : eig["eigenvalues"]) {
    const double re = s[0].get<double>();
    growth.num_unstable += re > 1e-6 ? 1 : 0;
    growth.largest = std::max(growth.largest, re);
  }
  return growth;
}

}  // namespace stridor::test
