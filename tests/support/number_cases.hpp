// Right and wrong ways to give a number in a scene, and what must be said of them.
#pragma once

#include <fmt/format.h>

#include <cmath>
#include <string>
#include <vector>

#include "core/schema.hpp"
#include "tests/support/scene_draft.hpp"

namespace stridor::test {

/// Unit and range of the numbers that a key takes.
struct NumberRules {
  std::string unit;
  Range range;
  bool is_integer = false;
  Range storable{};
};

/// A number and what must be said of it; nothing where it is right.
struct NumberCase {
  std::string text;
  std::string message;
  bool is_bound = false;  ///< an end of the range that belongs to it
};

inline constexpr const char* beyond_computation = "is beyond what can be computed with";

/// Whether products of a few such numbers neither overflow nor vanish.
inline bool is_computable(const NumberRules& rules, double value) {
  if (rules.is_integer) return true;
  const double size = std::abs(value);
  if (rules.unit.empty()) return size <= 1e100;
  return size == 0.0 || (size >= 1e-30 && size <= 1e30);
}

/// Numbers at, just below and just above the bounds of the range, and further away.
inline void add_range_cases(const NumberRules& rules, std::vector<NumberCase>& cases) {
  const Range& range = rules.range;
  const std::string refusal = "must be " + range.text();
  const auto next = [&](double value, double towards) {
    return rules.is_integer ? value + std::copysign(1.0, towards) : std::nextafter(value, towards);
  };
  for (const double bound : {range.low, range.high}) {
    if (!std::isfinite(bound)) continue;
    for (const double value :
         {next(bound, -HUGE_VAL), bound, next(bound, HUGE_VAL), bound - 10.0, bound + 10.0}) {
      const bool is_allowed = range.contains(value) && is_computable(rules, value);
      const std::string message = range.contains(value) ? beyond_computation : refusal;
      cases.push_back(
          {number_text(value), is_allowed ? "" : message, is_allowed && value == bound});
    }
    if (rules.is_integer || rules.unit.empty()) continue;
    const double outside = bound == range.low ? bound - 1.0 : bound + 1.0;
    const std::string text = number_text(outside) + " " + rules.unit;
    cases.push_back({text, refusal});
    cases.push_back({text, fmt::format("(written '{}')", text)});
  }
  if (rules.is_integer && rules.storable.high < range.high) {
    cases.push_back({fmt::format("{:.0f}", rules.storable.high + 1.0), "is too far from 0"});
  }
}

/// @param allowed a number that the rules allow
inline std::vector<NumberCase> number_cases(const NumberRules& rules, double allowed) {
  std::vector<NumberCase> cases;
  if (rules.is_integer) {
    for (const std::string text :
         {"1.5", "1e3", "1.0", "1 m", "1 apples", "1 2", "one", "true", "0x10", ".nan"}) {
      cases.push_back({text, fmt::format("expected a whole number without unit, got '{}'", text)});
    }
    cases.push_back({"''", "expected a whole number without unit, got ''"});
    cases.push_back({"=0.5", "must be a whole number, got 0.5 (written '=0.5')"});
  } else {
    for (const std::string text : {"long", "true", "1 2", "1.2.3", "1 2 m"}) {
      cases.push_back({text, fmt::format("'{}' is not a number, expected", text)});
    }
    cases.push_back({"'1,5'", "'1,5' is not a number, expected"});
    cases.push_back({"0x10", "is not a decimal number (hexadecimal is not read)"});
    cases.push_back({"''", "is empty, expected"});
    for (const std::string text : {".nan", "-.inf", "inf"}) {
      cases.push_back({text, fmt::format("must be finite, got '{}'", text)});
    }
    cases.push_back({"1e999", "must be finite"});
    const std::string other = rules.unit == "kg" ? "m" : "kg";
    cases.push_back({"1 " + other, fmt::format("'1 {0}' has unit {0}, expected", other)});
    cases.push_back({"1 xyzzy", "'1 xyzzy' has the unknown unit 'xyzzy', expected"});
    cases.push_back({"1 m or so", "has the unknown unit 'm or so', expected"});
    cases.push_back({rules.unit.empty() ? number_text(100.0 * allowed) + " %"
                                        : number_text(allowed) + " " + rules.unit,
                     ""});
  }
  cases.push_back({"=" + number_text(allowed), ""});
  cases.push_back({"=1/0", "'=1/0': 1 is divided by 0"});
  cases.push_back({"=nobody", "'=nobody', column 1: there is no parameter 'nobody'"});
  cases.push_back({"=2 +", "'=2 +', column 4: a number or a name is missing after '+'"});
  add_range_cases(rules, cases);
  return cases;
}

}  // namespace stridor::test
