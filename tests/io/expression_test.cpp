#include "io/scene/expression.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <stdexcept>
#include <string>
#include <vector>

namespace stridor {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

const std::map<std::string, double> kNumbers{
    {"mu", 0.3}, {"k", 8.0}, {"m", 2.0}, {"load", 7.5e-4}, {"zero", 0.0}};

double value_of(const std::string& expression) {
  return evaluate(expression, kNumbers);
}

std::string expression_refusal(const std::string& expression) {
  try {
    evaluate(expression, kNumbers);
  } catch (const std::invalid_argument& error) {
    return error.what();
  }
  return {};
}

TEST(Expression, BeginsWithAnEqualsSign) {
  EXPECT_TRUE(is_expression("=mu"));
  EXPECT_FALSE(is_expression("mu"));
  EXPECT_FALSE(is_expression(" =mu"));
  EXPECT_FALSE(is_expression(""));
}

TEST(Expression, NumbersAreThoseThatScenesHold) {
  EXPECT_EQ(value_of("=0.30"), 0.3);
  EXPECT_EQ(value_of("=.5"), 0.5);
  EXPECT_EQ(value_of("=5."), 5.0);
  EXPECT_EQ(value_of("=7.5e-4"), 7.5e-4);
  EXPECT_EQ(value_of("=1E+3"), 1000.0);
  EXPECT_EQ(value_of("=0.1"), 0.1);
  EXPECT_EQ(value_of("=1e-3-1"), 1e-3 - 1.0);
}

TEST(Expression, OperatorsBindAsInPhysics) {
  EXPECT_EQ(value_of("=1+2*3"), 7.0);
  EXPECT_EQ(value_of("=(1+2)*3"), 9.0);
  EXPECT_EQ(value_of("=8/4/2"), 1.0);
  EXPECT_EQ(value_of("=1-2-3"), -4.0);
  EXPECT_EQ(value_of("=k/m^2"), 2.0);
  EXPECT_EQ(value_of("=-2^2"), -4.0);
  EXPECT_EQ(value_of("=2^-1*3"), 1.5);
  EXPECT_EQ(value_of("=2^3^2"), 512.0);
  EXPECT_EQ(value_of("=2*-mu"), -0.6);
  EXPECT_EQ(value_of("=mu- -mu"), 0.6);
  EXPECT_EQ(value_of("= + mu "), 0.3);
}

TEST(Expression, FunctionsAreThoseOfTheStandardLibrary) {
  EXPECT_EQ(value_of("=sqrt(k/m)"), 2.0);
  EXPECT_EQ(value_of("=sin(pi/6)"), std::sin(std::numbers::pi / 6));
  EXPECT_EQ(value_of("=cos(mu)"), std::cos(0.3));
  EXPECT_EQ(value_of("=tan(mu)"), std::tan(0.3));
  EXPECT_EQ(value_of("=exp(1)"), std::exp(1.0));
  EXPECT_EQ(value_of("=ln(mu)"), std::log(0.3));
  EXPECT_EQ(value_of("=log10(1000)"), 3.0);
  EXPECT_EQ(value_of("=abs(-mu)"), 0.3);
  EXPECT_EQ(value_of("=round(2.5)"), 3.0);
  EXPECT_EQ(value_of("=min(3, mu, 1)"), 0.3);
  EXPECT_EQ(value_of("=max(3, mu, 1)"), 3.0);
  EXPECT_EQ(value_of("=min(mu)"), 0.3);
  EXPECT_EQ(value_of("=sqrt (4)"), 2.0);
}

TEST(Expression, NamesAreListedOnceWithoutThoseOfTheLanguage) {
  EXPECT_THAT(names_in("=k*sqrt(m/k) + min(pi, mo)"), ElementsAre("k", "m", "mo"));
  EXPECT_THAT(names_in("=2*pi"), IsEmpty());
  EXPECT_TRUE(is_reserved_name("pi"));
  EXPECT_TRUE(is_reserved_name("sqrt"));
  EXPECT_FALSE(is_reserved_name("mu"));
}

TEST(Expression, UnknownNameIsRefusedWithASuggestion) {
  EXPECT_EQ(expression_refusal("=2*laod"),
            "'=2*laod', column 3: there is no parameter 'laod', did you mean 'load'?");
  EXPECT_EQ(expression_refusal("=stiffness"),
            "'=stiffness', column 1: there is no parameter 'stiffness'; declare it under "
            "`parameters`");
  EXPECT_EQ(expression_refusal("=sqr(2)"),
            "'=sqr(2)', column 1: there is no function 'sqr', did you mean 'sqrt'?");
  EXPECT_EQ(expression_refusal("=gamma(2)"),
            "'=gamma(2)', column 1: there is no function 'gamma'; there are sqrt, sin, cos, "
            "tan, exp, ln, log10, abs, round, min, max");
}

TEST(Expression, LogarithmMustSayItsBase) {
  EXPECT_EQ(expression_refusal("=log(2)"),
            "'=log(2)', column 1: write ln for the natural logarithm, or log10");
}

TEST(Expression, UnitIsRefusedWithTheNumberToWrite) {
  EXPECT_EQ(expression_refusal("=75 mm"),
            "'=75 mm', column 1: an expression holds SI numbers without units; write 0.075 for "
            "'75 mm', or give '75 mm' a name under `parameters`");
  EXPECT_THAT(expression_refusal("=2*30 mm/s"),
              HasSubstr("column 3: an expression holds SI numbers without "
                        "units; write 0.03 for '30 mm/s'"));
  EXPECT_THAT(expression_refusal("=1GPa*2"), HasSubstr("write 1000000000 for '1GPa'"));
  EXPECT_THAT(expression_refusal("=2 min"), HasSubstr("write 120 for '2 min'"));
  EXPECT_THAT(expression_refusal("=50 %"),
              HasSubstr("column 4: '%' means nothing in an expression"));
}

TEST(Expression, MissingOperatorIsNamed) {
  EXPECT_EQ(expression_refusal("=2 mu"), "'=2 mu', column 3: an operator is missing before 'mu'");
  EXPECT_EQ(expression_refusal("=2 3"), "'=2 3', column 3: an operator is missing before '3'");
  EXPECT_EQ(expression_refusal("=1.5.2"), "'=1.5.2', column 4: an operator is missing before '.2'");
  EXPECT_EQ(expression_refusal("=(1)(2)"),
            "'=(1)(2)', column 4: an operator is missing before '('");
  EXPECT_EQ(expression_refusal("=2 sqrt(4)"),
            "'=2 sqrt(4)', column 3: an operator is missing before 'sqrt'");
  EXPECT_EQ(expression_refusal("=sqrt"), "'=sqrt', column 1: sqrt needs its argument: sqrt(...)");
}

TEST(Expression, MissingNumberIsNamed) {
  EXPECT_EQ(expression_refusal("="), "an expression is missing after the '='");
  EXPECT_EQ(expression_refusal("=  "), "an expression is missing after the '='");
  EXPECT_EQ(expression_refusal("=2*(mu+"),
            "'=2*(mu+', column 7: a number or a name is missing after '+'");
  EXPECT_EQ(expression_refusal("=*2"), "'=*2', column 1: a number or a name is missing before '*'");
  EXPECT_EQ(expression_refusal("=2**3"),
            "'=2**3', column 3: a number or a name is missing before '*'");
  EXPECT_EQ(expression_refusal("=mu- - -mu"),
            "'=mu- - -mu', column 7: a number or a name is missing before '-'");
  EXPECT_EQ(expression_refusal("=()"), "'=()', column 2: a number or a name is missing before ')'");
  EXPECT_EQ(expression_refusal("=min(,2)"),
            "'=min(,2)', column 5: a number or a name is missing before ','");
  EXPECT_EQ(expression_refusal("=+"), "'=+', column 2: a number or a name is missing after '+'");
}

TEST(Expression, ParenthesesAndCommasMustFit) {
  EXPECT_EQ(expression_refusal("=2*(mu"),
            "'=2*(mu', column 6: a ')' is missing; inside {...} or [...] an expression with a ',' "
            "stands in quotes");
  EXPECT_EQ(expression_refusal("=mu)"), "'=mu)', column 3: there is a ')' too many");
  EXPECT_EQ(expression_refusal("=1,2"),
            "'=1,2', column 2: a ',' stands only between the arguments of min and max");
  EXPECT_EQ(expression_refusal("=(1,2)"),
            "'=(1,2)', column 3: a ',' stands only between the arguments of min and max");
  EXPECT_THAT(expression_refusal("=sqrt(1,2)"), HasSubstr("sqrt takes one number"));
  EXPECT_THAT(expression_refusal("=min()"), HasSubstr("min takes one or more numbers"));
  EXPECT_THAT(expression_refusal("=sqrt()"), HasSubstr("sqrt takes one number"));
}

TEST(Expression, OtherLanguagesAreNotSpoken) {
  for (const std::string text :
       {"=mu=3", "=mu>2", "=1?2:3", "=!2", "=mu&&k", "=\"a\"", "=[1]", "=µ", "=2;3", "=$a"}) {
    EXPECT_THAT(expression_refusal(text), HasSubstr("means nothing in an expression, which knows"))
        << text;
  }
  EXPECT_THAT(expression_refusal("=1\n+2"), HasSubstr("column 2: a line break means nothing"));
  EXPECT_THAT(expression_refusal("=0x10"), HasSubstr("column 2: there is no parameter 'x10'"));
}

TEST(Expression, WhatHasNoFiniteValueIsRefused) {
  EXPECT_EQ(expression_refusal("=1/(mu-0.3)"), "'=1/(mu-0.3)': 1 is divided by 0");
  EXPECT_EQ(expression_refusal("=mu/zero"), "'=mu/zero': 0.3 is divided by 0");
  EXPECT_EQ(expression_refusal("=0/0"), "'=0/0': 0 is divided by 0");
  EXPECT_EQ(expression_refusal("=zero^-1"), "'=zero^-1': 0^-1 divides by 0");
  EXPECT_EQ(expression_refusal("=sqrt(-k)"), "'=sqrt(-k)': sqrt(-8) is no real number");
  EXPECT_THAT(expression_refusal("=(-8)^0.5"), HasSubstr("(-8)^0.5 is no real number"));
  EXPECT_EQ(value_of("=(-8)^3"), -512.0);
  EXPECT_THAT(expression_refusal("=ln(zero)"), HasSubstr("ln(0) is no number"));
  EXPECT_THAT(expression_refusal("=log10(-1)"), HasSubstr("log10(-1) is no number"));
  EXPECT_THAT(expression_refusal("=10^400"),
              HasSubstr("a power is outside the range of double precision"));
  EXPECT_THAT(expression_refusal("=1e400"),
              HasSubstr("1e400 is outside the range of double precision"));
  EXPECT_THAT(expression_refusal("=1e300*1e300"), HasSubstr("a product is outside the range"));
  // An infinite step whose reciprocal would pass for 0.
  EXPECT_THAT(expression_refusal("=1/exp(1000)"), HasSubstr("exp is outside the range"));
}

TEST(Expression, LengthIsLimited) {
  std::string sum = "=1";
  while (sum.size() < 490) sum += "+1";
  EXPECT_EQ(value_of(sum), 245.0);
  while (sum.size() < 600) sum += "+1";
  EXPECT_THAT(expression_refusal(sum), HasSubstr("is longer than 500 characters"));
}

}  // namespace
}  // namespace stridor
