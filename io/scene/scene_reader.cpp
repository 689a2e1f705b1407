#include "io/scene/scene_reader.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <optional>

#include "core/suggestion.hpp"
#include "io/scene/scene_parameters.hpp"
#include "io/scene/scene_problems.hpp"
#include "io/scene/scene_report.hpp"
#include "io/scene/scene_words.hpp"
#include "io/scene/value_reader.hpp"

namespace stridor {
namespace {

using Kind = SceneNode::Kind;

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

/// Reads maps, and the maps and lists of maps in them.
class Reader {
 public:
  explicit Reader(std::vector<Problem>& problems) : report_(problems) {}

  /// @param discriminator key of the map that has been read already, or ""
  void read_map(const SceneNode& node, const Schema& schema, void* object, const std::string& path,
                const std::string& discriminator) {
    if (!report_.is_kind(node, Kind::map, "a map", path)) return;
    const std::size_t num_before = report_.problems().size();
    report_.add_text_problems(node, path);
    const Key* named_numbers = read_parameters(node, schema, path);
    for (const SceneEntry& entry : node.entries) {
      if (entry.key == discriminator) continue;
      const std::string key_path = join_path(path, entry.key);
      const Key* key = schema.find(entry.key);
      if (!key) {
        report_unknown(entry, known_keys(schema, discriminator), key_path);
        collect_text_problems(entry.value, key_path, report_.problems());
      } else if (entry.value.kind == Kind::null) {
        report_.add(Refusal::missing, entry.place, key_path,
                    fmt::format("has no value, expected {}", expected_of(*key)));
        report_.add_text_problems(entry.value, key_path);
      } else {
        read_key(entry.value, *key, object, key_path);
      }
    }
    for (const Key& key : schema.keys) {
      if (!key.is_optional && node.entry(key.name) == nullptr) {
        report_.add(Refusal::missing, node.place, join_path(path, key.name),
                    fmt::format("required key '{}' is missing, expected {}: {}", key.name,
                                expected_of(key), key.doc));
      }
    }
    if (named_numbers != nullptr) {
      // Of a map that was read as a whole, or a use may have been overlooked.
      if (report_.problems().size() == num_before)
        parameters_.refuse_idle_settings(report_.problems());
      named_numbers->assign(object, parameters_.numbers());
    }
    if (report_.problems().size() == num_before) run_checks(node, schema, object, path);
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
      if (!report_.is_kind(entry.value, Kind::map, expected_of(*key), key_path)) return nullptr;
      report_.add_text_problems(entry.value, key_path);
      parameters_.read(entry.value, key_path, report_.problems());
      return key;
    }
    return nullptr;
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
    report_.add(Refusal::unknown_key, entry.place, path,
                fmt::format("unknown key {}{}", quoted(entry.key), advice));
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
      report_.add(problem.refusal, place, join_path(path, problem.key), std::move(problem.message));
    }
  }

  void read_key(const SceneNode& node, const Key& key, void* object, const std::string& path) {
    switch (key.kind) {
      case KeyKind::section:
        if (!key.absent_word.empty() && node.kind == Kind::scalar && node.text == key.absent_word)
          return;
        if (const Key* nested = in_place_of(node, key)) {
          read_in_place(node, key, *nested, object, path);
        } else if (report_.is_kind(node, Kind::map, expected_of(key), path)) {
          read_map(node, key.alternatives.front().schema(), key.open(object, "", 0), path, "");
        }
        return;
      case KeyKind::named_sections:
        read_named_sections(node, key, object, path);
        return;
      case KeyKind::section_list:
        if (!report_.is_kind(node, Kind::list, expected_of(key), path)) return;
        report_.add_text_problems(node, path);
        for (std::size_t i = 0; i < node.items.size(); ++i) {
          const std::string item_path = join_path(path, std::to_string(i));
          if (!report_.is_kind(node.items[i], Kind::map, "a map", item_path)) continue;
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
        const Value value = read_value(node, key, path, parameters_, report_);
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
    const std::size_t num_before = report_.problems().size();
    const Value value = read_value(node, nested, path, parameters_, report_);
    if (report_.problems().size() > num_before || std::holds_alternative<std::monostate>(value))
      return;
    void* opened = section.open(object, "", 0);
    nested.assign(opened, value);
    run_checks(node, section.alternatives.front().schema(), opened, path);
  }

  void read_named_sections(const SceneNode& node, const Key& key, void* object,
                           const std::string& path) {
    if (!report_.is_kind(node, Kind::map, expected_of(key), path)) return;
    report_.add_text_problems(node, path);
    for (const SceneEntry& entry : node.entries) {
      const std::string entry_path = join_path(path, entry.key);
      if (!is_section_name(entry.key)) {
        report_.add(
            Refusal::wrong_value, entry.place, entry_path,
            fmt::format(
                "{} cannot be a name; use letters, digits, '_' and '-', a letter or '_' first",
                quoted(entry.key)));
        collect_text_problems(entry.value, entry_path, report_.problems());
        continue;
      }
      if (entry.value.kind == Kind::null) {
        report_.add(Refusal::missing, entry.place, entry_path, "has no value, expected a map");
        report_.add_text_problems(entry.value, entry_path);
        continue;
      }
      if (!report_.is_kind(entry.value, Kind::map, "a map", entry_path)) continue;
      const auto alternative = choose_alternative(entry.value, key, entry_path);
      if (!alternative) {
        report_unknown_to_all(entry.value, key, entry_path);
        collect_text_problems(entry.value, entry_path, report_.problems());
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
      report_.add(
          Refusal::missing, node.place, type_path,
          fmt::format("required key '{}' is missing, expected {}", key.discriminator, expected));
      return std::nullopt;
    }
    if (type->value.kind != Kind::scalar) {
      report_.add(Refusal::missing,
                  type->value.kind == Kind::null ? type->place : type->value.place, type_path,
                  type->value.kind == Kind::null
                      ? fmt::format("has no value, expected {}", expected)
                      : fmt::format("expected {}, got {}", expected, found_in(type->value)));
      return std::nullopt;
    }
    const auto found = std::find(names.begin(), names.end(), type->value.text);
    if (found == names.end()) {
      report_.add(Refusal::wrong_value, type->value.place, type_path,
                  fmt::format("expected {}, got {}{}", expected, quoted(type->value.text),
                              did_you_mean(type->value.text, names)));
      return meant_alternative(type->value.text, names);
    }
    report_.add_text_problems(type->value, type_path);
    return static_cast<std::size_t>(found - names.begin());
  }

  /// Which alternative is read on where its name is misspelt: the nearest one.
  static std::optional<std::size_t> meant_alternative(const std::string& written,
                                                      const std::vector<std::string>& names) {
    const auto meant = std::find(names.begin(), names.end(), nearest(written, names));
    if (meant == names.end()) return std::nullopt;
    return static_cast<std::size_t>(meant - names.begin());
  }

  SceneReport report_;
  SceneParameters parameters_;
};

}  // namespace

void read_section(const SceneNode& node, const Schema& schema, void* object,
                  const std::string& path, std::vector<Problem>& problems) {
  Reader(problems).read_map(node, schema, object, path, "");
}

}  // namespace stridor
