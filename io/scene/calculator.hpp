// The language of expressions: what muParser is let know of it.
#pragma once

#include <memory>
#include <optional>
#include <span>
#include <string_view>
#include <utility>

namespace mu {
class ParserBase;
}

namespace stridor {

bool is_digit(char c);
bool is_name_start(char c);
bool is_blank(char c);
/// Names of the functions of expressions.
std::span<const std::string_view> function_names();
/// Whether expressions have a function of this name.
bool is_function(std::string_view name);

/// @throws std::domain_error naming `what` if a value is not finite
double finite(double value, const char* what);

/// The number at the beginning of a text: its length and value; nothing where none begins there.
/// The value is infinite where no double can hold it.
std::optional<std::pair<std::size_t, double>> number_at(std::string_view text);

/// A parser of +, -, *, /, ^, brackets, pi and the functions, and of nothing else. What has no finite value
/// throws std::domain_error.
std::unique_ptr<mu::ParserBase> make_calculator();

}  // namespace stridor
