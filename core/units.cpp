#include "core/units.hpp"

#include <fmt/format.h>

#include <array>
#include <charconv>
#include <cmath>
#include <map>
#include <stdexcept>
#include <string_view>
#include <utility>
#include <vector>

#include "core/suggestion.hpp"
#include "core/unit_meaning.hpp"

namespace stridor {
namespace {

constexpr std::string_view blanks = " \t";

bool is_digit(char c) {
  return c >= '0' && c <= '9';
}
bool is_letter(char c) {
  // Bytes above 127 belong to µ, ° and the like.
  return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || static_cast<unsigned char>(c) > 127;
}

std::string trimmed(std::string_view text) {
  const std::size_t first = text.find_first_not_of(blanks);
  if (first == std::string_view::npos) return {};
  return std::string(text.substr(first, text.find_last_not_of(blanks) - first + 1));
}

/// "a length in m", for the units that scenes use most; "a value in N s m-1" for the others.
std::string expected_text(const std::string& unit) {
  static constexpr std::array<std::pair<std::string_view, std::string_view>, 12> quantities{
      {{"m", "a length"},
       {"s", "a time"},
       {"kg", "a mass"},
       {"N", "a force"},
       {"Pa", "a pressure or stress"},
       {"rad", "an angle"},
       {"Hz", "a frequency"},
       {"m/s", "a velocity"},
       {"m s-1", "a velocity"},
       {"kg m-3", "a density"},
       {"rad/s", "an angular velocity"},
       {"rad s-1", "an angular velocity"}}};
  if (unit.empty()) return "a number without unit";
  for (const auto& [symbol, quantity] : quantities) {
    if (unit == symbol) return fmt::format("{} in {}", quantity, unit);
  }
  return fmt::format("a value in {}", unit);
}

[[noreturn]] void refuse(const std::string& message) {
  throw QuantityError(Refusal::wrong_value, message);
}

[[noreturn]] void refuse_unit(const std::string& message) {
  throw QuantityError(Refusal::wrong_unit, message);
}

[[noreturn]] void refuse_number(const std::string& text, const std::string& expected) {
  refuse(fmt::format("'{}' is not a number, expected {}", text, expected));
}

/// UDUNITS multiplies by numbers inside a unit ("m 10", "s/3") and shifts by them ("K @ 273"). Here
/// a digit is part of a unit only as an exponent: m2, m-3, m^2, m**2.
bool has_free_number(std::string_view unit) {
  for (std::size_t i = 0; i < unit.size(); ++i) {
    if (!is_digit(unit[i]) || (i > 0 && is_digit(unit[i - 1]))) continue;
    std::size_t before = i;
    if (before > 0 && (unit[before - 1] == '-' || unit[before - 1] == '+')) --before;
    if (before == 0) return true;
    const char last = unit[before - 1];
    const bool is_power = last == '^' || (last == '*' && before > 1 && unit[before - 2] == '*');
    if (!is_letter(last) && last != ')' && !is_power) return true;
  }
  return false;
}

std::string suggest_unit(const std::string& written) {
  static const std::vector<std::string> common{
      "m",    "mm",    "um", "cm",  "km",  "s",   "ms",   "us",    "min",  "Hz",  "kHz", "MHz",
      "N",    "mN",    "kN", "Pa",  "kPa", "MPa", "GPa",  "kg",    "g",    "rad", "deg", "m/s",
      "mm/s", "rad/s", "J",  "N/m", "%",   "1/s", "m/s2", "kg/m3", "N/m2", "N m", "rpm"};
  return did_you_mean(written, common);
}

/// "rad/s" against "Hz" is the mistake that matters: both are 1/s to UDUNITS, apart by 2π.
std::string angle_hint(const UnitMeaning& written, const UnitMeaning& expected) {
  if (!written.has_angle() && !expected.has_angle()) return {};
  UnitMeaning without_angle = written;
  UnitMeaning expected_without_angle = expected;
  without_angle.powers.erase("rad");
  expected_without_angle.powers.erase("rad");
  if (without_angle.powers != expected_without_angle.powers) return {};
  if (expected.powers == std::map<std::string, int>{{"s", -1}}) {
    return " (an angular velocity is not converted to a frequency; divide by 2 pi)";
  }
  if (written.powers == std::map<std::string, int>{{"s", -1}}) {
    return " (a frequency is not converted to an angular velocity; multiply by 2 pi)";
  }
  return written.has_angle() ? " (it contains an angle)" : " (it contains no angle)";
}

[[noreturn]] void refuse_magnitude(const std::string& written) {
  refuse(fmt::format("'{}' is outside the range of double precision; it must be finite", written));
}

/// A number and the text of the unit behind it.
struct SplitQuantity {
  std::string written;  ///< both, without blanks around them
  double number = 0.0;
  std::string unit;  ///< may be empty
};

/// @param expected what the caller wants, for messages
SplitQuantity split_quantity(const std::string& text, const std::string& expected) {
  SplitQuantity split;
  split.written = trimmed(text);
  const std::string& written = split.written;
  if (written.empty()) refuse(fmt::format("is empty, expected {}", expected));

  // from_chars knows neither a leading '+' nor the locale; the sign is taken here so that "+-1"
  // does not pass.
  std::string_view rest = written;
  double sign = 1.0;
  if (rest.front() == '+' || rest.front() == '-') {
    if (rest.front() == '-') sign = -1.0;
    rest.remove_prefix(1);
  }
  for (const std::string_view name : {"nan", "NaN", "NAN", ".nan", ".NaN", ".NAN", "inf", "Inf",
                                      "INF", ".inf", ".Inf", ".INF", "infinity", "Infinity"}) {
    if (rest == name) refuse(fmt::format("must be finite, got '{}'", written));
  }
  const bool starts_number =
      !rest.empty() &&
      (is_digit(rest[0]) || (rest[0] == '.' && rest.size() > 1 && is_digit(rest[1])));
  if (!starts_number) refuse_number(written, expected);
  const auto [end, status] = std::from_chars(rest.data(), rest.data() + rest.size(), split.number);
  if (status == std::errc::result_out_of_range) refuse_magnitude(written);
  if (status != std::errc()) refuse_number(written, expected);
  rest.remove_prefix(static_cast<std::size_t>(end - rest.data()));
  split.number *= sign;
  split.unit = trimmed(rest);
  if (!split.unit.empty() && (rest.front() == 'x' || rest.front() == 'X')) {
    refuse(fmt::format("'{}' is not a decimal number (hexadecimal is not read), expected {}",
                       written, expected));
  }
  return split;
}

/// What the unit of a quantity means; there is one.
UnitMeaning read_unit(const SplitQuantity& split, const std::string& expected) {
  const std::string& unit = split.unit;
  const bool is_inverse = unit.starts_with("1/") || unit.starts_with('/');
  const std::string_view after_one =
      std::string_view(unit).substr(!is_inverse ? 0 : unit.find('/') + 1);
  const bool starts_unit =
      !after_one.empty() && (is_letter(after_one[0]) || after_one[0] == '(' ||
                             after_one[0] == '%' || after_one[0] == '\'' || after_one[0] == '"');
  if (!starts_unit) refuse_number(split.written, expected);
  if (has_free_number(after_one)) {
    refuse(fmt::format("'{}' holds a second number, expected one number and a unit: {}",
                       split.written, expected));
  }
  const auto meaning = meaning_of(is_inverse ? "1/" + std::string(after_one) : unit);
  if (!meaning) {
    refuse_unit(fmt::format("'{}' has the unknown unit '{}', expected {}{}", split.written, unit,
                            expected, suggest_unit(unit)));
  }
  return *meaning;
}

/// "1" and "%", which may follow a number without dimension.
bool is_dimensionless_sign(const std::string& unit) {
  return unit == "1" || unit == "%";
}
double with_sign(const SplitQuantity& split) {
  return split.unit == "%" ? split.number / 100.0 : split.number;
}

}  // namespace

double parse_quantity(const std::string& text, const std::string& unit) {
  const std::string wanted = expected_text(unit);
  const SplitQuantity split = split_quantity(text, wanted);
  if (split.unit.empty()) return split.number;
  if (unit.empty() && is_dimensionless_sign(split.unit)) return with_sign(split);
  const UnitMeaning meaning = read_unit(split, wanted);
  UnitMeaning expected;
  if (!unit.empty()) {
    const auto declared = meaning_of(unit);
    if (!declared || !declared->is_scale) {
      throw std::logic_error(
          fmt::format("parse_quantity: '{}' is declared as a unit but is none", unit));
    }
    expected = *declared;
  }
  if (unit.empty() || !meaning.is_scale || meaning.powers != expected.powers) {
    refuse_unit(
        fmt::format("'{}' has unit {}, expected {}{}", split.written, split.unit, wanted,
                    unit.empty() ? " (only '%' may follow)" : angle_hint(meaning, expected)));
  }
  const double value = convert(split.number, meaning, expected);
  if (!std::isfinite(value)) refuse_magnitude(split.written);
  return value;
}

Quantity parse_any_quantity(const std::string& text) {
  const std::string wanted = "a number, with a unit or without";
  const SplitQuantity split = split_quantity(text, wanted);
  if (split.unit.empty() || is_dimensionless_sign(split.unit)) return {with_sign(split), ""};
  const UnitMeaning meaning = read_unit(split, wanted);
  if (!meaning.is_scale) {
    refuse_unit(fmt::format("'{}' has unit {}, which is no multiple of an SI unit", split.written,
                            split.unit));
  }
  UnitMeaning basic;
  basic.powers = meaning.powers;
  const Quantity quantity{convert(split.number, meaning, basic), unit_text(meaning)};
  if (!std::isfinite(quantity.value)) refuse_magnitude(split.written);
  return quantity;
}

}  // namespace stridor
