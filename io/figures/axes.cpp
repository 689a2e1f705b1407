#include "io/figures/axes.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdlib>
#include <limits>
#include <numeric>
#include <string_view>

namespace stridor {
namespace {

// A blank at which no line ends.
constexpr const char* no_break = "\u00a0";

std::string superscript(int number) {
  static const std::array<const char*, 10> digits{"⁰", "¹", "²", "³", "⁴", "⁵", "⁶", "⁷", "⁸", "⁹"};
  std::string text = number < 0 ? "⁻" : "";
  for (const char c : std::to_string(std::abs(number)))
    text += digits[static_cast<std::size_t>(c - '0')];
  return text;
}

// The SI prefix of a power of thousand; empty where there is none (and for 10⁰).
std::string prefix_of(int exponent) {
  static const std::array<const char*, 9> prefixes{"f", "p", "n", "µ", "m", "", "k", "M", "G"};
  const int index = exponent / 3 + 5;
  if (exponent % 3 != 0 || index < 0 || index >= static_cast<int>(prefixes.size())) return {};
  return prefixes[static_cast<std::size_t>(index)];
}

// Whether a prefix before the unit multiplies it as a whole: not so in "m²" or "1/s".
bool takes_prefix(const std::string& units) {
  static const std::array<const char*, 9> takers{"m",  "m/s", "m/s^2", "m/s²", "N",
                                                 "Pa", "J",   "s",     "Hz"};
  return std::find(takers.begin(), takers.end(), units) != takers.end();
}

std::string scaled_units(const std::string& units, const AxisScale& scale) {
  if (scale.exponent == 0) return units;
  const std::string prefix = prefix_of(scale.exponent);
  if (!prefix.empty() && takes_prefix(units)) return prefix + units;
  return "10" + superscript(scale.exponent) + (units.empty() ? "" : " " + units);
}

}  // namespace

void ValueRange::include(std::span<const double> values) {
  for (const double x : values) {
    if (!std::isfinite(x)) continue;
    lower = std::min(lower, x);
    upper = std::max(upper, x);
  }
}

ValueRange ValueRange::widened(double share) const {
  if (is_empty()) return {0.0, 1.0};
  double margin = share * (upper - lower);
  // Below this the number of digits in a double gives no axis.
  const double least = 1e-12 * std::max(std::abs(lower), std::abs(upper));
  if (upper - lower <= least) margin = upper == 0.0 ? 1.0 : 0.1 * std::abs(upper);
  return {lower - margin, upper + margin};
}

std::size_t tick_characters(const ValueRange& range, const AxisScale& scale) {
  const auto width = [&](double value) {
    return fmt::format("{:.{}f}", as_number(value, scale), scale.decimals).size();
  };
  return std::max(width(range.lower), width(range.upper));
}

void FigureScript::add_text(const std::string& text, double x, double y, const char* how,
                            double font_size) {
  add("set label {} {} at screen {:.6f}, screen {:.6f} {} font ',{:g}'", next_label_++,
      gnuplot_string(text), across(x), up(y), how, font_size > 0.0 ? font_size : size_.font_size);
}

void FigureScript::add_caption(const std::vector<std::string>& lines, double left, double top) {
  for (std::size_t i = 0; i < lines.size(); ++i) {
    add_text(lines[i], left, top - (static_cast<double>(i) + 0.5) * line_height(caption_font),
             "left", caption_font);
  }
}

void FigureScript::set_palette(std::span<const char* const> colours) {
  append("set palette defined (");
  for (std::size_t i = 0; i < colours.size(); ++i)
    append(fmt::format("{}{} '{}'", i == 0 ? "" : ", ", i, colours[i]));
  append(")\n");
}

void FigureScript::set_colour_bar(double left, double bottom, double width, double height) {
  add("set colorbox vertical user origin screen {:.6f}, screen {:.6f} size screen {:.6f}, screen "
      "{:.6f} noborder",
      across(left), up(bottom), across(width), up(height));
}

void FigureScript::set_margins(double left, double right, double bottom, double top) {
  add("set lmargin at screen {:.6f}\nset rmargin at screen {:.6f}", across(left), across(right));
  add("set bmargin at screen {:.6f}\nset tmargin at screen {:.6f}", up(bottom), up(top));
}

void FigureScript::set_axis(char axis, const ValueRange& range, const AxisScale& scale) {
  add("set {}range [{:.12g}:{:.12g}]", axis, as_number(range.lower, scale),
      as_number(range.upper, scale));
  add("set {}tics {:.12g} format '%.{}f'", axis, scale.step, scale.decimals);
}

void FigureScript::set_log_axis(char axis, const ValueRange& range) {
  std::string ticks;
  for (const LogTick& tick : log_ticks(range.lower, range.upper)) {
    ticks += fmt::format("{}{} {:.9g} {}", ticks.empty() ? "" : ", ", gnuplot_string(tick.text),
                         tick.value, tick.text.empty() ? 1 : 0);
  }
  add("set logscale {0}\nset {0}range [{1:.12g}:{2:.12g}]\nset {0}tics ({3})", axis, range.lower,
      range.upper, ticks);
}

std::vector<LogTick> log_ticks(double lower, double upper) {
  const auto first = static_cast<int>(std::floor(std::log10(lower)));
  const auto last = static_cast<int>(std::ceil(std::log10(upper)));
  const auto is_inside = [&](double value) {
    return value >= lower * (1.0 - 1e-9) && value <= upper * (1.0 + 1e-9);
  };
  int num_powers = 0;
  bool is_plain = true;
  for (int power = first; power <= last; ++power) {
    if (!is_inside(std::pow(10.0, power))) continue;
    ++num_powers;
    is_plain = is_plain && power >= -3 && power <= 4;
  }
  // More powers than there is room for are written every second, third or so.
  constexpr int most_powers = 10;
  const int stride = 1 + (num_powers - 1) / most_powers;
  std::vector<LogTick> ticks;
  for (int power = first; power <= last; ++power) {
    for (const int digit : {1, 2, 3, 4, 5, 6, 7, 8, 9}) {
      const double value = digit * std::pow(10.0, power);
      if (!is_inside(value)) continue;
      const bool is_written =
          (digit == 1 && power % stride == 0) || (num_powers < 3 && (digit == 2 || digit == 5));
      ticks.push_back({value, !is_written ? std::string()
                              : is_plain  ? fmt::format("{:.{}f}", value, std::max(0, -power))
                                          : fmt::format("{}e{}", digit, power)});
    }
  }
  return ticks;
}

AxisScale axis_scale(double lower, double upper, int num_ticks) {
  AxisScale scale;
  const double width = upper - lower;
  const double rough = width / num_ticks;
  double power = std::pow(10.0, std::floor(std::log10(rough)));
  double step = 10.0 * power;
  for (const double factor : {1.0, 2.0, 5.0}) {
    if (factor * power >= 0.999 * rough) {
      step = factor * power;
      break;
    }
  }
  double largest = std::max(std::abs(lower), std::abs(upper));
  if (step < 2e-5 * largest) {
    // A round number near the middle, a multiple of the step.
    const double coarse = std::pow(10.0, std::ceil(std::log10(width)));
    scale.offset = std::round(0.5 * (lower + upper) / coarse) * coarse;
    largest = std::max(std::abs(lower - scale.offset), std::abs(upper - scale.offset));
  }
  if (largest >= 1e5 || largest < 1e-2) {
    scale.exponent = 3 * static_cast<int>(std::floor(std::log10(largest) / 3.0));
  }
  scale.step = step / std::pow(10.0, scale.exponent);
  scale.decimals = std::max(0, -static_cast<int>(std::floor(std::log10(scale.step) + 1e-9)));
  return scale;
}

AxisScale spaced_scale(const ValueRange& range, int num_ticks, double length, double character) {
  AxisScale scale = axis_scale(range.lower, range.upper, num_ticks);
  for (; num_ticks > 2; --num_ticks) {
    scale = axis_scale(range.lower, range.upper, num_ticks);
    const double step = scale.step * std::pow(10.0, scale.exponent);
    const double between = length * step / (range.upper - range.lower);
    // A minus sign and the space between two numbers.
    if ((static_cast<double>(tick_characters(range, scale)) + 1.0) * character <= between) break;
  }
  return scale;
}

AxisScale frequency_scale(double highest, int num_ticks) {
  AxisScale scale = axis_scale(0.0, highest, num_ticks);
  if (scale.exponent != 0 || highest < 2000.0) return scale;
  scale.exponent = 3;
  scale.step /= 1000.0;
  scale.decimals = std::max(0, -static_cast<int>(std::floor(std::log10(scale.step) + 1e-9)));
  return scale;
}

double as_number(double value, const AxisScale& scale) {
  return (value - scale.offset) / std::pow(10.0, scale.exponent);
}

std::string axis_label(const std::string& label, const std::string& units, const AxisScale& scale) {
  const std::string unit = scaled_units(units, scale);
  return unit.empty() ? label : label + " (" + unit + ")";
}

std::string offset_text(const std::string& units, const AxisScale& scale) {
  if (scale.offset == 0.0) return "";
  return fmt::format("{} {:.10g} {}", scale.offset > 0.0 ? "minus" : "plus", std::abs(scale.offset),
                     units);
}

std::string offset_axis_label(const std::string& label, const std::string& units,
                              const AxisScale& scale) {
  std::string text = axis_label(label, units, scale);
  if (scale.offset != 0.0) text += ", " + offset_text(units, scale);
  return text;
}

std::string typeset_units(const std::string& units) {
  if (units == "1") return {};
  std::string text;
  for (std::size_t i = 0; i < units.size(); ++i) {
    const bool is_power =
        units[i] == '^' && i + 1 < units.size() && units[i + 1] >= '0' && units[i + 1] <= '9';
    if (is_power) {
      text += superscript(units[++i] - '0');
    } else {
      text += units[i];
    }
  }
  return text;
}

std::string quantity_text(double value, const std::string& units) {
  const std::string printed = typeset_units(units);
  if (value != 0.0 && std::isfinite(value) && takes_prefix(units)) {
    int exponent = 3 * static_cast<int>(std::floor(std::log10(std::abs(value)) / 3.0 + 1e-12));
    if (std::abs(value) / std::pow(10.0, exponent) >= 999.5)
      exponent += 3;  // "1 k" in three digits
    const std::string prefix = prefix_of(exponent);
    if (!prefix.empty() || exponent == 0)
      return fmt::format("{:.3g} {}{}", value / std::pow(10.0, exponent), prefix, printed);
  }
  return printed.empty() ? fmt::format("{:.3g}", value) : fmt::format("{:.3g} {}", value, printed);
}

std::string unbroken(std::string text) {
  for (std::size_t at = 0; (at = text.find(' ', at)) != std::string::npos;)
    text.replace(at, 1, no_break);
  return text;
}

std::string level_label(double reference, const std::string& units) {
  return "amplitude (dB re " + quantity_text(reference, units) + ")";
}

double line_height(double font_size) {
  return 1.35 * font_size * 2.54 / 72.0;
}

double caption_height(const std::vector<std::string>& lines) {
  return lines.empty() ? 0.0 : 0.2 + static_cast<double>(lines.size()) * line_height(caption_font);
}

double character_width(double font_size) {
  return 0.64 * font_size * 2.54 / 72.0;
}

double text_width(const std::string& text, double font_size) {
  // Bytes that begin a UTF-8 character.
  const auto count =
      std::count_if(text.begin(), text.end(), [](char c) { return (c & 0xc0) != 0x80; });
  return 0.52 * static_cast<double>(count) * font_size * 2.54 / 72.0;
}

std::vector<std::string> wrapped(const std::string& text, double font_size, double width) {
  std::vector<std::string> lines;
  std::string line;
  for (std::size_t begin = 0; begin < text.size();) {
    const std::size_t end = std::min(text.find(' ', begin), text.size());
    const std::string word = text.substr(begin, end - begin);
    const std::string longer = line.empty() ? word : line + ' ' + word;
    if (!line.empty() && text_width(longer, font_size) > width) {
      lines.push_back(line);
      line = word;
    } else {
      line = longer;
    }
    begin = end + 1;
  }
  if (!line.empty()) lines.push_back(line);
  for (std::string& done : lines) {
    for (std::size_t at = 0; (at = done.find(no_break, at)) != std::string::npos;)
      done.replace(at, std::string_view(no_break).size(), 1, ' ');
  }
  return lines;
}

std::vector<std::string> wrapped_label(const std::string& label, double font_size, double width) {
  const std::size_t unit = std::min(label.find('('), label.size());
  return wrapped(label.substr(0, unit) + unbroken(label.substr(unit)), font_size, width);
}

std::vector<int> rows_without_overlap(const std::vector<std::pair<double, double>>& intervals,
                                      int num_rows) {
  std::vector<std::size_t> order(intervals.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::stable_sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) {
    return intervals[a].first < intervals[b].first;
  });
  std::vector<double> ends(static_cast<std::size_t>(std::max(num_rows, 0)),
                           -std::numeric_limits<double>::infinity());
  std::vector<int> rows(intervals.size(), -1);
  for (const std::size_t i : order) {
    for (std::size_t row = 0; row < ends.size(); ++row) {
      if (ends[row] > intervals[i].first) continue;
      ends[row] = intervals[i].second;
      rows[i] = static_cast<int>(row);
      break;
    }
  }
  return rows;
}

}  // namespace stridor
