#include "app/stability/key_range.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "core/errors.hpp"

namespace stridor {

void add_range_options(CLI::App& verb, RangeOptions& options) {
  verb.add_option(
      "--parameter", options.parameter,
      "Key of the scene that varies, or drive.displacement: how far the drive has moved "
      "the bodies; default: contact.start, or with several pairs drive.displacement");
  verb.add_option("--from", options.from, "Its first value, SI or with a unit")->required();
  verb.add_option("--to", options.to, "Its last value")->required();
  verb.add_option("--points", options.points, "How many values, the ends included")
      ->check(CLI::Range(1, 1000000));
}

std::vector<double> range_values(const NumericKey& key, const RangeOptions& options,
                                 Spacing spacing) {
  const double from = parse_value(key, options.from, "--from");
  const double to = parse_value(key, options.to, "--to");
  if (from > to) {
    throw ConfigError(Refusal::wrong_value, "--from",
                      fmt::format("'{}' is beyond --to '{}'", options.from, options.to));
  }
  return spaced_values(key, from, to, options.points, spacing);
}

std::string printed_units(const NumericKey& key) {
  std::string above;
  std::string below;
  for (std::size_t begin = 0; begin < key.unit.size();) {
    const std::size_t end = std::min(key.unit.find(' ', begin), key.unit.size());
    std::string factor = key.unit.substr(begin, end - begin);
    begin = end + 1;
    const std::size_t digits = factor.find_first_of("-0123456789");
    std::string power = digits == std::string::npos ? "1" : factor.substr(digits);
    factor.erase(std::min(digits, factor.size()));
    const bool is_below = power.front() == '-';
    if (is_below) power.erase(0, 1);
    if (power != "1") factor += '^' + power;
    std::string& list = is_below ? below : above;
    list += (list.empty() ? "" : " ") + factor;
  }
  if (above.empty()) above = "1";
  return below.empty() ? above : above + '/' + below;
}

std::string value_text(const NumericKey& key, double value) {
  return fmt::format("{} = {:.9g}{}", key.path, value,
                     key.unit.empty() ? "" : " " + printed_units(key));
}

}  // namespace stridor
