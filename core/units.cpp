#include "core/units.hpp"

#include <fmt/format.h>
#include <udunits2.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <limits>
#include <map>
#include <memory>
#include <mutex>
#include <numbers>
#include <optional>
#include <stdexcept>
#include <string_view>
#include <utility>

#include "core/errors.hpp"
#include "core/suggestion.hpp"

namespace stridor {
namespace {

constexpr std::string_view blanks = " \t";

struct FreeSystem {
  void operator()(ut_system* system) const { ut_free_system(system); }
};
struct FreeUnit {
  void operator()(ut_unit* unit) const { ut_free(unit); }
};
using SystemHandle = std::unique_ptr<ut_system, FreeSystem>;
using UnitHandle = std::unique_ptr<ut_unit, FreeUnit>;

/// A unit as a factor times powers of basic units. The radian counts as a basic unit here: UDUNITS
/// holds it for dimensionless, which would turn 50 Hz into 50 rad/s.
struct UnitMeaning {
  double factor = 1.0;
  std::map<std::string, int> powers;
  bool is_scale = true;  ///< false for units with an offset or a logarithm (°C, dB)

  bool has_angle() const { return powers.contains("rad"); }
};

std::string basic_name(const ut_unit* unit) {
  if (const char* symbol = ut_get_symbol(unit, UT_ASCII)) return symbol;
  const char* name = ut_get_name(unit, UT_ASCII);
  return name ? name : "?";
}

UnitMeaning& meaning_in(void* arg) {
  return *static_cast<UnitMeaning*>(arg);
}

ut_status see_basic(const ut_unit* unit, void* arg) {
  ++meaning_in(arg).powers[basic_name(unit)];
  return UT_SUCCESS;
}

ut_status see_product(const ut_unit*, int count, const ut_unit* const* units, const int* powers,
                      void* arg) {
  for (int i = 0; i < count; ++i) {
    if (powers[i] != 0) meaning_in(arg).powers[basic_name(units[i])] += powers[i];
  }
  return UT_SUCCESS;
}

ut_status see_galilean(const ut_unit*, double scale, const ut_unit* underlying, double offset,
                       void* arg);

ut_status see_timestamp(const ut_unit*, const ut_unit*, double, void* arg) {
  meaning_in(arg).is_scale = false;
  return UT_SUCCESS;
}

ut_status see_logarithmic(const ut_unit*, double, const ut_unit*, void* arg) {
  meaning_in(arg).is_scale = false;
  return UT_SUCCESS;
}

const ut_visitor visitor{see_basic, see_product, see_galilean, see_timestamp, see_logarithmic};

ut_status see_galilean(const ut_unit*, double scale, const ut_unit* underlying, double offset,
                       void* arg) {
  meaning_in(arg).factor *= scale;
  if (offset != 0.0) meaning_in(arg).is_scale = false;
  return ut_accept_visitor(underlying, &visitor, arg);
}

/// A unit that scenes use often.
struct CommonUnit {
  std::string_view symbol;
  double factor;
  std::array<std::pair<const char*, int>, 3> powers;  ///< those of no name count nothing
};

constexpr std::pair<const char*, int> no_power{nullptr, 0};
constexpr std::array<CommonUnit, 21> common_units{{
    {"m", 1.0, {{{"m", 1}, no_power, no_power}}},
    {"cm", 1e-2, {{{"m", 1}, no_power, no_power}}},
    {"mm", 1e-3, {{{"m", 1}, no_power, no_power}}},
    {"um", 1e-6, {{{"m", 1}, no_power, no_power}}},
    {"s", 1.0, {{{"s", 1}, no_power, no_power}}},
    {"ms", 1e-3, {{{"s", 1}, no_power, no_power}}},
    {"us", 1e-6, {{{"s", 1}, no_power, no_power}}},
    {"kg", 1.0, {{{"kg", 1}, no_power, no_power}}},
    {"g", 1e-3, {{{"kg", 1}, no_power, no_power}}},
    {"N", 1.0, {{{"kg", 1}, {"m", 1}, {"s", -2}}}},
    {"mN", 1e-3, {{{"kg", 1}, {"m", 1}, {"s", -2}}}},
    {"kN", 1e3, {{{"kg", 1}, {"m", 1}, {"s", -2}}}},
    {"Pa", 1.0, {{{"kg", 1}, {"m", -1}, {"s", -2}}}},
    {"kPa", 1e3, {{{"kg", 1}, {"m", -1}, {"s", -2}}}},
    {"MPa", 1e6, {{{"kg", 1}, {"m", -1}, {"s", -2}}}},
    {"GPa", 1e9, {{{"kg", 1}, {"m", -1}, {"s", -2}}}},
    {"Hz", 1.0, {{{"s", -1}, no_power, no_power}}},
    {"kHz", 1e3, {{{"s", -1}, no_power, no_power}}},
    {"MHz", 1e6, {{{"s", -1}, no_power, no_power}}},
    {"rad", 1.0, {{{"rad", 1}, no_power, no_power}}},
    {"deg", std::numbers::pi / 180.0, {{{"rad", 1}, no_power, no_power}}},
}};

/// "m", "m2", "s-1": multiplies a meaning by a common unit to a power. @return false if it is none
bool multiply(UnitMeaning& meaning, std::string_view factor, int sign) {
  const std::size_t letters = factor.find_first_of("-123");
  int power = 1;
  if (letters != std::string_view::npos) {
    const std::string_view exponent = factor.substr(letters);
    const auto [end, status] =
        std::from_chars(exponent.data(), exponent.data() + exponent.size(), power);
    if (status != std::errc() || end != exponent.data() + exponent.size()) return false;
  }
  const std::string_view symbol = factor.substr(0, letters);
  const auto* const unit =
      std::find_if(common_units.begin(), common_units.end(),
                   [&](const CommonUnit& common) { return common.symbol == symbol; });
  if (unit == common_units.end()) return false;
  power *= sign;
  meaning.factor *= std::pow(unit->factor, power);
  for (const auto& [name, basic_power] : unit->powers)
    if (name != nullptr) meaning.powers[name] += power * basic_power;
  return true;
}

/// A product of common units, perhaps over one of them, without the database, whose 200 kB take
/// longer to read than a scene. @return nothing for any other text
std::optional<UnitMeaning> common_meaning(std::string_view unit) {
  UnitMeaning meaning;
  const std::size_t slash = unit.find('/');
  std::string_view rest = unit.substr(0, slash);
  if (rest == "1" && slash != std::string_view::npos) rest = {};
  while (!rest.empty()) {
    const std::size_t blank = std::min(rest.find(' '), rest.size());
    if (!multiply(meaning, rest.substr(0, blank), 1)) return std::nullopt;
    rest.remove_prefix(std::min(blank + 1, rest.size()));
  }
  if (slash != std::string_view::npos && !multiply(meaning, unit.substr(slash + 1), -1))
    return std::nullopt;
  if (unit.empty()) return std::nullopt;
  std::erase_if(meaning.powers, [](const auto& power) { return power.second == 0; });
  return meaning;
}

/// The unit database. UDUNITS keeps global state while it parses, hence one lock for all of it.
class UnitSystem {
 public:
  /// @returns false where the text is no unit.
  bool read(const std::string& unit, UnitMeaning& meaning) {
    if (const auto common = common_meaning(unit)) {
      meaning = *common;
      return true;
    }
    const std::lock_guard<std::mutex> lock(mutex_);
    load();
    const UnitHandle parsed(ut_parse(system_.get(), unit.c_str(), UT_UTF8));
    return parsed && ut_accept_visitor(parsed.get(), &visitor, &meaning) == UT_SUCCESS;
  }

 private:
  void load() {
    if (system_) return;
    ut_set_error_message_handler(ut_ignore);
    SystemHandle system(ut_read_xml(nullptr));
    if (!system) {
      throw FileError("udunits2.xml", "",
                      "the database of units cannot be read; install libudunits2-data or let "
                      "UDUNITS2_XML_PATH name the file");
    }
    const UnitHandle degree(ut_get_unit_by_name(system.get(), "degree"));
    if (degree) ut_map_symbol_to_unit("deg", UT_ASCII, degree.get());
    system_ = std::move(system);
  }

  std::mutex mutex_;
  SystemHandle system_;
};

UnitSystem& unit_system() {
  static UnitSystem system;
  return system;
}

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
  throw std::invalid_argument(message);
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

double convert(double value, const UnitMeaning& from, const UnitMeaning& to) {
  // 9 mm must be the same double as 0.009: dividing by 1000 rounds once, while the factor 0.001 is
  // itself rounded and the product is then off by one unit in the last place. The tolerance is that
  // of the few products from which the database makes a factor.
  constexpr double rounding = 16.0 * std::numeric_limits<double>::epsilon();
  constexpr double largest = 1e12;
  const double factor = from.factor / to.factor;
  const double multiplier = std::round(factor);
  if (factor >= 1.0 && factor < largest && std::abs(multiplier / factor - 1.0) < rounding) {
    return value * multiplier;
  }
  const double divisor = std::round(1.0 / factor);
  if (factor < 1.0 && divisor < largest && std::abs(divisor * factor - 1.0) < rounding) {
    return value / divisor;
  }
  return value * factor;
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
  UnitMeaning meaning;
  if (!unit_system().read(is_inverse ? "1/" + std::string(after_one) : unit, meaning)) {
    refuse(fmt::format("'{}' has the unknown unit '{}', expected {}{}", split.written, unit,
                       expected, suggest_unit(unit)));
  }
  return meaning;
}

/// "kg m-1 s-2" from the powers of basic units.
std::string unit_text(const UnitMeaning& meaning) {
  std::string text;
  for (const auto& [name, power] : meaning.powers) {
    if (power == 0) continue;
    if (!text.empty()) text += ' ';
    text += name;
    if (power != 1) text += std::to_string(power);
  }
  return text;
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
  if (!unit.empty() && !(unit_system().read(unit, expected) && expected.is_scale)) {
    throw std::logic_error(
        fmt::format("parse_quantity: '{}' is declared as a unit but is none", unit));
  }
  if (unit.empty() || !meaning.is_scale || meaning.powers != expected.powers) {
    refuse(fmt::format("'{}' has unit {}, expected {}{}", split.written, split.unit, wanted,
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
    refuse(fmt::format("'{}' has unit {}, which is no multiple of an SI unit", split.written,
                       split.unit));
  }
  UnitMeaning basic;
  basic.powers = meaning.powers;
  const Quantity quantity{convert(split.number, meaning, basic), unit_text(meaning)};
  if (!std::isfinite(quantity.value)) refuse_magnitude(split.written);
  return quantity;
}

}  // namespace stridor
