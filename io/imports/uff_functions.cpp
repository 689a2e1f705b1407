#include "io/imports/uff_functions.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstring>
#include <optional>
#include <span>

#include "core/errors.hpp"
#include "io/imports/uff_lines.hpp"
#include "io/imports/uff_units.hpp"

namespace stridor {
namespace {

/// How the numbers of a function stand in the file, by record 7.
struct FunctionForm {
  bool is_double = false;
  bool is_complex = false;
  bool is_even = true;
  std::size_t count = 0;  ///< of values
  double first = 0.0;
  double increment = 0.0;

  std::size_t parts() const { return is_complex ? 2 : 1; }  ///< of a value
  /// Numbers that belong to one abscissa.
  std::size_t per_point() const { return parts() + (is_even ? 0 : 1); }
};

constexpr const char* dofs_expected =
    "type, number, version, case, then name, node and direction of response and reference (record 6)";

/// Record 6: 2(I5,I10), 2(1X,10A1,I10,I4). The names may hold blanks.
void read_dofs(const UffLine& line, UffFunction& function) {
  const auto integer = [&](std::size_t from, std::size_t width) -> std::int64_t {
    if (from >= line.text.size()) return 0;
    const std::string_view word = trimmed(line.text.substr(from, width));
    if (word.empty()) return 0;
    const auto number = integer_in(word);
    if (!number)
      refuse_at(line.place, fmt::format("expected {}, got '{}'", dofs_expected, shown(line.text)));
    return *number;
  };
  function.type = static_cast<int>(integer(0, 5));
  function.response = {integer(41, 10), static_cast<int>(integer(51, 4))};
  function.reference = {integer(66, 10), static_cast<int>(integer(76, 4))};
}

FunctionForm read_form(const UffLine& line) {
  constexpr std::array<std::size_t, 6> widths{10, 10, 10, 13, 13, 13};
  constexpr const char* expected =
      "type of the values, their number, spacing, first abscissa and increment (record 7)";
  const std::vector<double> numbers = uff_columns(line, widths, expected);
  if (numbers.size() < 5) refuse_at(line.place, fmt::format("expected {}", expected));
  FunctionForm form;
  const double kind = numbers[0];
  if (kind != 2 && kind != 4 && kind != 5 && kind != 6) {
    refuse_at(line.place, fmt::format("expected values of type 2 (real), 4 (real double), 5 "
                                      "(complex) or 6 (complex double), got {:g}",
                                      kind));
  }
  form.is_double = kind == 4 || kind == 6;
  form.is_complex = kind >= 5;
  form.is_even = numbers[2] != 0.0;
  constexpr double most_values = 1e9;
  if (!(numbers[1] >= 0.0) || numbers[1] > most_values || numbers[1] != std::round(numbers[1]))
    refuse_at(line.place, fmt::format("expected a number of values, got {:g}", numbers[1]));
  form.count = static_cast<std::size_t>(numbers[1]);
  form.first = numbers[3];
  form.increment = numbers[4];
  // An abscissa that does not rise is none.
  if (form.is_even && form.count > 1 && !(form.increment > 0.0))
    refuse_at(line.place, fmt::format("expected a positive increment, got {:g}", form.increment));
  return form;
}

/// Records 8 to 10: the quantity and the exponents of its units.
int read_quantity(const UffLine& line) {
  const std::string_view head = line.text.substr(0, std::min<std::size_t>(10, line.text.size()));
  const auto number = integer_in(trimmed(head));
  if (!number)
    refuse_at(line.place, fmt::format("expected the type of a quantity, got '{}'", shown(line.text)));
  return static_cast<int>(*number);
}

/// Numbers of the lines of a function in text, as far as they are there.
std::vector<double> text_numbers(UffReader& reader, const FunctionForm& form) {
  constexpr std::array<std::size_t, 1> single{13};
  constexpr std::array<std::size_t, 1> twice{20};
  constexpr std::array<std::size_t, 4> real_pairs{13, 20, 13, 20};
  constexpr std::array<std::size_t, 3> complex_pairs{13, 20, 20};
  const std::span<const std::size_t> widths =
      !form.is_double   ? std::span<const std::size_t>(single)
      : form.is_even    ? std::span<const std::size_t>(twice)
      : form.is_complex ? std::span<const std::size_t>(complex_pairs)
                        : std::span<const std::size_t>(real_pairs);
  constexpr const char* expected = "values of the function";
  const std::size_t wanted = form.count * form.per_point();
  std::vector<double> numbers;
  while (numbers.size() < wanted && (numbers.empty() || !reader.is_at_end())) {
    const std::vector<double> more = uff_columns(reader.line(expected), widths, expected);
    numbers.insert(numbers.end(), more.begin(), more.end());
  }
  // The last line may be padded.
  if (numbers.size() > wanted) numbers.resize(wanted);
  return numbers;
}

template <class Bits, class Real>
double number_of(const char* bytes, bool is_big_endian) {
  std::array<char, sizeof(Bits)> ordered{};
  for (std::size_t i = 0; i < sizeof(Bits); ++i)
    ordered[is_big_endian == (std::endian::native == std::endian::big) ? i : sizeof(Bits) - 1 - i] =
        bytes[i];
  return std::bit_cast<Real>(ordered);
}

/// Numbers of binary data, as far as they are there.
std::vector<double> binary_numbers(const UffDataset& dataset, const FunctionForm& form) {
  const UffBytes& data = *dataset.data;
  constexpr std::int64_t ieee = 2;
  if (data.format != ieee) {
    refuse_at(dataset.place, fmt::format("expected numbers of IEEE 754 (2), got the format {}",
                                         data.format));
  }
  const std::size_t of_value = form.is_double ? 8 : 4;
  const std::size_t of_values = of_value * form.parts();
  // Programs differ in how they write the abscissas beside numbers of 8 bytes.
  std::size_t of_abscissa = form.is_even ? 0 : of_value;
  if (form.is_double && !form.is_even && data.bytes.size() < form.count * (of_values + 8) &&
      data.bytes.size() >= form.count * (of_values + 4))
    of_abscissa = 4;
  const std::size_t count = std::min(form.count, data.bytes.size() / (of_values + of_abscissa));
  std::vector<double> numbers;
  numbers.reserve(count * form.per_point());
  const char* at = data.bytes.data();
  const auto take = [&](std::size_t size) {
    numbers.push_back(size == 4 ? number_of<std::uint32_t, float>(at, data.is_big_endian)
                                : number_of<std::uint64_t, double>(at, data.is_big_endian));
    at += size;
  };
  for (std::size_t i = 0; i < count; ++i) {
    if (of_abscissa > 0) take(of_abscissa);
    for (std::size_t part = 0; part < form.parts(); ++part) take(of_value);
  }
  return numbers;
}

/// SI units per unit of the file of a motion over a force.
double factor_of(const UffFunction& function, const UffUnits& units) {
  const auto of = [&](int quantity) {
    switch (static_cast<UffQuantity>(quantity)) {
      case UffQuantity::displacement:
      case UffQuantity::velocity:
      case UffQuantity::acceleration:
        return 1.0 / units.length;
      case UffQuantity::reaction_force:
      case UffQuantity::excitation_force:
        return 1.0 / units.force;
      default:
        return 1.0;
    }
  };
  return of(function.ordinate_quantity) / of(function.denominator_quantity);
}

void fill(UffFunction& function, const FunctionForm& form, const std::vector<double>& numbers,
          double factor) {
  const std::size_t step = form.per_point();
  const std::size_t first = form.is_even ? 0 : 1;
  const std::size_t count = numbers.size() / step;
  for (std::size_t i = 0; i < count; ++i) {
    const double* point = numbers.data() + i * step;
    function.abscissa.push_back(
        form.is_even ? form.first + form.increment * static_cast<double>(i) : point[0]);
    function.values.emplace_back(factor * point[first],
                                 form.is_complex ? factor * point[first + 1] : 0.0);
  }
}

/// A text of the file, which says NONE where there is none.
std::string word_or_none(std::string_view text) {
  const std::string_view word = trimmed(text);
  return word == "NONE" ? "" : std::string(word);
}

UffFunction read_function(const UffDataset& dataset, const UffUnits& units) {
  UffReader reader(dataset);
  UffFunction function;
  function.source = place_text(dataset.place);
  function.id = std::string(trimmed(reader.line("five lines of text").text));
  reader.skip(2, "five lines of text");
  function.note = word_or_none(reader.line("five lines of text").text);
  reader.skip(1, "five lines of text");
  read_dofs(reader.line(dofs_expected), function);
  const FunctionForm form =
      read_form(reader.line("type, number and spacing of the values (record 7)"));
  function.is_complex = form.is_complex;
  function.abscissa_quantity = read_quantity(reader.line("what the abscissa is (record 8)"));
  const UffLine& ordinate = reader.line("what the values are (record 9)");
  function.ordinate_quantity = read_quantity(ordinate);
  // I10, 3I5, 2(1X,20A1): the second text is the unit.
  if (ordinate.text.size() > 47) function.units = word_or_none(ordinate.text.substr(47));
  function.denominator_quantity = read_quantity(reader.line("what they are divided by (record 10)"));
  reader.skip(1, "record 11");
  fill(function, form,
       dataset.data ? binary_numbers(dataset, form) : text_numbers(reader, form),
       factor_of(function, units));
  if (form.count > 0 && function.values.empty())
    refuse_at(dataset.place,
              fmt::format("expected {} values of the function, got none", form.count));
  function.num_missing = form.count - function.values.size();
  return function;
}

}  // namespace

UffFunctions functions_in(const std::vector<UffDataset>& datasets) {
  const UffUnits units = units_in(datasets);
  UffFunctions all;
  for (const UffDataset& dataset : datasets) {
    if (dataset.type != 58) continue;
    all.functions.push_back(read_function(dataset, units));
    const UffFunction& one = all.functions.back();
    if (one.num_missing == 0) continue;
    all.remarks.push_back(fmt::format(
        "{}: {} of {} values are missing at the end of the function; the {} that are there are "
        "used",
        one.source, one.num_missing, one.values.size() + one.num_missing, one.values.size()));
  }
  if (!units.is_given) all.remarks.emplace_back(no_units);
  return all;
}

UffFunctions read_uff_functions(const SourceText& source) {
  const std::vector<UffDataset> datasets = uff_datasets(source);
  UffFunctions all = functions_in(datasets);
  if (!all.functions.empty()) return all;
  const auto num_shapes =
      std::ranges::count(datasets, 55, [](const UffDataset& dataset) { return dataset.type; });
  refuse_at(
      {&source, 0},
      fmt::format("expected functions (dataset 58); there are {} datasets and none of these{}",
                  datasets.size(),
                  num_shapes > 0 ? fmt::format(", but {} with shapes (55), which `stridor eig "
                                               "SCENE --compare FILE` sets beside those of a scene",
                                               num_shapes)
                                 : ""));
}

UffFunctions read_uff_functions_file(const std::string& path) {
  return read_uff_functions(read_source_text(path, "a universal file (.uff, .unv)"));
}

}  // namespace stridor
