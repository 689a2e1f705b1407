#include "io/results/uff_writer.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstdint>
#include <iterator>
#include <limits>
#include <optional>
#include <stdexcept>

#include "core/errors.hpp"
#include "io/imports/uff_elements.hpp"
#include "substructures/elements/mesh.hpp"

namespace stridor {
namespace {

/// The text cut to a line of the format, which holds 80 characters.
std::string record_text(const std::string& text) {
  constexpr std::size_t width = 80;
  if (text.size() <= width) return text;
  std::size_t end = width;
  // Not within a character of UTF-8, whose bytes but the first are 10xxxxxx.
  while (end > 0 && (static_cast<unsigned char>(text[end]) & 0xC0u) == 0x80u) --end;
  return text.substr(0, end);
}

void add_head(const UffContents& contents, std::string& text) {
  text += fmt::format("    -1\n   151\n{}\nNONE\n{}\n{:<10}{:<10}\n{}\n{:<10}{:<10}\n{}\n    -1\n",
                      record_text(contents.title), record_text(contents.program), contents.date,
                      contents.time, "NONE", contents.date, contents.time,
                      record_text(contents.program));
  // Code 1: metre, newton; factors of length, force and temperature, and of its zero.
  text += fmt::format("    -1\n   164\n{:10}{:<20}{:10}\n{:25.16E}{:25.16E}{:25.16E}\n{:25.16E}\n    -1\n",
                      1, "SI: m, N, kg", 2, 1.0, 1.0, 1.0, 273.15);
}

void add_nodes(const std::vector<UffNode>& nodes, std::string& text) {
  text += "    -1\n  2411\n";
  for (const UffNode& node : nodes) {
    text += fmt::format("{:10}{:10}{:10}{:10}\n{:25.16E}{:25.16E}{:25.16E}\n", node.number, 1, 1, 11,
                        node.place.x(), node.place.y(), node.place.z());
  }
  text += "    -1\n";
}

/// Labels of nodes, eight in a line of the file.
void add_labels(const std::vector<std::int64_t>& labels, const std::vector<int>& order, std::string& text) {
  for (std::size_t k = 0; k < labels.size(); ++k) {
    const std::int64_t label = order.empty() ? labels[k] : labels[static_cast<std::size_t>(order[k])];
    text += fmt::format("{:10}{}", label, (k + 1) % 8 == 0 || k + 1 == labels.size() ? "\n" : "");
  }
}

void add_elements(const std::vector<TestElement>& elements, std::string& text) {
  if (elements.empty()) return;
  constexpr int property = 1, material = 1, colour = 7;
  text += "    -1\n  2412\n";
  for (std::size_t i = 0; i < elements.size(); ++i) {
    const UffElementRecord record = element_record(elements[i].shape);
    if (elements[i].nodes.size() != static_cast<std::size_t>(facts_of(elements[i].shape).num_nodes))
      throw std::invalid_argument("write_uff: an element has not the nodes of its shape");
    text += fmt::format("{:10}{:10}{:10}{:10}{:10}{:10}\n", i + 1, record.kind, property, material, colour,
                        elements[i].nodes.size());
    add_labels(elements[i].nodes, record.order, text);
  }
  text += "    -1\n";
}

/// Trace lines (82): eight labels in a line of the file.
void add_lines(const std::vector<std::vector<std::int64_t>>& lines, std::string& text) {
  for (std::size_t i = 0; i < lines.size(); ++i) {
    text += fmt::format("    -1\n    82\n{:10}{:10}{:10}\nNONE\n", i + 1, lines[i].size(), 1);
    add_labels(lines[i], {}, text);
    text += "    -1\n";
  }
}

/// Data at nodes (55): a complex mode of the first order, three displacements at each node.
void add_mode(const UffMode& mode, const UffContents& contents, std::string& text) {
  if (mode.shape.size() != contents.nodes.size())
    throw std::invalid_argument("write_uff: a mode needs a value for each node");
  text += fmt::format("    -1\n    55\n{}\n{}\n{:<10}{:<10}\nlargest displacement 1\nNONE\n",
                      record_text(contents.title), record_text(contents.program), contents.date,
                      contents.time);
  constexpr int structural = 1, complex_mode = 3, translations = 2, displacement = 8, complex_data = 5;
  text += fmt::format("{:10}{:10}{:10}{:10}{:10}{:10}\n", structural, complex_mode, translations,
                      displacement, complex_data, 3);
  text += fmt::format("{:10}{:10}{:10}{:10}\n", 2, 6, 1, mode.number);
  text += fmt::format("{:13.5E}{:13.5E}{:13.5E}{:13.5E}{:13.5E}{:13.5E}\n", mode.eigenvalue.real(),
                      mode.eigenvalue.imag(), 0.0, 0.0, 0.0, 0.0);
  for (std::size_t i = 0; i < mode.shape.size(); ++i) {
    text += fmt::format("{:10}\n", contents.nodes[i].number);
    for (const std::complex<double>& value : mode.shape[i])
      text += fmt::format("{:13.5E}{:13.5E}", value.real(), value.imag());
    text += '\n';
  }
  text += "    -1\n";
}

/// First abscissa and increment as the format holds them.
struct EvenAbscissas {
  double first = 0.0;
  double increment = 0.0;
};

double of_six_digits(double value) {
  return std::stod(fmt::format("{:.5E}", value));
}

/// Nothing where the abscissas are not those that the first and the increment give in six digits.
std::optional<EvenAbscissas> even_abscissas(const std::vector<double>& abscissa) {
  EvenAbscissas even{of_six_digits(abscissa.front()), 0.0};
  if (abscissa.size() > 1) even.increment = of_six_digits(abscissa[1] - abscissa[0]);
  for (std::size_t i = 0; i < abscissa.size(); ++i) {
    const double there = even.first + even.increment * static_cast<double>(i);
    if (!(std::abs(there - abscissa[i]) <= 1e-9 * std::abs(abscissa.back()))) return std::nullopt;
  }
  return even;
}

/// An uneven abscissa as the form holds it.
double kept_abscissa(double value, UffNumbers numbers) {
  if (numbers.form == UffForm::text) return of_six_digits(value);
  return numbers.precision == UffPrecision::single_precision
             ? static_cast<double>(static_cast<float>(value))
             : value;
}

/// @throws ConfigError if abscissas are the same in the digits that the form holds
void require_different(const UffFunction& function, const std::string& key, UffNumbers numbers) {
  const std::vector<double>& abscissa = function.abscissa;
  double before = kept_abscissa(abscissa.front(), numbers);
  for (std::size_t i = 1; i < abscissa.size(); ++i) {
    const double here = kept_abscissa(abscissa[i], numbers);
    if (here > before) {
      before = here;
      continue;
    }
    const bool is_text = numbers.form == UffForm::text;
    const bool is_of_time = function.abscissa_quantity == static_cast<int>(UffQuantity::time);
    throw ConfigError(
        Refusal::wrong_value, key,
        fmt::format(
            "universal files {} hold uneven {} in {}, in which {:.9g} and {:.9g} are the "
            "same; choose {}, or {}",
            is_text ? "in text" : "in single precision", is_of_time ? "times" : "frequencies",
            is_text ? "six digits" : "seven digits", abscissa[i - 1], abscissa[i],
            !is_text                                              ? "double precision (no --single)"
            : numbers.precision == UffPrecision::single_precision ? "--binary without --single"
                                                                  : "--binary",
            is_of_time ? "a stretch that begins at a round time (--from), its samples as far "
                         "apart as six digits say (record.interval of the scene)"
                       : "fewer points"));
  }
}

/// @throws ConfigError if a value has no number in 4 bytes
void require_in_range(const UffFunction& function, const std::string& key, UffNumbers numbers) {
  if (numbers.form == UffForm::text || numbers.precision == UffPrecision::double_precision) return;
  constexpr double largest = std::numeric_limits<float>::max();
  for (const std::complex<double>& value : function.values) {
    if (std::max(std::abs(value.real()), std::abs(value.imag())) <= largest) continue;
    throw ConfigError(
        Refusal::wrong_value, key,
        fmt::format("'{}' reaches {:.3g}, but numbers of 4 bytes end at {:.3g}; choose "
                    "double precision (no --single)",
                    function.id, std::abs(value), largest));
  }
}

std::string quantity_record(int quantity, const char* label, const char* unit) {
  return fmt::format("{:10}{:5}{:5}{:5} {:<20} {:<20}\n", quantity, 0, 0, 0, label, unit);
}

/// @param units of values whose quantity has no number in the format
std::string record_of(int quantity, const std::string& units = "") {
  switch (static_cast<UffQuantity>(quantity)) {
    case UffQuantity::displacement:
      return quantity_record(quantity, "displacement", "m");
    case UffQuantity::velocity:
      return quantity_record(quantity, "velocity", "m/s");
    case UffQuantity::acceleration:
      return quantity_record(quantity, "acceleration", "m/s^2");
    case UffQuantity::reaction_force:
    case UffQuantity::excitation_force:
      return quantity_record(quantity, "force", "N");
    case UffQuantity::frequency:
      return quantity_record(quantity, "frequency", "Hz");
    case UffQuantity::time:
      return quantity_record(quantity, "time", "s");
    case UffQuantity::general:
      break;
  }
  return quantity_record(quantity, "NONE", units.empty() ? "NONE" : units.substr(0, 20).c_str());
}

/// Records 6 to 11: of what the function is, and how its numbers stand.
void add_records(const UffFunction& function, std::size_t number,
                 const std::optional<EvenAbscissas>& even, UffPrecision precision,
                 std::string& text) {
  text += fmt::format("{:5}{:10}{:5}{:10} {:<10}{:10}{:4} {:<10}{:10}{:4}\n", function.type, number, 0,
                      0, "NONE", function.response.node, function.response.direction, "NONE",
                      function.reference.node, function.reference.direction);
  constexpr int real_single = 2, real_double = 4, complex_single = 5, complex_double = 6;
  const int kind = precision == UffPrecision::single_precision
                       ? (function.is_complex ? complex_single : real_single)
                       : (function.is_complex ? complex_double : real_double);
  text += fmt::format("{:10}{:10}{:10}{:13.5E}{:13.5E}{:13.5E}\n", kind, function.values.size(),
                      even ? 1 : 0, even ? even->first : 0.0, even ? even->increment : 0.0, 0.0);
  text += record_of(function.abscissa_quantity) +
          record_of(function.ordinate_quantity, function.units) +
          record_of(function.denominator_quantity) + record_of(0);
}

/// Hands a text on where it has become long.
void hand_on(std::string& text, const TextSink& sink) {
  constexpr std::size_t piece = 1 << 16;
  if (text.size() < piece) return;
  sink(text);
  text.clear();
}

/// 6E13.5 in single precision. In double precision 4E20.12; at uneven abscissas 2(E13.5, E20.12),
/// or E13.5, 2E20.12 of complex values.
void add_text_numbers(const UffFunction& function, bool is_even, UffPrecision precision,
                      std::string& text, const TextSink& sink) {
  const bool is_single = precision == UffPrecision::single_precision;
  const std::size_t per_point = (function.is_complex ? 2 : 1) + (is_even ? 0 : 1);
  const std::size_t points_in_line = (is_single ? 6 : 4) / per_point;
  const auto add = [&](double value) {
    if (is_single) {
      fmt::format_to(std::back_inserter(text), "{:13.5E}", value);
    } else {
      fmt::format_to(std::back_inserter(text), "{:20.12E}", value);
    }
  };
  for (std::size_t i = 0; i < function.values.size(); ++i) {
    if (!is_even) fmt::format_to(std::back_inserter(text), "{:13.5E}", function.abscissa[i]);
    add(function.values[i].real());
    if (function.is_complex) add(function.values[i].imag());
    if ((i + 1) % points_in_line == 0 || i + 1 == function.values.size()) text += '\n';
    hand_on(text, sink);
  }
}

/// Numbers of IEEE 754 in 4 or 8 bytes, the lowest first.
void add_binary_numbers(const UffFunction& function, bool is_even, UffPrecision precision,
                        std::string& text, const TextSink& sink) {
  const bool is_single = precision == UffPrecision::single_precision;
  const auto add = [&](double value) {
    const std::uint64_t bits = is_single ? std::bit_cast<std::uint32_t>(static_cast<float>(value))
                                         : std::bit_cast<std::uint64_t>(value);
    for (unsigned byte = 0; byte < (is_single ? 4u : 8u); ++byte)
      text += static_cast<char>(static_cast<unsigned char>((bits >> (8 * byte)) & 0xff));
  };
  for (std::size_t i = 0; i < function.values.size(); ++i) {
    if (!is_even) add(function.abscissa[i]);
    add(function.values[i].real());
    if (function.is_complex) add(function.values[i].imag());
    hand_on(text, sink);
  }
}

}  // namespace

void write_uff_function(const UffFunction& function, std::size_t number,
                        const UffContents& contents, const std::string& key, const TextSink& sink,
                        UffNumbers numbers) {
  if (function.abscissa.empty() || function.abscissa.size() != function.values.size())
    throw std::invalid_argument("write_uff: abscissas and values are not as many");
  const std::optional<EvenAbscissas> even = even_abscissas(function.abscissa);
  if (!even) require_different(function, key, numbers);
  require_in_range(function, key, numbers);
  const bool is_binary = numbers.form == UffForm::binary;
  std::string text = "    -1\n    58";
  if (is_binary) {
    constexpr int lowest_first = 1, ieee_754 = 2, num_lines = 11;
    const std::size_t per_point = (even ? 0 : 1) + (function.is_complex ? 2 : 1);
    const std::size_t of_number = numbers.precision == UffPrecision::single_precision ? 4 : 8;
    text += fmt::format("b{:6}{:6}{:12}{:12}{:6}{:6}{:12}{:12}", lowest_first, ieee_754, num_lines,
                        of_number * per_point * function.values.size(), 0, 0, 0, 0);
  }
  text += fmt::format("\n{}\n{}\n{:<10}{:<10}\n{}\nNONE\n", record_text(function.id),
                      record_text(contents.program), contents.date, contents.time,
                      function.note.empty() ? "NONE" : record_text(function.note));
  add_records(function, number, even, numbers.precision, text);
  if (is_binary) {
    add_binary_numbers(function, even.has_value(), numbers.precision, text, sink);
  } else {
    add_text_numbers(function, even.has_value(), numbers.precision, text, sink);
  }
  text += "    -1\n";
  sink(text);
}

void UffContents::stamp(const std::string& utc) {
  constexpr std::array months{"JAN", "FEB", "MAR", "APR", "MAY", "JUN",
                              "JUL", "AUG", "SEP", "OCT", "NOV", "DEC"};
  const auto month = static_cast<std::size_t>(std::stoi(utc.substr(5, 2))) - 1;
  date = fmt::format("{}-{}-{}", utc.substr(8, 2), months.at(month), utc.substr(2, 2));
  time = utc.substr(11, 8);
}

void write_uff(const UffContents& contents, const std::string& key, const TextSink& sink,
               UffNumbers numbers) {
  std::string text;
  add_head(contents, text);
  if (!contents.nodes.empty()) add_nodes(contents.nodes, text);
  add_elements(contents.elements, text);
  add_lines(contents.lines, text);
  for (const UffMode& mode : contents.modes) {
    add_mode(mode, contents, text);
    hand_on(text, sink);
  }
  sink(text);
  for (std::size_t i = 0; i < contents.functions.size(); ++i)
    write_uff_function(contents.functions[i], i + 1, contents, key, sink, numbers);
}

}  // namespace stridor
