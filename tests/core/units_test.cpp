#include "core/units.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <numbers>
#include <random>
#include <stdexcept>
#include <thread>
#include <vector>

#include <fmt/format.h>

namespace stridor {
namespace {

using testing::AllOf;
using testing::HasSubstr;
using testing::Not;

/// Message of parse_quantity where it throws; "" where it does not.
std::string refusal(const std::string& text, const std::string& unit) {
  try {
    parse_quantity(text, unit);
  } catch (const std::invalid_argument& error) {
    return error.what();
  }
  return {};
}

TEST(ParseQuantity, BareNumberIsInTheExpectedUnit) {
  EXPECT_EQ(parse_quantity("0.075", "m"), 0.075);
  EXPECT_EQ(parse_quantity("-0.20", "N"), -0.2);
  EXPECT_EQ(parse_quantity("2770", "kg m-3"), 2770.0);
  EXPECT_EQ(parse_quantity("0.33", ""), 0.33);
}

TEST(ParseQuantity, DecimalNotationsAreRead) {
  EXPECT_EQ(parse_quantity("+1.5", "m"), 1.5);
  EXPECT_EQ(parse_quantity(".5", "m"), 0.5);
  EXPECT_EQ(parse_quantity("-.5", "m"), -0.5);
  EXPECT_EQ(parse_quantity("5.", "m"), 5.0);
  EXPECT_EQ(parse_quantity("1e-5", "s"), 1e-5);
  EXPECT_EQ(parse_quantity("4.0E+8", "Pa"), 4e8);
  EXPECT_EQ(parse_quantity("  7  ", "m"), 7.0);
}

TEST(ParseQuantity, LeadingZeroIsNotOctal) {
  EXPECT_EQ(parse_quantity("010", "m"), 10.0);
}

TEST(ParseQuantity, UnitsOfTheMainSceneAreConvertedExactly) {
  EXPECT_EQ(parse_quantity("75 mm", "m"), 0.075);
  EXPECT_EQ(parse_quantity("1.5mm", "m"), 0.0015);
  EXPECT_EQ(parse_quantity("2.38 GPa", "Pa"), 2.38e9);
  EXPECT_EQ(parse_quantity("30 mm/s", "m/s"), 0.03);
  EXPECT_EQ(parse_quantity("30 mm/s", "m s-1"), 0.03);
  EXPECT_EQ(parse_quantity("2.5 kHz", "Hz"), 2500.0);
  EXPECT_EQ(parse_quantity("1.2 g/cm3", "kg m-3"), 1200.0);
  EXPECT_EQ(parse_quantity("10 us", "s"), 1e-5);
  EXPECT_EQ(parse_quantity("10 µm", "m"), 1e-5);
  EXPECT_EQ(parse_quantity("5e3 N m-2", "Pa"), 5000.0);
  EXPECT_EQ(parse_quantity("40 1/s", "s-1"), 40.0);
  EXPECT_EQ(parse_quantity("40 /s", "s-1"), 40.0);
  EXPECT_EQ(parse_quantity("3 m^2", "m2"), 3.0);
}

TEST(ParseQuantity, MillimetresEqualTheDecimalInMetres) {
  // Both texts name the same decimal number; the conversion may not add a rounding of its own.
  std::mt19937 generator(20240501);
  for (int i = 0; i < 2000; ++i) {
    const int digits = std::uniform_int_distribution<int>(0, 99999)(generator);
    EXPECT_EQ(parse_quantity(fmt::format("{} mm", digits), "m"),
              parse_quantity(fmt::format("{}e-3", digits), "m"))
        << digits;
  }
}

TEST(ParseQuantity, AnglesAreInRadians) {
  // pi/180 is rounded in the database and again here: two ulp of the result.
  const double right_angle = std::numbers::pi / 2.0;
  const double tolerance = 2.0 * right_angle * std::numeric_limits<double>::epsilon();
  EXPECT_NEAR(parse_quantity("90 deg", "rad"), right_angle, tolerance);
  EXPECT_NEAR(parse_quantity("90°", "rad"), right_angle, tolerance);
  EXPECT_NEAR(parse_quantity("90 degrees", "rad"), right_angle, tolerance);
  EXPECT_EQ(parse_quantity("1.5 rad", "rad"), 1.5);
  EXPECT_NEAR(parse_quantity("60 rpm", "rad/s"), 2.0 * std::numbers::pi, 8.0 * tolerance);
}

TEST(ParseQuantity, PercentIsTheOnlyUnitOfADimensionlessNumber) {
  EXPECT_EQ(parse_quantity("30 %", ""), 0.3);
  EXPECT_EQ(parse_quantity("30%", ""), 0.3);
  EXPECT_EQ(parse_quantity("0.3 1", ""), 0.3);
  for (const std::string unit : {"m", "rad", "deg", "ppm", "1/s", "m/m"}) {
    EXPECT_THAT(refusal("0.3 " + unit, ""),
                AllOf(HasSubstr("has unit " + unit), HasSubstr("expected a number without unit")));
  }
}

TEST(ParseQuantity, WrongDimensionNamesBothUnits) {
  EXPECT_EQ(refusal("30 kg", "m"), "'30 kg' has unit kg, expected a length in m");
  EXPECT_EQ(refusal("30 mm", "N s m-1"), "'30 mm' has unit mm, expected a value in N s m-1");
  EXPECT_EQ(refusal("30 %", "m"), "'30 %' has unit %, expected a length in m");
}

TEST(ParseQuantity, OnlyANumberHasAWrongUnit) {
  const auto kind = [](const std::string& text, const std::string& unit) {
    try {
      parse_quantity(text, unit);
    } catch (const QuantityError& error) {
      return error.refusal();
    }
    return Refusal::internal_error;
  };
  for (const char* text : {"abc", "", "mm", "nan", "0x10", "1e999", "5 5", "3 m 10"})
    EXPECT_EQ(kind(text, "m"), Refusal::wrong_value) << text;
  for (const char* text : {"3 kg", "3 furble", "3 %", "-.5 m/s"})
    EXPECT_EQ(kind(text, "m"), Refusal::wrong_unit) << text;
  EXPECT_EQ(kind("3 mm", ""), Refusal::wrong_unit);
}

TEST(ParseQuantity, ReciprocalIsNotConverted) {
  // UDUNITS would turn 2 s into 0.5 Hz.
  EXPECT_THAT(refusal("2 s", "Hz"), HasSubstr("has unit s, expected a frequency in Hz"));
  EXPECT_THAT(refusal("2 Hz", "s"), HasSubstr("has unit Hz, expected a time in s"));
}

TEST(ParseQuantity, AngularVelocityIsNotAFrequency) {
  for (const std::string unit : {"rad/s", "rpm", "deg/s"}) {
    EXPECT_THAT(refusal("100 " + unit, "Hz"),
                AllOf(HasSubstr("has unit " + unit), HasSubstr("expected a frequency in Hz"),
                      HasSubstr("divide by 2 pi")));
  }
  EXPECT_THAT(refusal("100 Hz", "rad/s"),
              AllOf(HasSubstr("has unit Hz, expected an angular velocity in rad/s"),
                    HasSubstr("multiply by 2 pi")));
}

TEST(ParseQuantity, AngleInAnotherUnitIsRefused) {
  EXPECT_THAT(refusal("3 N m/rad", "N m"), HasSubstr("it contains an angle"));
  EXPECT_THAT(refusal("3 N m", "N m rad-1"), HasSubstr("it contains no angle"));
  EXPECT_THAT(refusal("3 %", "rad"), HasSubstr("expected an angle in rad"));
}

TEST(ParseQuantity, UnknownUnitIsNamedWithSuggestion) {
  EXPECT_EQ(refusal("2 GPA", "Pa"),
            "'2 GPA' has the unknown unit 'GPA', expected a pressure or stress in Pa, did you mean "
            "'GPa'?");
  EXPECT_THAT(refusal("2 furble", "m"),
              AllOf(HasSubstr("unknown unit 'furble'"), Not(HasSubstr("did you"))));
}

TEST(ParseQuantity, TextIsNotANumber) {
  for (const std::string text : {"abc", "m", "-", "+", ".", "e5", "+-1", "--1", "1,5", "1_000",
                                 "1 000", "1/3", "1.2.3", "true", "$5", "1 -m", "- 1"}) {
    EXPECT_THAT(refusal(text, "m"),
                HasSubstr("'" + text + "' is not a number, expected a length in m"))
        << text;
  }
}

TEST(ParseQuantity, NothingIsEmpty) {
  EXPECT_EQ(refusal("", "m"), "is empty, expected a length in m");
  EXPECT_EQ(refusal("   ", ""), "is empty, expected a number without unit");
}

TEST(ParseQuantity, NotFiniteIsRefused) {
  for (const std::string text : {"nan", "inf", "-inf", ".inf", "-.inf", ".NaN", "Infinity", "1e999",
                                 "-1e400", "1e300 Gm", "1e308 km"}) {
    EXPECT_THAT(refusal(text, "m"), HasSubstr("must be finite")) << text;
  }
}

TEST(ParseQuantity, HexadecimalIsRefused) {
  EXPECT_THAT(refusal("0x10", "m"), HasSubstr("hexadecimal is not read"));
  EXPECT_THAT(refusal("0X1p3", ""), HasSubstr("hexadecimal is not read"));
}

TEST(ParseQuantity, SecondNumberInTheUnitIsRefused) {
  for (const std::string text : {"5 m 10", "5 m/3", "5 m * 2", "5 m -2", "5 m @ 3", "5 s from 3",
                                 "5 s since 1990-01-01", "5 m2.5"}) {
    EXPECT_THAT(refusal(text, "m"), HasSubstr("holds a second number")) << text;
  }
}

TEST(ParseQuantity, ScalesWithOffsetOrLogarithmAreRefused) {
  EXPECT_THAT(refusal("5 degC", "K"), HasSubstr("has unit degC, expected a value in K"));
  EXPECT_THAT(refusal("5 dBm", "W"), HasSubstr("expected a value in W"));
}

TEST(ParseQuantity, DeclaredUnitThatIsNoneIsABug) {
  try {
    parse_quantity("5 m", "furble");
    FAIL() << "accepted";
  } catch (const std::logic_error& error) {
    EXPECT_THAT(error.what(), HasSubstr("'furble' is declared as a unit"));
  }
}

TEST(ParseQuantity, ShortestDecimalIsReadBackExactly) {
  std::mt19937_64 generator(7);
  int finite = 0;
  while (finite < 2000) {
    const auto bits = generator();
    const double value = std::bit_cast<double>(bits);
    if (!std::isfinite(value)) continue;
    ++finite;
    EXPECT_EQ(parse_quantity(fmt::format("{}", value), "m"), value);
  }
}

TEST(ParseQuantity, CommonUnitsMeanWhatTheDatabaseSays) {
  // In parentheses a unit is read from the database.
  const std::vector<std::string> units{
      "m",     "cm",    "mm",     "um",    "s",    "ms",    "us",    "kg",     "g",
      "N",     "mN",    "kN",     "Pa",    "kPa",  "MPa",   "GPa",   "Hz",     "kHz",
      "MHz",   "rad",   "deg",    "m/s",   "m2",   "s-1",   "1/s",   "m-3",    "N/m",
      "N/mm",  "kg/m3", "kg m-3", "g/cm3", "N m",  "mm/s2", "rad/s", "deg/ms", "N s/m",
      "kg m2", "Pa s",  "m s-1",  "mm-2",  "1/ms2"};
  for (const std::string& unit : units) {
    for (const char* number : {"1", "0.3", "2.38", "7.77e-5"}) {
      const Quantity common = parse_any_quantity(std::string(number) + " " + unit);
      const std::string inner =
          unit.starts_with("1/") ? "1/(" + unit.substr(2) + ")" : "(" + unit + ")";
      const Quantity expected = parse_any_quantity(std::string(number) + " " + inner);
      EXPECT_EQ(common.unit, expected.unit) << unit;
      EXPECT_EQ(common.value, expected.value) << number << " " << unit;
    }
  }
  // Beside them: units that look like common ones.
  EXPECT_EQ(parse_quantity("2 min", "s"), 120.0);
  EXPECT_EQ(parse_quantity("1 N/m/s", "kg s-3"), 1.0);
  EXPECT_EQ(parse_quantity("6 N m2/kg", "m3 s-2"), 6.0);
  EXPECT_THROW(parse_quantity("1 m--2", "m-2"), std::invalid_argument);
  EXPECT_THROW(parse_quantity("1 m/", "m"), std::invalid_argument);
}

TEST(ParseQuantity, ManyThreadsReadTheSame) {
  std::vector<std::thread> threads;
  std::vector<int> wrong(4, 0);
  for (std::size_t i = 0; i < wrong.size(); ++i) {
    threads.emplace_back([&wrong, i] {
      for (int j = 0; j < 200; ++j) {
        if (parse_quantity("75 mm", "m") != 0.075) ++wrong[i];
        if (refusal("1 kg", "m").empty()) ++wrong[i];
      }
    });
  }
  for (std::thread& thread : threads) thread.join();
  EXPECT_THAT(wrong, testing::Each(0));
}

}  // namespace
}  // namespace stridor
