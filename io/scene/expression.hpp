// Values that scenes compute: "=2*mu", "=k/omega^2".
#pragma once

#include <map>
#include <memory>
#include <string>
#include <vector>

namespace stridor {

/// Whether a scalar of a scene is an expression: it begins with '='.
bool is_expression(const std::string& text);

/// Names that an expression takes from `parameters`, in the order in which they occur, each once.
/// @throws std::invalid_argument as evaluate(), for what can be seen without values
std::vector<std::string> names_in(const std::string& expression);

/// Whether a name means something in expressions by itself: a function, or pi.
bool is_reserved_name(const std::string& name);

/// The number that an expression stands for.
///
/// + − * / with the usual precedence, ^ above them and above the sign (−2^2 = −4) and from the
/// right (2^3^2 = 2^9), parentheses, and the functions sqrt, sin, cos, tan (of rad), exp, ln
/// (natural), log10, abs, round (to the nearest whole number), min, max, and pi. Numbers are SI
/// numbers without units.
///
/// @param expression with its '='
/// @param numbers    the parameters
/// @throws std::invalid_argument with a message of one line, which names the column within the
///         expression (1: the first character after the '='): no expression, an unknown name, a
///         unit; and where a step of the evaluation has no finite value
double evaluate(const std::string& expression, const std::map<std::string, double>& numbers);

/// An expression that is evaluated many times, with other numbers each time.
class CompiledExpression {
 public:
  /// @param expression that evaluate() takes
  /// @param numbers    are read by every value(); must live longer, and no entry may be removed
  /// @throws std::invalid_argument as evaluate()
  CompiledExpression(const std::string& expression, std::map<std::string, double>& numbers);
  ~CompiledExpression();
  CompiledExpression(CompiledExpression&&) noexcept;
  CompiledExpression& operator=(CompiledExpression&&) noexcept;

  /// The same to the last bit as evaluate().
  /// @throws std::domain_error where a step of the evaluation has no finite value
  double value() const;

 private:
  struct Implementation;
  std::unique_ptr<Implementation> implementation_;
};

}  // namespace stridor
