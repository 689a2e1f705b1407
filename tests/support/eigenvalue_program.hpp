// The verbs of small motion by their JSON.
#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "tests/support/program.hpp"

namespace stridor::test {

using Json = nlohmann::json;

inline Json json_of(std::vector<std::string> arguments) {
  arguments.emplace_back("--json");
  const ProgramResult result = Program(arguments).run();
  EXPECT_EQ(result.exit_code, 0) << result.err;
  return Json::parse(result.out);
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
