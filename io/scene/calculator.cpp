#include "io/scene/calculator.hpp"

#include <fmt/format.h>
#include <muParser.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <numbers>
#include <stdexcept>
#include <string>

namespace stridor {
namespace {

constexpr std::array<std::string_view, 11> functions{"sqrt",  "sin", "cos",   "tan", "exp", "ln",
                                                     "log10", "abs", "round", "min", "max"};

/// What a step of an evaluation has no finite value for.
[[noreturn]] void fail(const std::string& message) {
  throw std::domain_error(message);
}

}  // namespace

bool is_digit(char c) {
  return c >= '0' && c <= '9';
}
bool is_name_start(char c) {
  return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || c == '_';
}
bool is_blank(char c) {
  return c == ' ' || c == '\t';
}
std::span<const std::string_view> function_names() {
  return functions;
}
bool is_function(std::string_view name) {
  return std::find(functions.begin(), functions.end(), name) != functions.end();
}

double finite(double value, const char* what) {
  if (!std::isfinite(value)) fail(fmt::format("{} is outside the range of double precision", what));
  return value;
}

std::optional<std::pair<std::size_t, double>> number_at(std::string_view text) {
  const bool starts = !text.empty() && (is_digit(text[0]) ||
                                        (text[0] == '.' && text.size() > 1 && is_digit(text[1])));
  if (!starts) return std::nullopt;
  double value = 0.0;
  const auto [end, status] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (status == std::errc::result_out_of_range) value = HUGE_VAL;
  return std::pair(static_cast<std::size_t>(end - text.data()), value);
}

namespace {

double plus(double a, double b) {
  return finite(a + b, "a sum");
}
double minus(double a, double b) {
  return finite(a - b, "a difference");
}
double times(double a, double b) {
  return finite(a * b, "a product");
}
double over(double a, double b) {
  if (b == 0.0) fail(fmt::format("{} is divided by 0", a));
  return finite(a / b, "a quotient");
}
double power(double a, double b) {
  if (a == 0.0 && b < 0.0) fail(fmt::format("0^{} divides by 0", b));
  const double value = std::pow(a, b);
  if (std::isnan(value)) {
    fail(
        fmt::format("({})^{} is no real number; only a whole power of a negative number is", a, b));
  }
  return finite(value, "a power");
}
double negative(double a) {
  return -a;
}
double positive(double a) {
  return a;
}
double root(double a) {
  if (a < 0.0) fail(fmt::format("sqrt({}) is no real number", a));
  return std::sqrt(a);
}
double sine(double a) {
  return std::sin(a);
}
double cosine(double a) {
  return std::cos(a);
}
double tangent(double a) {
  return std::tan(a);
}
double exponential(double a) {
  return finite(std::exp(a), "exp");
}
double natural_logarithm(double a) {
  if (a <= 0.0) fail(fmt::format("ln({}) is no number; only a positive number has a logarithm", a));
  return std::log(a);
}
double decimal_logarithm(double a) {
  if (a <= 0.0)
    fail(fmt::format("log10({}) is no number; only a positive number has a logarithm", a));
  return std::log10(a);
}
double magnitude(double a) {
  return std::abs(a);
}
double rounded(double a) {
  return std::round(a);
}
double smallest(const double* values, int count) {
  return *std::min_element(values, values + count);
}
double largest(const double* values, int count) {
  return *std::max_element(values, values + count);
}

/// The language of expressions: of muParser only what is named here.
class Calculator : public mu::ParserBase {
 public:
  Calculator() {
    EnableBuiltInOprt(false);  // its division by 0 would be infinite, and its '=' assigns
    AddValIdent(read_number);
    InitCharSets();
    InitFun();
    InitConst();
    InitOprt();
  }

 private:
  static int read_number(const char* text, int* position, double* value) {
    const auto number = number_at(text);
    if (!number) return 0;
    *position += static_cast<int>(number->first);
    *value = number->second;
    return 1;
  }
  void InitCharSets() override {
    DefineNameChars("0123456789_abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ");
    DefineOprtChars("+-*/^");
    DefineInfixOprtChars("+-");
  }
  void InitFun() override {
    DefineFun("sqrt", root);
    DefineFun("sin", sine);
    DefineFun("cos", cosine);
    DefineFun("tan", tangent);
    DefineFun("exp", exponential);
    DefineFun("ln", natural_logarithm);
    DefineFun("log10", decimal_logarithm);
    DefineFun("abs", magnitude);
    DefineFun("round", rounded);
    DefineFun("min", smallest);
    DefineFun("max", largest);
  }
  void InitConst() override { DefineConst("pi", std::numbers::pi); }
  void InitOprt() override {
    DefineOprt("+", plus, mu::prADD_SUB);
    DefineOprt("-", minus, mu::prADD_SUB);
    DefineOprt("*", times, mu::prMUL_DIV);
    DefineOprt("/", over, mu::prMUL_DIV);
    DefineOprt("^", power, mu::prPOW, mu::oaRIGHT);
    DefineInfixOprt("-", negative);
    DefineInfixOprt("+", positive);
  }
};

}  // namespace

std::unique_ptr<mu::ParserBase> make_calculator() {
  return std::make_unique<Calculator>();
}

}  // namespace stridor
