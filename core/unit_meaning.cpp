#include "core/unit_meaning.hpp"

#include <udunits2.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <limits>
#include <memory>
#include <mutex>
#include <numbers>
#include <string_view>
#include <utility>

#include "core/errors.hpp"

namespace stridor {
namespace {

struct FreeSystem {
  void operator()(ut_system* system) const { ut_free_system(system); }
};
struct FreeUnit {
  void operator()(ut_unit* unit) const { ut_free(unit); }
};
using SystemHandle = std::unique_ptr<ut_system, FreeSystem>;
using UnitHandle = std::unique_ptr<ut_unit, FreeUnit>;

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
  /// @returns nothing where the text is no unit.
  std::optional<UnitMeaning> read(const std::string& unit) {
    if (const auto common = common_meaning(unit)) return common;
    const std::lock_guard<std::mutex> lock(mutex_);
    load();
    const UnitHandle parsed(ut_parse(system_.get(), unit.c_str(), UT_UTF8));
    UnitMeaning meaning;
    if (!parsed || ut_accept_visitor(parsed.get(), &visitor, &meaning) != UT_SUCCESS)
      return std::nullopt;
    return meaning;
  }

 private:
  void load() {
    if (system_) return;
    ut_set_error_message_handler(ut_ignore);
    SystemHandle system(ut_read_xml(nullptr));
    if (!system) {
      throw FileError(Refusal::cannot_read, "udunits2.xml", "",
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

}  // namespace

std::optional<UnitMeaning> meaning_of(const std::string& unit) {
  static UnitSystem system;
  return system.read(unit);
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

}  // namespace stridor
