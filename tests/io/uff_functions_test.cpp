#include "io/imports/uff_functions.hpp"

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <complex>
#include <cstring>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "core/errors.hpp"
#include "io/results/uff_writer.hpp"
#include "tests/support/message_of.hpp"
#include "tests/support/uff_text.hpp"

namespace stridor {
namespace {

using namespace test;
using ::testing::AllOf;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::SizeIs;

std::string uff_dataset(const std::string& body, const std::string& end = "\n") {
  return "    -1" + end + body + "    -1" + end;
}

/// The eleven records before the values of a function.
/// @param kind  2, 4 real, 5, 6 complex; 4 and 6 in double precision
std::string records(int kind, std::size_t count, bool is_even, const std::string& first = "58") {
  return fmt::format(
      "{:>6}\nhammer test\nNONE\nNONE\nNONE\nNONE\n"
      "{:5}{:10}{:5}{:10} {:<10}{:10}{:4} {:<10}{:10}{:4}\n"
      "{:10}{:10}{:10}{:13.5E}{:13.5E}{:13.5E}\n"
      "{:10}{:5}{:5}{:5} {:<20} {:<20}\n{:10}{:5}{:5}{:5} {:<20} {:<20}\n"
      "{:10}{:5}{:5}{:5} {:<20} {:<20}\n{:10}{:5}{:5}{:5} {:<20} {:<20}\n",
      first, 4, 1, 0, 0, "pad tip", 12, -2, "NONE", 7, 3, kind, count, is_even ? 1 : 0,
      is_even ? 100.0 : 0.0, is_even ? 0.5 : 0.0, 0.0, 18, 0, 0, 0, "NONE", "NONE", 12, 0, 0, 0,
      "NONE", "NONE", 13, 0, 0, 0, "NONE", "NONE", 0, 0, 0, 0, "NONE", "NONE");
}

const std::vector<double> abscissa{100.0, 100.5, 101.0};
const std::vector<std::complex<double>> values{{1.25, -0.5}, {-2.0, 3.0e-7}, {4.0e5, 0.125}};

/// The numbers of the function in their order in the file, one part of the format each.
struct Part {
  double value = 0.0;
  bool is_double = false;
};

std::vector<Part> parts_of(int kind, bool is_even, bool has_double_abscissa) {
  std::vector<Part> parts;
  const bool is_double = kind == 4 || kind == 6;
  for (std::size_t i = 0; i < values.size(); ++i) {
    if (!is_even) parts.push_back({abscissa[i], has_double_abscissa});
    parts.push_back({values[i].real(), is_double});
    if (kind >= 5) parts.push_back({values[i].imag(), is_double});
  }
  return parts;
}

std::string text_of(int kind, bool is_even) {
  const bool is_double = kind == 4 || kind == 6;
  const std::size_t in_line = !is_double ? 6 : is_even || kind == 4 ? 4 : 3;
  std::string text;
  std::size_t i = 0;
  for (const Part& part : parts_of(kind, is_even, false)) {
    text += part.is_double ? fmt::format("{:20.12E}", part.value) : fmt::format("{:13.5E}", part.value);
    if (++i % in_line == 0) text += '\n';
  }
  if (i % in_line != 0) text += '\n';
  return uff_dataset(records(kind, values.size(), is_even) + text);
}

/// @param announced bytes that the head says; those that there are where nothing is given
std::string binary_of(int kind, bool is_even, bool is_big_endian, bool has_double_abscissa,
                      std::optional<std::size_t> announced = std::nullopt) {
  std::string bytes;
  const auto add = [&](const auto& number) {
    std::string raw(sizeof(number), '\0');
    std::memcpy(raw.data(), &number, sizeof(number));
    if (is_big_endian == (std::endian::native == std::endian::little))
      std::reverse(raw.begin(), raw.end());
    bytes += raw;
  };
  for (const Part& part : parts_of(kind, is_even, has_double_abscissa)) {
    if (part.is_double) {
      add(part.value);
    } else {
      add(static_cast<float>(part.value));
    }
  }
  const std::string head =
      fmt::format("    58b{:6}{:6}{:12}{:12}{:6}{:6}{:12}{:12}", is_big_endian ? 2 : 1, 2, 11,
                  announced.value_or(bytes.size()), 0, 0, 0, 0);
  const std::string text = records(kind, values.size(), is_even, head);
  return "    -1\n" + text + bytes + "    -1\n";  // the delimiter right behind the bytes
}

void expect_function(const std::string& text, int kind, double digits, const std::string& what) {
  SCOPED_TRACE(what);
  const UffFunctions all = read_uff_functions({"a.uff", text});
  ASSERT_THAT(all.functions, SizeIs(1));
  const UffFunction& function = all.functions[0];
  EXPECT_EQ(function.type, 4);
  EXPECT_EQ(function.id, "hammer test");
  EXPECT_EQ(function.response, (UffDof{12, -2}));
  EXPECT_EQ(function.reference, (UffDof{7, 3}));
  EXPECT_EQ(function.abscissa_quantity, 18);
  EXPECT_EQ(function.ordinate_quantity, 12);
  EXPECT_EQ(function.denominator_quantity, 13);
  EXPECT_EQ(function.is_complex, kind >= 5);
  ASSERT_THAT(function.values, SizeIs(values.size()));
  for (std::size_t i = 0; i < values.size(); ++i) {
    EXPECT_NEAR(function.abscissa[i], abscissa[i], 1e-5 * abscissa[i]);
    EXPECT_NEAR(function.values[i].real(), values[i].real(), digits * std::abs(values[i].real()));
    const double imag = kind >= 5 ? values[i].imag() : 0.0;
    EXPECT_NEAR(function.values[i].imag(), imag, digits * std::abs(imag));
  }
}

TEST(UffFunctions, AllEightFormsInTextAndBinary) {
  for (const int kind : {2, 4, 5, 6}) {
    for (const bool is_even : {true, false}) {
      const double digits = kind == 4 || kind == 6 ? 1e-12 : 1e-5;
      const std::string what = fmt::format("kind {}, {}", kind, is_even ? "even" : "uneven");
      expect_function(text_of(kind, is_even), kind, digits, what + ", text");
      for (const bool is_big_endian : {false, true}) {
        expect_function(binary_of(kind, is_even, is_big_endian, false), kind, digits,
                        what + (is_big_endian ? ", big endian" : ", little endian"));
        if (is_even || digits > 1e-9) continue;
        expect_function(binary_of(kind, is_even, is_big_endian, true), kind, digits,
                        what + ", abscissas of 8 bytes");
      }
    }
  }
}

TEST(UffFunctions, LineEndsPaddingAndMissingBlanksAreTolerated) {
  std::string windows;
  for (const char c : text_of(5, true)) windows += c == '\n' ? std::string("\r\n") : std::string(1, c);
  expect_function(windows, 5, 1e-5, "CRLF");
  std::string padded = text_of(5, true);
  padded.insert(padded.rfind("    -1"), "  0.00000E+00  0.00000E+00\n");
  expect_function(padded, 5, 1e-5, "padded");
  // Three digits of exponent fill the column.
  const std::string tight = uff_dataset(
      records(2, 3, true) + "-1.25000E+000-2.00000E+000-4.00000E+005\n");
  const UffFunction function = read_uff_functions({"a.uff", tight}).functions.at(0);
  EXPECT_EQ(function.values[0], -1.25);
  EXPECT_EQ(function.values[2], -4.0e5);
}

TEST(UffFunctions, UnitsOfTheFileBecomeSi) {
  const std::string units = uff_dataset(
      "   164\n         5mm (milli-newton)         2\n"
      "    1.0000000000000000D+03    1.0000000000000000D+03    1.0000000000000000D+00\n"
      "    2.7314999999999998D+02\n");
  const UffFunctions si = read_uff_functions({"a.uff", text_of(6, true)});
  EXPECT_THAT(si.remarks, ElementsAre(HasSubstr("taken to be SI")));
  // mm/s² per mN is m/s² per N.
  const UffFunctions file = read_uff_functions({"a.uff", units + text_of(6, true)});
  EXPECT_TRUE(file.remarks.empty());
  EXPECT_NEAR(std::abs(file.functions[0].values[0] - values[0]), 0.0, 1e-12);
  std::string inches = units;
  inches.replace(inches.find("1.0000000000000000D+03    1.0"), 22, "1.0000000000000000D+02");
  const UffFunctions other = read_uff_functions({"a.uff", inches + text_of(6, true)});
  EXPECT_NEAR(std::abs(other.functions[0].values[0] - 10.0 * values[0]), 0.0, 1e-11);
}

TEST(UffFunctions, WhatIsWrittenIsReadBack) {
  UffContents contents{.title = "brake", .program = "stridor 0.1.0", .date = "26-NOV-26",
                       .time = "17:24:09", .nodes = {{3, "pad.tip", {0.5, -0.25, 1e-3}}}, .functions = {}};
  UffFunction function;
  function.type = 4;
  function.id = "pad.tip.y.acceleration per pad.tip.y";
  function.response = {3, 2};
  function.reference = {3, -2};
  function.abscissa_quantity = 18;
  function.ordinate_quantity = 12;
  function.denominator_quantity = 13;
  function.is_complex = true;
  for (int i = 0; i < 301; ++i) {
    function.abscissa.push_back(20.0 + 12.5 * i);
    function.values.emplace_back(std::sin(0.1 * i) * std::pow(10.0, i % 13 - 6), -std::cos(0.3 * i));
  }
  contents.functions.push_back(function);
  const std::string text = uff_text(contents, "--output");
  std::size_t longest = 0;
  for (std::size_t at = 0, end; (end = text.find('\n', at)) != std::string::npos; at = end + 1)
    longest = std::max(longest, end - at);
  EXPECT_LE(longest, 80u);
  const UffFunctions all = read_uff_functions({"a.uff", text});
  EXPECT_TRUE(all.remarks.empty());
  const UffFunction& read = all.functions.at(0);
  EXPECT_EQ(read.id, function.id);
  EXPECT_EQ(read.response, function.response);
  EXPECT_EQ(read.reference, function.reference);
  EXPECT_EQ(read.abscissa, function.abscissa);
  for (std::size_t i = 0; i < function.values.size(); ++i)
    EXPECT_LE(std::abs(read.values[i] - function.values[i]), 1e-12 * std::abs(function.values[i]));

  const std::string binary = uff_text(contents, "--output", {UffForm::binary});
  const UffFunction whole = read_uff_functions({"a.uff", binary}).functions.at(0);
  EXPECT_EQ(whole.abscissa, function.abscissa);
  EXPECT_EQ(whole.values, function.values);
}

TEST(UffFunctions, UnevenAbscissasHaveSixDigitsInTextAndAllInBinary) {
  for (const bool is_complex : {false, true}) {
    UffContents contents{.title = "brake",
                         .program = "stridor",
                         .date = "26-NOV-26",
                         .time = "17:24:09",
                         .nodes = {},
                         .functions = {}};
    UffFunction function;
    function.type = 4;
    function.is_complex = is_complex;
    for (int i = 0; i < 7; ++i) {
      function.abscissa.push_back(20.0 * std::pow(10.0, i / 3.0));
      function.values.emplace_back(0.1 + i, is_complex ? -0.3 * i : 0.0);
    }
    contents.functions = {function, function};
    const std::string text = uff_text(contents, "-o");
    const UffFunctions read = read_uff_functions({"a.uff", text});
    const UffFunctions whole =
        read_uff_functions({"a.uff", uff_text(contents, "-o", {UffForm::binary})});
    ASSERT_THAT(read.functions, SizeIs(2));
    ASSERT_THAT(whole.functions, SizeIs(2));
    for (const std::size_t k : {0u, 1u}) {
      EXPECT_TRUE(whole.remarks.empty());
      EXPECT_EQ(whole.functions[k].abscissa, function.abscissa);
      EXPECT_EQ(whole.functions[k].values, function.values);
      ASSERT_THAT(read.functions[k].abscissa, SizeIs(7));
      for (std::size_t i = 0; i < 7; ++i) {
        // Half a unit of the sixth digit.
        EXPECT_NEAR(read.functions[k].abscissa[i] / function.abscissa[i], 1.0, 5e-6);
        EXPECT_LE(std::abs(read.functions[k].values[i] - function.values[i]),
                  1e-12 * std::abs(function.values[i]));
      }
    }
    contents.functions[0].abscissa[1] = 20.00001;
    EXPECT_THAT(
        message_of<ConfigError>([&] { uff_text(contents, "-o"); }),
        AllOf(HasSubstr("-o"), HasSubstr("20 and 20.00001 are the same"), HasSubstr("--binary")));
    EXPECT_NO_THROW(uff_text(contents, "-o", {UffForm::binary}));
  }
}

/// A function of one of the eight forms, its values and abscissas of a precision that 13 digits, or
/// 4 bytes and six digits, hold.
UffFunction formed(bool is_complex, bool is_even) {
  UffFunction function;
  function.type = 1;
  function.id = "pad.tip.y.acceleration";
  function.note = "low-passed to 4 kHz";
  function.units = "m/s^2";
  function.abscissa_quantity = 17;
  function.ordinate_quantity = 12;
  function.response = {2, 2};
  function.is_complex = is_complex;
  for (int i = 0; i < 1000; ++i) {
    function.abscissa.push_back(is_even ? 0.125 + 2.5e-4 * i : 0.5 * (i + 1) * (i + 2));
    // Of three decimals, on a scale of 30 decades.
    const auto value = [&](int k) {
      return ((k * 37) % 1999 - 999) * 1e-3 * std::pow(10.0, k % 31 - 15);
    };
    function.values.emplace_back(value(i), is_complex ? value(3 * i + 1) : 0.0);
  }
  return function;
}

TEST(UffFunctions, EightFormsAreWrittenAndReadBackToTheLastDigit) {
  for (const bool is_complex : {false, true}) {
    for (const bool is_even : {false, true}) {
      for (const UffPrecision precision :
           {UffPrecision::single_precision, UffPrecision::double_precision}) {
        UffContents contents{.title = "run",
                             .program = "stridor",
                             .date = "26-NOV-26",
                             .time = "17:24:09",
                             .nodes = {},
                             .functions = {formed(is_complex, is_even)}};
        const UffFunction& written = contents.functions[0];
        const bool is_single = precision == UffPrecision::single_precision;
        const int kind = (is_complex ? 5 : 2) + (is_single ? 0 : is_complex ? 1 : 2);
        for (const UffForm form : {UffForm::text, UffForm::binary}) {
          SCOPED_TRACE(fmt::format("kind {}, {}, {}", kind, is_even ? "even" : "uneven",
                                   form == UffForm::text ? "text" : "binary"));
          const std::string text = uff_text(contents, "-o", {form, precision});
          EXPECT_THAT(text,
                      HasSubstr(fmt::format("\n{:10}{:10}{:10}", kind, 1000, is_even ? 1 : 0)));
          const UffFunctions all = read_uff_functions({"a.uff", text});
          EXPECT_TRUE(all.remarks.empty());
          ASSERT_THAT(all.functions, SizeIs(1));
          const UffFunction& read = all.functions[0];
          EXPECT_EQ(read.is_complex, is_complex);
          EXPECT_EQ(read.note, written.note);
          EXPECT_EQ(read.units, "m/s^2");
          ASSERT_THAT(read.values, SizeIs(1000));
          const auto kept = [&](double value) {
            if (form == UffForm::text)
              return std::stod(is_single ? fmt::format("{:.5E}", value)
                                         : fmt::format("{:.12E}", value));
            return is_single ? static_cast<double>(static_cast<float>(value)) : value;
          };
          for (std::size_t i = 0; i < 1000; ++i) {
            // An even abscissa is a sum, an uneven one of this test has six digits.
            EXPECT_NEAR(read.abscissa[i], written.abscissa[i], 1e-15);
            EXPECT_EQ(read.values[i], std::complex<double>(kept(written.values[i].real()),
                                                           kept(written.values[i].imag())));
          }
        }
      }
    }
  }
}

TEST(UffFunctions, SinglePrecisionRefusesWhatItCannotHold) {
  UffContents contents{.title = "run",
                       .program = "stridor",
                       .date = "26-NOV-26",
                       .time = "17:24:09",
                       .nodes = {},
                       .functions = {formed(false, false)}};
  const UffNumbers single{UffForm::binary, UffPrecision::single_precision};
  contents.functions[0].abscissa[1] = contents.functions[0].abscissa[0] + 1e-9;
  EXPECT_THAT(message_of<ConfigError>([&] { uff_text(contents, "--data", single); }),
              AllOf(HasSubstr("--data"), HasSubstr("uneven times in seven digits"),
                    HasSubstr("--single"), HasSubstr("--from")));
  EXPECT_NO_THROW(uff_text(contents, "--data", {UffForm::binary}));
  contents.functions[0] = formed(false, true);
  contents.functions[0].values[3] = 1e39;
  EXPECT_THAT(message_of<ConfigError>([&] { uff_text(contents, "--data", single); }),
              AllOf(HasSubstr("reaches 1e+39"), HasSubstr("--single")));
  EXPECT_NO_THROW(uff_text(contents, "--data", {UffForm::text, UffPrecision::single_precision}));
}

TEST(UffFunctions, ALongFunctionIsHandedOnInPieces) {
  UffContents contents{.title = "run",
                       .program = "stridor",
                       .date = "26-NOV-26",
                       .time = "17:24:09",
                       .nodes = {},
                       .functions = {formed(false, true)}};
  UffFunction& function = contents.functions[0];
  for (int i = 1000; i < 200000; ++i) {
    function.abscissa.push_back(0.125 + 2.5e-4 * i);
    function.values.emplace_back(i);
  }
  for (const UffForm form : {UffForm::text, UffForm::binary}) {
    std::size_t longest = 0, total = 0;
    write_uff(contents, "-o",
              [&](std::string_view piece) {
                longest = std::max(longest, piece.size());
                total += piece.size();
              },
              {form});
    EXPECT_GT(total, 200000u * 8u);
    EXPECT_LT(longest, 70000u);
  }
}

TEST(UffFunctions, BinaryDataEndAtTheNextDelimiterWhereTheHeadIsWrong) {
  // pyuff announces half of the bytes of complex values, other programs none, or more than there
  // are.
  for (const std::size_t announced : {0u, 24u, 7u, 4711u}) {
    const std::string what = fmt::format("{} bytes announced", announced);
    expect_function(binary_of(6, true, false, false, announced), 6, 1e-12, what);
    const UffFunctions two =
        read_uff_functions({"a.uff", binary_of(6, true, false, false, announced) +
                                         binary_of(5, false, true, false, announced)});
    EXPECT_THAT(two.functions, SizeIs(2)) << what;
  }
}

TEST(UffFunctions, ValuesThatAreMissingAtTheEndAreCounted) {
  const auto short_of = [](const std::string& text, std::size_t kept, std::size_t announced) {
    SCOPED_TRACE(text);
    const UffFunctions all = read_uff_functions({"a.uff", text});
    ASSERT_THAT(all.functions, SizeIs(1));
    ASSERT_THAT(all.functions[0].values, SizeIs(kept));
    EXPECT_THAT(all.functions[0].abscissa, SizeIs(kept));
    EXPECT_EQ(all.functions[0].values[0], values[0]);
    EXPECT_EQ(all.functions[0].num_missing, announced - kept);
    EXPECT_THAT(all.remarks.front(),
                HasSubstr(fmt::format("a.uff:2: {} of {} values are missing at the end",
                                      announced - kept, announced)));
  };
  // A complex value of which the imaginary part is missing is missing.
  short_of(uff_dataset(records(5, 4, true) + "  1.25 -0.5  3.0\n"), 1, 4);
  short_of(uff_dataset(records(6, 3, false) + "  100.0  1.25 -0.5\n  100.5  3.0  0.0\n"), 2, 3);
  std::string cut = binary_of(6, true, false, false);
  cut.resize(cut.size() - 20);
  short_of(cut, 2, 3);
  // Both parts counted as values.
  std::string doubled = text_of(6, true);
  doubled.replace(doubled.find("         6         3"), 20, "         6         6");
  short_of(doubled, 3, 6);
}

TEST(UffFunctions, RefusesWithThePlaceAndWhatWasExpected) {
  const auto refusal = [](const std::string& text) {
    return message_of<ConfigError>([&] { read_uff_functions({"a.uff", text}); });
  };
  EXPECT_THAT(refusal(uff_dataset("   151\nhead\n")), HasSubstr("expected functions (dataset 58)"));
  EXPECT_THAT(refusal(uff_dataset(records(3, 2, true))),
              AllOf(HasSubstr("a.uff:9:"), HasSubstr("expected values of type 2")));
  EXPECT_THAT(refusal(uff_dataset(records(5, 1, true) + "  1.0  two\n")),
              AllOf(HasSubstr("a.uff:14:"), HasSubstr("two")));
  std::string still = records(2, 2, true);
  still.replace(still.find("5.00000E-01"), 11, "0.00000E+00");
  EXPECT_THAT(refusal(uff_dataset(still + "  1.0  2.0\n")), HasSubstr("positive increment"));
  EXPECT_THAT(refusal(uff_dataset(records(5, 4, true))),
              HasSubstr("expected values of the function"));
  EXPECT_THAT(refusal(uff_dataset(records(5, 4, true) + "  1.0\n")),
              HasSubstr("expected 4 values of the function, got none"));
  EXPECT_THAT(
      refusal(uff_dataset("    55\nshape\n")),
      HasSubstr("none of these, but 1 with shapes (55), which `stridor eig SCENE --compare FILE`"));
  // The head of binary data ends the file.
  EXPECT_THAT(
      refusal(
          "    -1\n   58b     1     2           0          24     0     0           0           0"),
      HasSubstr("five lines of text"));
  EXPECT_THAT(refusal("    -1\n   58b     1     2           0           0     0     0           0           0"),
              HasSubstr("five lines of text"));
  std::string vax = binary_of(6, true, false, false);
  vax.replace(vax.find("     1     2"), 12, "     1     1");
  EXPECT_THAT(refusal(vax), HasSubstr("IEEE 754"));
}

}  // namespace
}  // namespace stridor
