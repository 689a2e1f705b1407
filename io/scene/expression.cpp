#include "io/scene/expression.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <muParser.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <numbers>
#include <optional>
#include <stdexcept>
#include <string_view>

#include "core/suggestion.hpp"
#include "core/units.hpp"
#include "io/scene/calculator.hpp"

namespace stridor {
namespace {

constexpr std::size_t longest_expression = 500;  ///< bytes of an expression
/// An expression without its '=', and where its names and numbers are.
class Words {
 public:
  /// @throws std::invalid_argument for what needs no grammar to be seen
  explicit Words(const std::string& expression) : text_(expression.substr(1)) {
    if (text_.size() > longest_expression) {
      throw std::invalid_argument(
          fmt::format("is longer than {} characters; compute parts of it under `parameters`",
                      longest_expression));
    }
    plain_ = text_;
    for (std::size_t at = 0; at < text_.size();) at = read_word(at);
  }

  /// The same for muParser, which wants the '(' of a function right behind its name.
  const std::string& plain() const { return plain_; }

  const std::string& text() const { return text_; }
  const std::vector<std::string>& names() const { return names_; }

  [[noreturn]] void refuse(std::size_t at, const std::string& message) const {
    throw std::invalid_argument(
        fmt::format("'={}', column {}: {}", text_, std::min(at, text_.size()) + 1, message));
  }
  [[noreturn]] void refuse(const std::string& message) const {
    throw std::invalid_argument(fmt::format("'={}': {}", text_, message));
  }
  /// The word that begins at a place.
  std::string word_at(std::size_t at) const {
    const auto number = number_at(std::string_view(text_).substr(at));
    const std::size_t end = number ? at + number->first : end_of_name(at);
    return text_.substr(at, std::max<std::size_t>(end - at, 1));
  }
  bool is_called(std::size_t name) const {
    const std::size_t next = text_.find_first_not_of(" \t", end_of_name(name));
    return next != std::string::npos && text_[next] == '(';
  }

  /// Where the name at a place is the unit of the number before it, says what to write instead.
  void refuse_unit(std::size_t name) const {
    const auto number = std::find_if(numbers_.begin(), numbers_.end(), [&](const auto& one) {
      return text_.find_first_not_of(" \t", one.second) == name;
    });
    if (number == numbers_.end()) return;
    // All of the rest, as in "30 mm/s", or this name alone.
    for (const std::size_t end : {text_.size(), end_of_name(name)}) {
      const std::string written = text_.substr(number->first, end - number->first);
      double value = 0.0;
      try {
        value = parse_any_quantity(written).value;
      } catch (const std::invalid_argument&) {
        continue;
      }
      refuse(number->first,
             fmt::format("an expression holds SI numbers without units; write {} for '{}', or give "
                         "'{}' a name under `parameters`",
                         value, written, written));
    }
  }

 private:
  /// @returns the place behind the word
  std::size_t read_word(std::size_t at) {
    const char c = text_[at];
    if (is_blank(c)) return at + 1;
    if (const auto number = number_at(std::string_view(text_).substr(at))) {
      if (!std::isfinite(number->second))
        refuse(at, fmt::format("{} is outside the range of double precision", word_at(at)));
      numbers_.emplace_back(at, at + number->first);
      return at + number->first;
    }
    if (is_name_start(c)) {
      const std::string name = word_at(at);
      if (name == "log") refuse(at, "write ln for the natural logarithm, or log10");
      const bool is_new = std::find(names_.begin(), names_.end(), name) == names_.end();
      if (is_new && !is_reserved_name(name)) names_.push_back(name);
      return at + name.size();
    }
    if (c == '(') {
      const std::size_t before =
          at == 0 ? std::string::npos : text_.find_last_not_of(" \t", at - 1);
      const bool follows_name = before != std::string::npos && is_name(text_[before]);
      if (follows_name) std::swap(plain_[before + 1], plain_[at]);
      takes_comma_.push_back(follows_name);
    } else if (c == ')') {
      if (takes_comma_.empty()) refuse(at, "there is a ')' too many");
      takes_comma_.pop_back();
    } else if (c == ',') {
      if (takes_comma_.empty() || !takes_comma_.back())
        refuse(at, "a ',' stands only between the arguments of min and max");
    } else if (std::string_view("+-*/^").find(c) == std::string_view::npos) {
      refuse_character(at);
    }
    return at + 1;
  }

  [[noreturn]] void refuse_character(std::size_t at) const {
    std::size_t end = at + 1;  // of the UTF-8 character
    while (end < text_.size() && (static_cast<unsigned char>(text_[end]) & 0xC0u) == 0x80u) ++end;
    const bool is_shown = static_cast<unsigned char>(text_[at]) >= 0x20 && text_[at] != 0x7F;
    const std::string message = fmt::format(
        "{} means nothing in an expression, which knows + - * / ^ ( ), names, functions "
        "and SI numbers without units",
        is_shown ? "'" + text_.substr(at, end - at) + "'" : "a line break");
    if (!is_shown) throw std::invalid_argument(fmt::format("column {}: {}", at + 1, message));
    refuse(at, message);
  }

  static bool is_name(char c) { return is_name_start(c) || is_digit(c); }
  std::size_t end_of_name(std::size_t at) const {
    while (at < text_.size() && is_name(text_[at])) ++at;
    return at;
  }

  std::string text_;
  std::string plain_;
  std::vector<std::string> names_;                            ///< without the reserved ones
  std::vector<std::pair<std::size_t, std::size_t>> numbers_;  ///< begin and end of each
  std::vector<bool> takes_comma_;                             ///< of the parentheses that are open
};

[[noreturn]] void refuse_unknown(const Words& words, std::size_t at,
                                 const std::map<std::string, double>& numbers) {
  const std::string word = words.word_at(at);
  if (!is_name_start(word.front()))
    words.refuse(at, fmt::format("a number or a name is missing before '{}'", word));
  words.refuse_unit(at);
  if (is_function(word)) words.refuse(at, fmt::format("{0} needs its argument: {0}(...)", word));
  const std::span<const std::string_view> functions = function_names();
  std::vector<std::string> known(functions.begin(), functions.end());
  if (words.is_called(at)) {
    const std::string advice = did_you_mean(word, known);
    words.refuse(
        at, fmt::format("there is no function '{}'{}", word,
                        advice.empty() ? fmt::format("; there are {}", fmt::join(functions, ", "))
                                       : advice));
  }
  known.push_back("pi");
  for (const auto& [name, value] : numbers) known.push_back(name);
  const std::string advice = did_you_mean(word, known);
  words.refuse(at, fmt::format("there is no parameter '{}'{}", word,
                               advice.empty() ? "; declare it under `parameters`" : advice));
}

/// Says what muParser found wrong.
[[noreturn]] void refuse_expression(const Words& words, const mu::ParserError& error,
                                    const std::map<std::string, double>& numbers) {
  const std::string& text = words.text();
  const std::size_t last = text.find_last_not_of(" \t");
  if (last == std::string::npos)
    throw std::invalid_argument("an expression is missing after the '='");
  const std::size_t at =
      std::min(static_cast<std::size_t>(std::max(error.GetPos(), 0)), text.size());
  const std::size_t here = text.find_first_not_of(" \t", at);
  switch (error.GetCode()) {
    case mu::ecMISSING_PARENS:
      words.refuse(text.size(),
                   "a ')' is missing; inside {...} or [...] an expression with a ',' stands in "
                   "quotes");
    case mu::ecTOO_MANY_PARAMS:
    case mu::ecTOO_FEW_PARAMS:
      words.refuse(at, fmt::format("{} takes {}", error.GetToken(),
                                   error.GetToken() == "min" || error.GetToken() == "max"
                                       ? "one or more numbers"
                                       : "one number"));
    default:
      break;
  }
  if (std::string_view("+-*/^,(").find(text[last]) != std::string_view::npos)
    words.refuse(last + 1, fmt::format("a number or a name is missing after '{}'", text[last]));
  if (here == std::string::npos) words.refuse("is no expression");
  switch (error.GetCode()) {
    case mu::ecUNEXPECTED_VAL:
    case mu::ecUNEXPECTED_VAR:
    case mu::ecUNEXPECTED_FUN:
      words.refuse(here, fmt::format("an operator is missing before '{}'", words.word_at(here)));
    case mu::ecUNEXPECTED_PARENS:
      words.refuse(here, text[here] == '(' ? "an operator is missing before '('"
                                           : "a number or a name is missing before ')'");
    case mu::ecUNEXPECTED_ARG_SEP:
      words.refuse(here, "a number or a name is missing before ','");
    case mu::ecUNEXPECTED_OPERATOR: {  // at it, or behind it
      const std::size_t sign = text.find_last_of("+-*/^", here);
      if (sign == std::string::npos) words.refuse("is no expression");
      words.refuse(sign, fmt::format("a number or a name is missing before '{}'", text[sign]));
    }
    case mu::ecUNASSIGNABLE_TOKEN:
      refuse_unknown(words, here, numbers);
    default:
      words.refuse(fmt::format("is no expression ({})", error.GetMsg()));
  }
}

}  // namespace

bool is_expression(const std::string& text) {
  return text.starts_with('=');
}

bool is_reserved_name(const std::string& name) {
  return name == "pi" || is_function(name);
}

std::vector<std::string> names_in(const std::string& expression) {
  return Words(expression).names();
}

double evaluate(const std::string& expression, const std::map<std::string, double>& numbers) {
  const Words words(expression);
  // muParser wants to be able to write to variables.
  std::map<std::string, double> variables;
  const std::unique_ptr<mu::ParserBase> calculator = make_calculator();
  for (const std::string& name : words.names()) {
    const auto found = numbers.find(name);
    if (found == numbers.end()) continue;
    calculator->DefineVar(name, &(variables[name] = found->second));
  }
  try {
    calculator->SetExpr(words.plain());
    return finite(calculator->Eval(), "the result");
  } catch (const std::domain_error& error) {
    words.refuse(error.what());
  } catch (const mu::ParserError& error) {
    refuse_expression(words, error, numbers);
  }
}

struct CompiledExpression::Implementation {
  std::unique_ptr<mu::ParserBase> calculator = make_calculator();
};

CompiledExpression::CompiledExpression(const std::string& expression,
                                       std::map<std::string, double>& numbers)
    : implementation_(std::make_unique<Implementation>()) {
  (void)evaluate(expression, numbers);
  const Words words(expression);
  mu::ParserBase& calculator = *implementation_->calculator;
  for (const std::string& name : words.names()) calculator.DefineVar(name, &numbers.at(name));
  calculator.SetExpr(words.plain());
}

CompiledExpression::~CompiledExpression() = default;
CompiledExpression::CompiledExpression(CompiledExpression&&) noexcept = default;
CompiledExpression& CompiledExpression::operator=(CompiledExpression&&) noexcept = default;

double CompiledExpression::value() const {
  return finite(implementation_->calculator->Eval(), "the result");
}

}  // namespace stridor
