#include "app/results/expectations.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <cmath>
#include <optional>
#include <string>

#include "app/terminal/remark.hpp"
#include "core/errors.hpp"

namespace stridor {
namespace {

/// A number at "a.b.c" of a JSON object; nothing where there is none.
std::optional<double> number_at(const Json& object, const std::string& path) {
  const Json* node = &object;
  std::size_t from = 0;
  while (true) {
    const std::size_t dot = path.find('.', from);
    const std::string key = path.substr(from, dot == std::string::npos ? dot : dot - from);
    const bool is_index =
        !key.empty() && key.size() < 10 &&
        std::all_of(key.begin(), key.end(), [](unsigned char c) { return std::isdigit(c) != 0; });
    if (node->is_array() && is_index && std::stoul(key) < node->size()) {
      node = &(*node)[std::stoul(key)];
    } else if (node->is_object() && node->contains(key)) {
      node = &(*node)[key];
    } else {
      return std::nullopt;
    }
    if (dot == std::string::npos) break;
    from = dot + 1;
  }
  if (!node->is_number()) return std::nullopt;
  return node->get<double>();
}

}  // namespace

std::vector<JudgedExpectation> judged(const std::vector<Expectation>& expectations,
                                      const Json& results) {
  std::vector<JudgedExpectation> all;
  for (const Expectation& expectation : expectations) {
    const auto value = number_at(results, expectation.result);
    all.push_back({expectation, value,
                   value && std::abs(*value - expectation.value) <= expectation.tolerance});
  }
  return all;
}

void check_expectations(const std::vector<Expectation>& expectations, const Json& results) {
  std::vector<std::string> failures;
  for (const auto& [expectation, value, is_met] : judged(expectations, results)) {
    if (!value) {
      failures.push_back(fmt::format("{}: expected {:g}, but the run has no such number",
                                     expectation.result, expectation.value));
    } else if (!is_met) {
      failures.push_back(fmt::format("{}: expected {:g} within {:g}, got {:.9g}",
                                     expectation.result, expectation.value, expectation.tolerance,
                                     *value));
    }
  }
  if (!failures.empty())
    throw NumericalError(Refusal::expectation_missed,
                         fmt::format("expectations not met:\n{}", fmt::join(failures, "\n")));
  print_remark("{} expectation(s) met\n", expectations.size());
}

}  // namespace stridor
