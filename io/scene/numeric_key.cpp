#include "io/scene/numeric_key.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "core/suggestion.hpp"
#include "core/units.hpp"
#include "io/scene/scene_reader.hpp"
#include "io/scene/scene_words.hpp"

namespace stridor {
namespace {

std::vector<std::string> key_names(const Schema& schema) {
  std::vector<std::string> names;
  for (const Key& key : schema.keys) names.push_back(key.name);
  return names;
}

[[noreturn]] void fail_unknown(const std::string& option, const std::string& path,
                               const std::string& part, const std::string& below,
                               const std::vector<std::string>& known) {
  std::string advice = did_you_mean(part, known);
  if (advice.empty()) advice = fmt::format("; known there: {}", fmt::join(known, ", "));
  throw ConfigError(Refusal::unknown_key, option,
                    fmt::format("'{}': there is no key '{}'{}{}", path, part,
                                below.empty() ? "" : " in '" + below + "'", advice));
}

/// An entry of named sections and what it holds.
struct NamedEntry {
  std::string name;
  std::size_t alternative = 0;
  const void* object = nullptr;
};

/// The parameters of a scene.
NamedNumbers parameters_of(const Schema& schema, const void* object) {
  for (const Key& key : schema.keys)
    if (key.kind == KeyKind::parameters) return std::get<NamedNumbers>(key.read(object));
  return {};
}

NumericKey parameter_key(const NamedNumbers& numbers, const std::string& path,
                         const std::string& option) {
  const std::size_t dot = std::min(path.find('.'), path.size());
  const std::string name = path.substr(std::min(dot + 1, path.size()));
  std::vector<std::string> names;
  for (const NamedNumber& number : numbers) {
    names.push_back(number.name);
    if (number.name != name) continue;
    if (!number.is_used) {
      throw ConfigError(Refusal::expression, option,
                        fmt::format("no expression of the scene uses '{}', so varying it "
                                    "changes nothing",
                                    path));
    }
    return {path, number.unit, Range::any()};
  }
  fail_unknown(option, path, name, path.substr(0, dot), names);
}

std::vector<NamedEntry> entries_of(const Key& key, const void* object) {
  std::vector<NamedEntry> entries;
  if (object == nullptr) return entries;
  key.visit(object, [&](const std::string& name, std::size_t alternative, const void* entry) {
    entries.push_back({name, alternative, entry});
  });
  return entries;
}

}  // namespace

bool is_parameter(const NumericKey& key) {
  return key.path.starts_with("parameters.");
}

NumericKey find_numeric_key(const Scene& scene, const std::string& path,
                            const std::string& option) {
  return find_numeric_key(Scene::schema(), &scene, path, option);
}

namespace {

/// A walk along the parts of a path, from a schema to a number.
class KeyWalk {
 public:
  KeyWalk(const Schema& keys, const void* object, const std::string& path,
          const std::string& option)
      : root_(keys), schema_(&keys), object_(object), path_(path), option_(option) {}

  NumericKey find() {
    while (begin_ <= path_.size()) {
      const std::string part = next_part();
      const Key* key = schema_->find(part);
      if (key == nullptr) fail_unknown_part(part);
      walked_ = join_path(walked_, part);
      if (const auto found = step_into(*key)) return *found;
    }
    throw ConfigError(Refusal::wrong_value, option_, fmt::format("'{}' is not a key path", path_));
  }

 private:
  bool is_at_end() const { return begin_ > path_.size(); }

  std::string next_part() {
    const std::size_t end = std::min(path_.find('.', begin_), path_.size());
    const std::string part = path_.substr(begin_, end - begin_);
    begin_ = end + 1;
    return part;
  }

  [[noreturn]] void fail_unknown_part(const std::string& part) const {
    if (schema_ == &root_) {
      for (const NamedNumber& number : parameters_of(root_, object_)) {
        if (number.name != part) continue;
        throw ConfigError(Refusal::wrong_value, option_,
                          fmt::format("'{0}' is a parameter of the scene; write "
                                      "'parameters.{0}'",
                                      part));
      }
    }
    fail_unknown(option_, path_, part, walked_, key_names(*schema_));
  }

  [[noreturn]] void refuse_section(const Schema& schema) const {
    throw ConfigError(Refusal::wrong_value, option_,
                      fmt::format("'{}' is a section; name one of its numbers ({})", path_,
                                  fmt::join(key_names(schema), ", ")));
  }

  /// @return the number, where the key is one; else the walk goes on within it
  std::optional<NumericKey> step_into(const Key& key) {
    switch (key.kind) {
      case KeyKind::section: {
        if (is_at_end()) {
          if (const Key* number = number_in_place_of(key))
            return NumericKey{path_, number->unit, number->range, false};
          refuse_section(key.alternatives[0].schema());
        }
        const auto entries = entries_of(key, object_);
        object_ = entries.empty() ? nullptr : entries.front().object;
        schema_ = &key.alternatives[0].schema();
        return std::nullopt;
      }
      case KeyKind::named_sections:
        enter_named(key);
        return std::nullopt;
      case KeyKind::parameters:
        return parameter_key(std::get<NamedNumbers>(key.read(object_)), path_, option_);
      case KeyKind::integer:
      case KeyKind::real:
      case KeyKind::curve:
        if (!is_at_end()) fail_unknown(option_, path_, path_.substr(begin_), walked_, {});
        return NumericKey{path_, key.unit, key.range, key.kind == KeyKind::integer};
      case KeyKind::flag:
      case KeyKind::text:
      case KeyKind::choice:
      case KeyKind::real_list:
      case KeyKind::text_list:
      case KeyKind::section_list:
        break;
    }
    throw ConfigError(
        Refusal::wrong_value, option_,
        fmt::format("'{}' is no number that could be varied, but {}", walked_, expected_of(key)));
  }

  /// Into the entry that the next part names.
  void enter_named(const Key& key) {
    const auto entries = entries_of(key, object_);
    std::vector<std::string> names;
    names.reserve(entries.size());
    for (const NamedEntry& entry : entries) names.push_back(entry.name);
    const std::string name = is_at_end() ? "" : next_part();
    const auto found = std::find(names.begin(), names.end(), name);
    if (found == names.end()) fail_unknown(option_, path_, name, walked_, names);
    const NamedEntry& entry = entries[static_cast<std::size_t>(found - names.begin())];
    schema_ = &key.alternatives[entry.alternative].schema();
    object_ = entry.object;
    walked_ = join_path(walked_, name);
    if (is_at_end()) refuse_section(*schema_);
  }

  const Schema& root_;
  const Schema* schema_;
  const void* object_;
  const std::string& path_;
  const std::string& option_;
  std::string walked_;
  std::size_t begin_ = 0;  ///< of the next part
};

}  // namespace

NumericKey find_numeric_key(const Schema& keys, const void* object, const std::string& path,
                            const std::string& option) {
  return KeyWalk(keys, object, path, option).find();
}

double parse_value(const NumericKey& key, const std::string& text, const std::string& option) {
  double value = 0.0;
  try {
    value = parse_quantity(text, key.unit);
  } catch (const QuantityError& error) {
    throw ConfigError(error.refusal(), option, fmt::format("{} ({})", error.what(), key.path));
  }
  if (key.is_integer && value != std::round(value)) {
    throw ConfigError(Refusal::wrong_value, option,
                      fmt::format("'{}' must be a whole number, as {} is", text, key.path));
  }
  if (!key.range.contains(value)) {
    throw ConfigError(Refusal::wrong_value, option,
                      fmt::format("{} must be {}{}{}, got '{}'", key.path, key.range.text(),
                                  key.unit.empty() ? "" : " ", key.unit, text));
  }
  return value;
}

std::vector<double> spaced_values(const NumericKey& key, double from, double to, int count,
                                  Spacing spacing) {
  if (count < 1)
    throw ConfigError(Refusal::wrong_value, "--points",
                      fmt::format("must be at least 1, got {}", count));
  if (from == to) return {from};
  if (count < 2) {
    throw ConfigError(Refusal::wrong_value, "--points",
                      fmt::format("1 point is enough only where both ends of the range "
                                  "of {} are the same",
                                  key.path));
  }
  if (spacing == Spacing::logarithmic && !(from > 0.0 && to > 0.0)) {
    throw ConfigError(Refusal::wrong_value, "--scale",
                      fmt::format("a logarithmic scale needs positive values of {}, got "
                                  "{:g} to {:g}",
                                  key.path, from, to));
  }
  std::vector<double> values;
  for (int i = 0; i < count; ++i) {
    const double share = static_cast<double>(i) / (count - 1);
    double value = spacing == Spacing::linear ? (1.0 - share) * from + share * to
                                              : from * std::pow(to / from, share);
    if (i == 0) value = from;
    if (i == count - 1) value = to;
    // 0.6·1 + 0.4·6 is not 3 to the last bit.
    constexpr double rounding = 1e-12;
    if (key.is_integer && std::abs(value - std::round(value)) <= rounding * std::abs(value))
      value = std::round(value);
    if (key.is_integer && value != std::round(value)) {
      throw ConfigError(Refusal::wrong_value, "--points",
                        fmt::format("{} points from {:g} to {:g} are not whole numbers, as {} is; "
                                    "{:g} points would be",
                                    count, from, to, key.path, std::abs(to - from) + 1.0));
    }
    values.push_back(value);
  }
  return values;
}

}  // namespace stridor
