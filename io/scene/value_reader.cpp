#include "io/scene/value_reader.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <cstdint>
#include <optional>
#include <stdexcept>
#include <system_error>
#include <utility>

#include "core/suggestion.hpp"
#include "core/units.hpp"
#include "io/scene/expression.hpp"
#include "io/scene/scene_problems.hpp"
#include "io/scene/scene_words.hpp"

namespace stridor {
namespace {

bool is_bare_number(const std::string& text) {
  return text.find_first_not_of("+-.0123456789eE") == std::string::npos;
}

class ValueReader {
 public:
  ValueReader(SceneParameters& parameters, SceneReport& report)
      : parameters_(parameters), report_(report) {}

  /// The value of a scalar, list or curve key; monostate where it is wrong, which has been
  /// reported.
  Value read(const SceneNode& node, const Key& key, const std::string& path) {
    switch (key.kind) {
      case KeyKind::flag:
        return read_flag(node, path);
      case KeyKind::integer:
        return read_integer(node, key, path);
      case KeyKind::real:
        return as_value(read_real(node, key.unit, key.range, path));
      case KeyKind::text:
        if (!report_.is_scalar(node, expected_of(key), path)) return {};
        return node.text;
      case KeyKind::choice:
        return read_choice(node, key, path);
      case KeyKind::real_list:
        return as_value(read_reals(node, key.unit, key.range, path));
      case KeyKind::text_list:
        return read_texts(node, key, path);
      case KeyKind::curve:
        return node.kind == SceneNode::Kind::map ? read_table(node, key, path)
                                                 : read_constant(node, key, path);
      case KeyKind::section:
      case KeyKind::named_sections:
      case KeyKind::section_list:
      case KeyKind::parameters:
        break;
    }
    return {};
  }

 private:
  template <class T>
  static Value as_value(std::optional<T> read) {
    return read ? Value(std::move(*read)) : Value{};
  }

  Value read_flag(const SceneNode& node, const std::string& path) {
    if (!report_.is_scalar(node, "true or false", path)) return {};
    if (node.text == "true") return true;
    if (node.text == "false") return false;
    report_.add(Refusal::wrong_value, node.place, path,
                fmt::format("expected true or false, got {}", quoted(node.text)));
    return {};
  }

  Value read_integer(const SceneNode& node, const Key& key, const std::string& path) {
    if (!report_.is_scalar(node, "a whole number", path)) return {};
    if (is_expression(node.text)) return read_whole_result(node, key, path);
    const bool has_plus = node.text.starts_with('+') && !node.text.starts_with("+-");
    const char* begin = node.text.data() + (has_plus ? 1 : 0);
    const char* end = node.text.data() + node.text.size();
    std::int64_t value = 0;
    const auto [stop, status] = std::from_chars(begin, end, value);
    const bool is_too_large = status == std::errc::result_out_of_range && stop == end;
    if ((status != std::errc() && !is_too_large) || stop != end) {
      report_.add(Refusal::wrong_value, node.place, path,
                  fmt::format("expected a whole number without unit, got {}", quoted(node.text)));
      return {};
    }
    if (!is_too_large && !is_in_range(node, key, static_cast<double>(value), path)) return {};
    if (is_too_large || !key.storable.contains(static_cast<double>(value))) {
      report_not_storable(node, path);
      return {};
    }
    return value;
  }

  /// An expression for a whole number.
  Value read_whole_result(const SceneNode& node, const Key& key, const std::string& path) {
    const auto value = parameters_.value_of(node, path, report_.problems());
    if (!value) return {};
    if (*value != std::trunc(*value)) {
      report_.add(Refusal::wrong_value, node.place, path,
                  fmt::format("must be a whole number, got {} (written {}); round() rounds", *value,
                              quoted(node.text)));
      return {};
    }
    if (!is_in_range(node, key, *value, path)) return {};
    constexpr double largest = 9007199254740992.0;  // beyond it doubles leave whole numbers out
    if (std::abs(*value) > largest || !key.storable.contains(*value)) {
      report_not_storable(node, path);
      return {};
    }
    return static_cast<std::int64_t>(*value);
  }

  bool is_in_range(const SceneNode& node, const Key& key, double whole, const std::string& path) {
    if (key.range.contains(whole)) return true;
    report_.add(Refusal::wrong_value, node.place, path,
                fmt::format("must be {}, got {:.0f}{}", key.range.text(), whole, written(node)));
    return false;
  }

  void report_not_storable(const SceneNode& node, const std::string& path) {
    report_.add(Refusal::wrong_value, node.place, path,
                fmt::format("is too far from 0 to be stored, got {}", quoted(node.text)));
  }

  /// How a number was written, where it was not in the form in which messages show it.
  static std::string written(const SceneNode& node) {
    return is_bare_number(node.text) ? "" : fmt::format(" (written {})", quoted(node.text));
  }

  std::optional<double> read_real(const SceneNode& node, const std::string& unit,
                                  const Range& range, const std::string& path) {
    if (!report_.is_scalar(node, in_unit("a number", unit), path)) return std::nullopt;
    const auto value = is_expression(node.text)
                           ? parameters_.value_of(node, path, report_.problems())
                           : read_quantity(node, unit, path);
    if (!value) return std::nullopt;
    if (!range.contains(*value)) {
      report_.add(Refusal::wrong_value, node.place, path,
                  range_message(range, *value, unit) + written(node));
      return std::nullopt;
    }
    if (const std::string message = magnitude_message(*value, unit); !message.empty()) {
      report_.add(Refusal::wrong_value, node.place, path, message);
      return std::nullopt;
    }
    return value;
  }

  std::optional<double> read_quantity(const SceneNode& node, const std::string& unit,
                                      const std::string& path) {
    if (quoted(node.text) != "'" + node.text + "'") {  // no number is long or has line breaks
      report_.add(Refusal::wrong_value, node.place, path,
                  fmt::format("expected {}, got {}", in_unit("a number", unit), quoted(node.text)));
      return std::nullopt;
    }
    try {
      return parse_quantity(node.text, unit);
    } catch (const QuantityError& error) {
      report_.add(error.refusal(), node.place, path, error.what());
      return std::nullopt;
    }
  }

  std::optional<std::vector<double>> read_reals(const SceneNode& node, const std::string& unit,
                                                const Range& range, const std::string& path) {
    if (!report_.is_kind(node, SceneNode::Kind::list, in_unit("a list of numbers", unit), path))
      return std::nullopt;
    report_.add_text_problems(node, path);
    std::vector<double> values;
    for (std::size_t i = 0; i < node.items.size(); ++i) {
      const auto value = read_real(node.items[i], unit, range, join_path(path, std::to_string(i)));
      if (value) values.push_back(*value);
    }
    if (values.size() != node.items.size()) return std::nullopt;
    return values;
  }

  Value read_choice(const SceneNode& node, const Key& key, const std::string& path) {
    if (!report_.is_scalar(node, expected_of(key), path)) return {};
    if (std::find(key.choices.begin(), key.choices.end(), node.text) != key.choices.end())
      return node.text;
    report_.add(Refusal::wrong_value, node.place, path,
                fmt::format("expected {}, got {}{}", expected_of(key), quoted(node.text),
                            did_you_mean(node.text, key.choices)));
    return {};
  }

  Value read_texts(const SceneNode& node, const Key& key, const std::string& path) {
    if (node.kind == SceneNode::Kind::scalar) {
      report_.add_text_problems(node, path);
      const auto text = text_of(node, key, path);
      return text ? Value(std::vector<std::string>{*text}) : Value{};
    }
    if (!report_.is_kind(node, SceneNode::Kind::list, expected_of(key), path)) return {};
    report_.add_text_problems(node, path);
    std::vector<std::string> texts;
    for (std::size_t i = 0; i < node.items.size(); ++i) {
      const SceneNode& item = node.items[i];
      const std::string item_path = join_path(path, std::to_string(i));
      if (key.has_rows && item.kind == SceneNode::Kind::list) {
        if (auto row = read_row(item, item_path)) texts.push_back(std::move(*row));
      } else if (report_.is_scalar(item, key.has_rows ? "a row of numbers" : "a text", item_path)) {
        if (auto text = text_of(item, key, item_path)) texts.push_back(std::move(*text));
      }
    }
    if (texts.size() != node.items.size()) return {};
    return texts;
  }

  /// A text; the number of an expression where texts are rows of numbers.
  std::optional<std::string> text_of(const SceneNode& node, const Key& key,
                                     const std::string& path) {
    if (!key.has_rows || !is_expression(node.text)) return node.text;
    const std::size_t num_before = report_.problems().size();
    const auto value = parameters_.value_of(node, path, report_.problems());
    if (report_.problems().size() > num_before)
      report_.problems().back().message += "; a row of several is a list: [=a, =b]";
    return value ? std::optional(fmt::format("{}", *value)) : std::nullopt;
  }

  /// The text of a list of numbers, as they are written.
  std::optional<std::string> read_row(const SceneNode& node, const std::string& path) {
    report_.add_text_problems(node, path);
    const auto numbers = read_reals(node, "", Range::any(), path);
    if (!numbers) return std::nullopt;
    return fmt::format("{}", fmt::join(*numbers, " "));
  }

  Value read_constant(const SceneNode& node, const Key& key, const std::string& path) {
    if (!report_.is_kind(node, SceneNode::Kind::scalar, expected_of(key), path)) return {};
    return as_value(read_real(node, key.unit, key.range, path));
  }

  Value read_table(const SceneNode& node, const Key& key, const std::string& path) {
    report_.add_text_problems(node, path);
    static const std::vector<std::string> table_keys{"times", "values"};
    for (const SceneEntry& entry : node.entries) {
      if (std::find(table_keys.begin(), table_keys.end(), entry.key) != table_keys.end()) continue;
      const std::string suggestion = did_you_mean(entry.key, table_keys);
      report_.add(Refusal::unknown_key, entry.place, join_path(path, entry.key),
                  fmt::format("unknown key {}{}", quoted(entry.key),
                              suggestion.empty() ? "; known here: times, values" : suggestion));
      collect_text_problems(entry.value, join_path(path, entry.key), report_.problems());
    }
    const auto times = read_column(node, "times", "s", Range::any(), path);
    const auto values = read_column(node, "values", key.unit, key.range, path);
    if (!times || !values) return {};

    // What the constructor of TimeCurve would throw for is said here, with its place.
    const SceneNode& times_node = node.entry("times")->value;
    if (times->empty()) {
      report_.add(Refusal::wrong_value, times_node.place, join_path(path, "times"),
                  "needs at least one time");
      return {};
    }
    if (times->size() != values->size()) {
      report_.add(Refusal::wrong_size, node.entry("values")->value.place, join_path(path, "values"),
                  fmt::format("has {} entries but times has {}; give one value for each time",
                              values->size(), times->size()));
      return {};
    }
    for (std::size_t i = 1; i < times->size(); ++i) {
      if ((*times)[i] > (*times)[i - 1]) continue;
      report_.add(Refusal::wrong_value, times_node.items[i].place,
                  fmt::format("{}.times.{}", path, i),
                  fmt::format("times must increase strictly, got {} s after {} s", (*times)[i],
                              (*times)[i - 1]));
      return {};
    }
    if (values->size() == 1) return values->front();
    return TimeTable{*times, *values};
  }

  std::optional<std::vector<double>> read_column(const SceneNode& table, const std::string& name,
                                                 const std::string& unit, const Range& range,
                                                 const std::string& path) {
    const std::string column_path = join_path(path, name);
    const std::string expected = in_unit("a list of numbers", unit);
    const SceneEntry* entry = table.entry(name);
    if (!entry) {
      report_.add(Refusal::missing, table.place, column_path,
                  fmt::format("required key '{}' is missing, expected {}", name, expected));
      return std::nullopt;
    }
    if (entry->value.kind == SceneNode::Kind::null) {
      report_.add(Refusal::missing, entry->place, column_path,
                  fmt::format("has no value, expected {}", expected));
      return std::nullopt;
    }
    return read_reals(entry->value, unit, range, column_path);
  }

  SceneParameters& parameters_;
  SceneReport& report_;
};

}  // namespace

Value read_value(const SceneNode& node, const Key& key, const std::string& path,
                 SceneParameters& parameters, SceneReport& report) {
  return ValueReader(parameters, report).read(node, key, path);
}

}  // namespace stridor
