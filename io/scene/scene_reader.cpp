#include "io/scene/scene_reader.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <cstdint>
#include <optional>
#include <stdexcept>
#include <system_error>

#include "core/suggestion.hpp"
#include "core/units.hpp"
#include "io/scene/expression.hpp"
#include "io/scene/scene_parameters.hpp"
#include "io/scene/scene_problems.hpp"

namespace stridor {
namespace {

using Kind = SceneNode::Kind;

std::string in_unit(const std::string& what, const std::string& unit) {
  return unit.empty() ? what : what + " in " + unit;
}

/// "a, b, c". Not fmt::join, over which g++ 12 warns at -O3 in fmt 9.
std::string joined(const std::vector<std::string>& words) {
  std::string text;
  for (const std::string& word : words) text += (text.empty() ? "" : ", ") + word;
  return text;
}

/// A text in quotes for a message of one line: shortened, without line breaks.
std::string quoted(const std::string& text) {
  constexpr std::size_t longest = 60;
  std::size_t length = std::min(text.size(), longest);
  // Not in the middle of a UTF-8 character.
  while (length < text.size() && (static_cast<unsigned char>(text[length]) & 0xC0u) == 0x80u)
    --length;
  std::string shown = text.substr(0, length);
  for (char& c : shown) {
    if (static_cast<unsigned char>(c) < 0x20 || c == 0x7F) c = ' ';
  }
  return fmt::format("'{}{}'", shown, length < text.size() ? "..." : "");
}

/// What stands there, in words: "a map", "a list", "'abc'".
std::string found_in(const SceneNode& node) {
  switch (node.kind) {
    case Kind::null:
      return "nothing";
    case Kind::scalar:
      return quoted(node.text);
    case Kind::map:
      return "a map";
    case Kind::list:
      return "a list";
  }
  return {};
}

/// A number for a message: short, unless rounding would move it into the range that it violates.
std::string number_text(double value, const Range& range) {
  const std::string rounded = fmt::format("{:.12g}", value);
  return range.contains(parse_quantity(rounded, "")) ? fmt::format("{}", value) : rounded;
}

/// "must be > 0, got -0.075 m"; bounds other than 0 carry the unit.
std::string range_message(const Range& range, double value, const std::string& unit) {
  const bool has_bound = (std::isfinite(range.low) && range.low != 0.0) ||
                         (std::isfinite(range.high) && range.high != 0.0);
  const std::string suffix = unit.empty() ? "" : " " + unit;
  return fmt::format("must be {}{}, got {}{}", range.text(), has_bound ? suffix : "",
                     number_text(value, range), suffix);
}

/// Why a number cannot be computed with, though its key allows it, or "". Products of a few numbers
/// of a scene must neither overflow nor vanish.
std::string magnitude_message(double value, const std::string& unit) {
  constexpr double largest = 1e30;
  constexpr double largest_pure = 1e100;
  const double size = std::abs(value);
  if (unit.empty()) {
    return size <= largest_pure ? ""
                                : fmt::format("is beyond what can be computed with, up to {:g} in "
                                              "magnitude; got {:g}",
                                              largest_pure, value);
  }
  if (size == 0.0 || (size <= largest && size >= 1.0 / largest)) return "";
  return fmt::format("is beyond what can be computed with, 0 or {:g} to {:g} {} in magnitude; got "
                     "{:g} {}",
                     1.0 / largest, largest, unit, value, unit);
}

bool is_bare_number(const std::string& text) {
  return text.find_first_not_of("+-.0123456789eE") == std::string::npos;
}

/// A name of a section: it must fit into key paths and channels, whose separator is the dot.
bool is_section_name(const std::string& name) {
  const auto is_letter = [](char c) {
    return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || c == '_';
  };
  const auto is_inner = [&](char c) { return is_letter(c) || (c >= '0' && c <= '9') || c == '-'; };
  return !name.empty() && is_letter(name.front()) &&
         std::all_of(name.begin(), name.end(), is_inner);
}

std::vector<std::string> names_of(const std::vector<Alternative>& alternatives) {
  std::vector<std::string> names;
  names.reserve(alternatives.size());
  for (const Alternative& alternative : alternatives) names.push_back(alternative.name);
  return names;
}

/// The names that a map may hold.
std::vector<std::string> known_keys(const Schema& schema, const std::string& discriminator) {
  std::vector<std::string> names;
  if (!discriminator.empty()) names.push_back(discriminator);
  for (const Key& key : schema.keys) names.push_back(key.name);
  return names;
}

class Reader {
 public:
  explicit Reader(std::vector<Problem>& problems) : problems_(problems) {}

  /// @param discriminator key of the map that has been read already, or ""
  void read_map(const SceneNode& node, const Schema& schema, void* object, const std::string& path,
                const std::string& discriminator) {
    if (!is_kind(node, Kind::map, "a map", path)) return;
    const std::size_t num_before = problems_.size();
    add_text_problems(node, path);
    const Key* named_numbers = read_parameters(node, schema, path);
    for (const SceneEntry& entry : node.entries) {
      if (entry.key == discriminator) continue;
      const std::string key_path = join_path(path, entry.key);
      const Key* key = schema.find(entry.key);
      if (!key) {
        report_unknown(entry, known_keys(schema, discriminator), key_path);
        collect_text_problems(entry.value, key_path, problems_);
      } else if (entry.value.kind == Kind::null) {
        report(entry.place, key_path, fmt::format("has no value, expected {}", expected_of(*key)));
        add_text_problems(entry.value, key_path);
      } else {
        read_key(entry.value, *key, object, key_path);
      }
    }
    for (const Key& key : schema.keys) {
      if (!key.is_optional && node.entry(key.name) == nullptr) {
        report(node.place, join_path(path, key.name),
               fmt::format("required key '{}' is missing, expected {}: {}", key.name,
                           expected_of(key), key.doc));
      }
    }
    if (named_numbers != nullptr) {
      // Of a map that was read as a whole, or a use may have been overlooked.
      if (problems_.size() == num_before) parameters_.refuse_idle_settings(problems_);
      named_numbers->assign(object, parameters_.numbers());
    }
    if (problems_.size() == num_before) run_checks(node, schema, object, path);
  }

 private:
  /// Reads the parameters of the scene, on which any other key may depend.
  /// @returns their key where they are given
  const Key* read_parameters(const SceneNode& node, const Schema& schema, const std::string& path) {
    for (const SceneEntry& entry : node.entries) {
      const Key* key = schema.find(entry.key);
      if (key == nullptr || key->kind != KeyKind::parameters) continue;
      const std::string key_path = join_path(path, entry.key);
      if (entry.value.kind == Kind::null) return nullptr;  // reported with the other keys
      if (!is_kind(entry.value, Kind::map, expected_of(*key), key_path)) return nullptr;
      add_text_problems(entry.value, key_path);
      parameters_.read(entry.value, key_path, problems_);
      return key;
    }
    return nullptr;
  }

  void report(const Place& place, const std::string& path, std::string message) {
    problems_.push_back(problem_at(place, path, std::move(message)));
  }

  /// Those of this node alone; the nodes below it add their own when they are read.
  void add_text_problems(const SceneNode& node, const std::string& path) {
    for (Problem problem : node.problems) {
      problem.key = join_path(path, problem.key);
      problems_.push_back(std::move(problem));
    }
  }

  /// True where the node is what was expected; else says so.
  bool is_kind(const SceneNode& node, Kind kind, const std::string& expected,
               const std::string& path) {
    if (node.kind == kind) return true;
    report(node.place, path,
           node.kind == Kind::null ? fmt::format("has no value, expected {}", expected)
                                   : fmt::format("expected {}, got {}", expected, found_in(node)));
    collect_text_problems(node, path, problems_);
    return false;
  }

  /// A scalar, with the faults of its text reported.
  bool is_scalar(const SceneNode& node, const std::string& expected, const std::string& path) {
    if (!is_kind(node, Kind::scalar, expected, path)) return false;
    add_text_problems(node, path);
    return true;
  }

  void report_unknown(const SceneEntry& entry, const std::vector<std::string>& known,
                      const std::string& path) {
    std::string advice = did_you_mean(entry.key, known);
    if (advice.empty() && entry.value.kind == Kind::null &&
        entry.key.find(':') != std::string::npos) {
      advice = "; write a space after the colon";
    } else if (advice.empty()) {
      advice = fmt::format("; known here: {}", joined(known));
    }
    report(entry.place, path, fmt::format("unknown key {}{}", quoted(entry.key), advice));
  }

  /// Where it is not known which alternative a map is: the keys that none of them has. One of these
  /// may be the misspelt discriminator.
  void report_unknown_to_all(const SceneNode& node, const Key& key, const std::string& path) {
    std::vector<std::string> known{key.discriminator};
    for (const Alternative& alternative : key.alternatives) {
      for (const std::string& name : known_keys(alternative.schema(), "")) {
        if (std::find(known.begin(), known.end(), name) == known.end()) known.push_back(name);
      }
    }
    for (const SceneEntry& entry : node.entries) {
      if (std::find(known.begin(), known.end(), entry.key) == known.end()) {
        report_unknown(entry, known, join_path(path, entry.key));
      }
    }
  }

  void run_checks(const SceneNode& node, const Schema& schema, const void* object,
                  const std::string& path) {
    std::vector<Problem> found;
    for (const auto& check : schema.checks) check(object, found);
    for (Problem& problem : found) {
      // An empty key means this map; with its place, since the map is known here.
      const Place place = place_of(node, problem.key);
      report(place, join_path(path, problem.key), std::move(problem.message));
    }
  }

  void read_key(const SceneNode& node, const Key& key, void* object, const std::string& path) {
    switch (key.kind) {
      case KeyKind::section:
        if (!key.absent_word.empty() && node.kind == Kind::scalar && node.text == key.absent_word)
          return;
        if (const Key* nested = in_place_of(node, key)) {
          read_in_place(node, key, *nested, object, path);
        } else if (is_kind(node, Kind::map, expected_of(key), path)) {
          read_map(node, key.alternatives.front().schema(), key.open(object, "", 0), path, "");
        }
        return;
      case KeyKind::named_sections:
        read_named_sections(node, key, object, path);
        return;
      case KeyKind::section_list:
        if (!is_kind(node, Kind::list, expected_of(key), path)) return;
        add_text_problems(node, path);
        for (std::size_t i = 0; i < node.items.size(); ++i) {
          const std::string item_path = join_path(path, std::to_string(i));
          if (!is_kind(node.items[i], Kind::map, "a map", item_path)) continue;
          read_map(node.items[i], key.alternatives.front().schema(), key.open(object, "", 0),
                   item_path, "");
        }
        return;
      case KeyKind::parameters:
        return;  // read before the others
      case KeyKind::flag:
      case KeyKind::integer:
      case KeyKind::real:
      case KeyKind::text:
      case KeyKind::choice:
      case KeyKind::real_list:
      case KeyKind::text_list:
      case KeyKind::curve: {
        const Value value = read_value(node, key, path);
        if (!std::holds_alternative<std::monostate>(value)) key.assign(object, value);
        return;
      }
    }
  }

  /// The key of a section whose value stands in the place of the whole section, if one does.
  static const Key* in_place_of(const SceneNode& node, const Key& section) {
    if (node.kind == Kind::scalar) return number_in_place_of(section);
    return node.kind == Kind::list ? list_in_place_of(section) : nullptr;
  }

  void read_in_place(const SceneNode& node, const Key& section, const Key& nested, void* object,
                     const std::string& path) {
    const std::size_t num_before = problems_.size();
    const Value value = read_value(node, nested, path);
    if (problems_.size() > num_before || std::holds_alternative<std::monostate>(value)) return;
    void* opened = section.open(object, "", 0);
    nested.assign(opened, value);
    run_checks(node, section.alternatives.front().schema(), opened, path);
  }

  void read_named_sections(const SceneNode& node, const Key& key, void* object,
                           const std::string& path) {
    if (!is_kind(node, Kind::map, expected_of(key), path)) return;
    add_text_problems(node, path);
    for (const SceneEntry& entry : node.entries) {
      const std::string entry_path = join_path(path, entry.key);
      if (!is_section_name(entry.key)) {
        report(entry.place, entry_path,
               fmt::format(
                   "{} cannot be a name; use letters, digits, '_' and '-', a letter or '_' first",
                   quoted(entry.key)));
        collect_text_problems(entry.value, entry_path, problems_);
        continue;
      }
      if (entry.value.kind == Kind::null) {
        report(entry.place, entry_path, "has no value, expected a map");
        add_text_problems(entry.value, entry_path);
        continue;
      }
      if (!is_kind(entry.value, Kind::map, "a map", entry_path)) continue;
      const auto alternative = choose_alternative(entry.value, key, entry_path);
      if (!alternative) {
        report_unknown_to_all(entry.value, key, entry_path);
        collect_text_problems(entry.value, entry_path, problems_);
        continue;
      }
      read_map(entry.value, key.alternatives[*alternative].schema(),
               key.open(object, entry.key, *alternative), entry_path, key.discriminator);
    }
  }

  std::optional<std::size_t> choose_alternative(const SceneNode& node, const Key& key,
                                                const std::string& path) {
    if (key.discriminator.empty()) return 0;
    const std::string type_path = join_path(path, key.discriminator);
    const std::vector<std::string> names = names_of(key.alternatives);
    const std::string expected = fmt::format("one of {}", joined(names));
    const SceneEntry* type = node.entry(key.discriminator);
    if (!type) {
      report(node.place, type_path,
             fmt::format("required key '{}' is missing, expected {}", key.discriminator, expected));
      return std::nullopt;
    }
    if (type->value.kind != Kind::scalar) {
      report(type->value.kind == Kind::null ? type->place : type->value.place, type_path,
             type->value.kind == Kind::null
                 ? fmt::format("has no value, expected {}", expected)
                 : fmt::format("expected {}, got {}", expected, found_in(type->value)));
      return std::nullopt;
    }
    const auto found = std::find(names.begin(), names.end(), type->value.text);
    if (found == names.end()) {
      report(type->value.place, type_path,
             fmt::format("expected {}, got {}{}", expected, quoted(type->value.text),
                         did_you_mean(type->value.text, names)));
      return meant_alternative(type->value.text, names);
    }
    add_text_problems(type->value, type_path);
    return static_cast<std::size_t>(found - names.begin());
  }

  /// Which alternative is read on where its name is misspelt: the nearest one.
  static std::optional<std::size_t> meant_alternative(const std::string& written,
                                                      const std::vector<std::string>& names) {
    const auto meant = std::find(names.begin(), names.end(), nearest(written, names));
    if (meant == names.end()) return std::nullopt;
    return static_cast<std::size_t>(meant - names.begin());
  }

  /// The value of a scalar, list or curve key; monostate where it is wrong, which has been
  /// reported.
  Value read_value(const SceneNode& node, const Key& key, const std::string& path) {
    switch (key.kind) {
      case KeyKind::flag:
        return read_flag(node, path);
      case KeyKind::integer:
        return read_integer(node, key, path);
      case KeyKind::real:
        return as_value(read_real(node, key.unit, key.range, path));
      case KeyKind::text:
        if (!is_scalar(node, expected_of(key), path)) return {};
        return node.text;
      case KeyKind::choice:
        return read_choice(node, key, path);
      case KeyKind::real_list:
        return as_value(read_reals(node, key.unit, key.range, path));
      case KeyKind::text_list:
        return read_texts(node, key, path);
      case KeyKind::curve:
        return node.kind == Kind::map ? read_table(node, key, path)
                                      : read_constant(node, key, path);
      case KeyKind::section:
      case KeyKind::named_sections:
      case KeyKind::section_list:
      case KeyKind::parameters:
        break;
    }
    return {};
  }

  template <class T>
  static Value as_value(std::optional<T> read) {
    return read ? Value(std::move(*read)) : Value{};
  }

  Value read_flag(const SceneNode& node, const std::string& path) {
    if (!is_scalar(node, "true or false", path)) return {};
    if (node.text == "true") return true;
    if (node.text == "false") return false;
    report(node.place, path, fmt::format("expected true or false, got {}", quoted(node.text)));
    return {};
  }

  Value read_integer(const SceneNode& node, const Key& key, const std::string& path) {
    if (!is_scalar(node, "a whole number", path)) return {};
    if (is_expression(node.text)) return read_whole_result(node, key, path);
    const bool has_plus = node.text.starts_with('+') && !node.text.starts_with("+-");
    const char* begin = node.text.data() + (has_plus ? 1 : 0);
    const char* end = node.text.data() + node.text.size();
    std::int64_t value = 0;
    const auto [stop, status] = std::from_chars(begin, end, value);
    const bool is_too_large = status == std::errc::result_out_of_range && stop == end;
    if ((status != std::errc() && !is_too_large) || stop != end) {
      report(node.place, path,
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
    const auto value = parameters_.value_of(node, path, problems_);
    if (!value) return {};
    if (*value != std::trunc(*value)) {
      report(node.place, path,
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
    report(node.place, path,
           fmt::format("must be {}, got {:.0f}{}", key.range.text(), whole, written(node)));
    return false;
  }

  void report_not_storable(const SceneNode& node, const std::string& path) {
    report(node.place, path,
           fmt::format("is too far from 0 to be stored, got {}", quoted(node.text)));
  }

  /// How a number was written, where it was not in the form in which messages show it.
  static std::string written(const SceneNode& node) {
    return is_bare_number(node.text) ? "" : fmt::format(" (written {})", quoted(node.text));
  }

  std::optional<double> read_real(const SceneNode& node, const std::string& unit,
                                  const Range& range, const std::string& path) {
    if (!is_scalar(node, in_unit("a number", unit), path)) return std::nullopt;
    const auto value = is_expression(node.text) ? parameters_.value_of(node, path, problems_)
                                                : read_quantity(node, unit, path);
    if (!value) return std::nullopt;
    if (!range.contains(*value)) {
      report(node.place, path, range_message(range, *value, unit) + written(node));
      return std::nullopt;
    }
    if (const std::string message = magnitude_message(*value, unit); !message.empty()) {
      report(node.place, path, message);
      return std::nullopt;
    }
    return value;
  }

  std::optional<double> read_quantity(const SceneNode& node, const std::string& unit,
                                      const std::string& path) {
    if (quoted(node.text) != "'" + node.text + "'") {  // no number is long or has line breaks
      report(node.place, path,
             fmt::format("expected {}, got {}", in_unit("a number", unit), quoted(node.text)));
      return std::nullopt;
    }
    try {
      return parse_quantity(node.text, unit);
    } catch (const std::invalid_argument& error) {
      report(node.place, path, error.what());
      return std::nullopt;
    }
  }

  std::optional<std::vector<double>> read_reals(const SceneNode& node, const std::string& unit,
                                                const Range& range, const std::string& path) {
    if (!is_kind(node, Kind::list, in_unit("a list of numbers", unit), path)) return std::nullopt;
    add_text_problems(node, path);
    std::vector<double> values;
    for (std::size_t i = 0; i < node.items.size(); ++i) {
      const auto value = read_real(node.items[i], unit, range, join_path(path, std::to_string(i)));
      if (value) values.push_back(*value);
    }
    if (values.size() != node.items.size()) return std::nullopt;
    return values;
  }

  Value read_choice(const SceneNode& node, const Key& key, const std::string& path) {
    if (!is_scalar(node, expected_of(key), path)) return {};
    if (std::find(key.choices.begin(), key.choices.end(), node.text) != key.choices.end())
      return node.text;
    report(node.place, path,
           fmt::format("expected {}, got {}{}", expected_of(key), quoted(node.text),
                       did_you_mean(node.text, key.choices)));
    return {};
  }

  Value read_texts(const SceneNode& node, const Key& key, const std::string& path) {
    if (node.kind == Kind::scalar) {
      add_text_problems(node, path);
      const auto text = text_of(node, key, path);
      return text ? Value(std::vector<std::string>{*text}) : Value{};
    }
    if (!is_kind(node, Kind::list, expected_of(key), path)) return {};
    add_text_problems(node, path);
    std::vector<std::string> texts;
    for (std::size_t i = 0; i < node.items.size(); ++i) {
      const SceneNode& item = node.items[i];
      const std::string item_path = join_path(path, std::to_string(i));
      if (key.has_rows && item.kind == Kind::list) {
        if (auto row = read_row(item, item_path)) texts.push_back(std::move(*row));
      } else if (is_scalar(item, key.has_rows ? "a row of numbers" : "a text", item_path)) {
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
    const std::size_t num_before = problems_.size();
    const auto value = parameters_.value_of(node, path, problems_);
    if (problems_.size() > num_before)
      problems_.back().message += "; a row of several is a list: [=a, =b]";
    return value ? std::optional(fmt::format("{}", *value)) : std::nullopt;
  }

  /// The text of a list of numbers, as they are written.
  std::optional<std::string> read_row(const SceneNode& node, const std::string& path) {
    add_text_problems(node, path);
    const auto numbers = read_reals(node, "", Range::any(), path);
    if (!numbers) return std::nullopt;
    return fmt::format("{}", fmt::join(*numbers, " "));
  }

  Value read_constant(const SceneNode& node, const Key& key, const std::string& path) {
    if (!is_kind(node, Kind::scalar, expected_of(key), path)) return {};
    return as_value(read_real(node, key.unit, key.range, path));
  }

  Value read_table(const SceneNode& node, const Key& key, const std::string& path) {
    add_text_problems(node, path);
    static const std::vector<std::string> table_keys{"times", "values"};
    for (const SceneEntry& entry : node.entries) {
      if (std::find(table_keys.begin(), table_keys.end(), entry.key) != table_keys.end()) continue;
      const std::string suggestion = did_you_mean(entry.key, table_keys);
      report(entry.place, join_path(path, entry.key),
             fmt::format("unknown key {}{}", quoted(entry.key),
                         suggestion.empty() ? "; known here: times, values" : suggestion));
      collect_text_problems(entry.value, join_path(path, entry.key), problems_);
    }
    const auto times = read_column(node, "times", "s", Range::any(), path);
    const auto values = read_column(node, "values", key.unit, key.range, path);
    if (!times || !values) return {};

    // What the constructor of TimeCurve would throw for is said here, with its place.
    const SceneNode& times_node = node.entry("times")->value;
    if (times->empty()) {
      report(times_node.place, join_path(path, "times"), "needs at least one time");
      return {};
    }
    if (times->size() != values->size()) {
      report(node.entry("values")->value.place, join_path(path, "values"),
             fmt::format("has {} entries but times has {}; give one value for each time",
                         values->size(), times->size()));
      return {};
    }
    for (std::size_t i = 1; i < times->size(); ++i) {
      if ((*times)[i] > (*times)[i - 1]) continue;
      report(times_node.items[i].place, fmt::format("{}.times.{}", path, i),
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
      report(table.place, column_path,
             fmt::format("required key '{}' is missing, expected {}", name, expected));
      return std::nullopt;
    }
    if (entry->value.kind == Kind::null) {
      report(entry->place, column_path, fmt::format("has no value, expected {}", expected));
      return std::nullopt;
    }
    return read_reals(entry->value, unit, range, column_path);
  }

  std::vector<Problem>& problems_;
  SceneParameters parameters_;
};

}  // namespace

std::string expected_of(const Key& key) {
  switch (key.kind) {
    case KeyKind::flag:
      return "true or false";
    case KeyKind::integer:
      return "a whole number";
    case KeyKind::real:
      return in_unit("a number", key.unit);
    case KeyKind::text:
      return "a text";
    case KeyKind::choice:
      return fmt::format("one of {}", joined(key.choices));
    case KeyKind::real_list:
      return in_unit("a list of numbers", key.unit);
    case KeyKind::text_list:
      return key.has_rows ? "a text, or a list of rows of numbers" : "a text or a list of texts";
    case KeyKind::curve:
      return in_unit("a number", key.unit) + " or {times: [...], values: [...]}";
    case KeyKind::section: {
      std::string expected = key.absent_word.empty() ? "" : key.absent_word + " or ";
      if (const Key* number = number_in_place_of(key)) expected += expected_of(*number) + " or ";
      if (const Key* list = list_in_place_of(key)) expected += expected_of(*list) + " or ";
      return expected + "a map";
    }
    case KeyKind::named_sections:
      return "a map of named maps";
    case KeyKind::section_list:
      return "a list of maps";
    case KeyKind::parameters:
      return "a map of names to numbers";
  }
  return {};
}

void read_section(const SceneNode& node, const Schema& schema, void* object,
                  const std::string& path, std::vector<Problem>& problems) {
  Reader(problems).read_map(node, schema, object, path, "");
}

}  // namespace stridor
