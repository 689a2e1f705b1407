#include "io/scene/resolved_scene.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <string_view>
#include <vector>

namespace stridor {
namespace {

/// A text as YAML: plain where no reader can take it for something else, else in double quotes.
std::string yaml_text(const std::string& text) {
  // Words that this or another reader of YAML 1.1 takes for null or a truth value.
  static constexpr std::array<std::string_view, 10> words{"null", "true", "false", "yes", "no",
                                                          "on",   "off",  "y",     "n",   "nan"};
  const auto is_plain = [](char c) {
    return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') || c == '_' ||
           c == '-' || c == '.' || c == '/';
  };
  std::string lower = text;
  for (char& c : lower) {
    if (c >= 'A' && c <= 'Z') c = static_cast<char>(c - 'A' + 'a');
  }
  const bool starts_with_letter = !lower.empty() && lower.front() >= 'a' && lower.front() <= 'z';
  if (starts_with_letter && std::all_of(text.begin(), text.end(), is_plain) &&
      std::find(words.begin(), words.end(), lower) == words.end()) {
    return text;
  }
  std::string quoted = "\"";
  for (const char c : text) {
    const auto byte = static_cast<unsigned char>(c);
    if (c == '"' || c == '\\') {
      quoted += '\\';
      quoted += c;
    } else if (byte < 0x20 || byte == 0x7F) {
      quoted += fmt::format("\\x{:02x}", byte);
    } else {
      quoted += c;
    }
  }
  return quoted + '"';
}

/// "[a, b]". Not fmt::join, over which g++ 12 warns at -O3 in fmt 9.
std::string yaml_list(const std::vector<std::string>& items) {
  std::string text = "[";
  for (const std::string& item : items) text += (text.size() == 1 ? "" : ", ") + item;
  return text + "]";
}

std::string yaml_list(const std::vector<double>& values) {
  std::vector<std::string> items;
  for (const double value : values) items.push_back(fmt::format("{}", value));
  return yaml_list(items);
}

bool all_finite(const std::vector<double>& values) {
  return std::all_of(values.begin(), values.end(),
                     [](double value) { return std::isfinite(value); });
}

/// A value in one line; "" where it is left out.
struct InOneLine {
  std::string operator()(std::monostate) const { return {}; }
  std::string operator()(bool value) const { return value ? "true" : "false"; }
  std::string operator()(std::int64_t value) const { return fmt::format("{}", value); }
  std::string operator()(double value) const {
    return std::isfinite(value) ? fmt::format("{}", value) : "";
  }
  std::string operator()(const std::string& value) const { return yaml_text(value); }
  std::string operator()(const std::vector<double>& values) const {
    return all_finite(values) ? yaml_list(values) : "";
  }
  std::string operator()(const std::vector<std::string>& values) const {
    std::vector<std::string> items;
    for (const std::string& value : values) items.push_back(yaml_text(value));
    return yaml_list(items);
  }
  std::string operator()(const TimeTable& table) const {
    return fmt::format("{{times: {}, values: {}}}", yaml_list(table.times),
                       yaml_list(table.values));
  }
  std::string operator()(const NamedNumbers& numbers) const {
    std::string text;
    for (const NamedNumber& number : numbers) {
      const std::string value = fmt::format("{}", number.value);
      text += fmt::format("{}{}: {}", text.empty() ? "{" : ", ", yaml_text(number.name),
                          number.unit.empty() ? value : yaml_text(value + " " + number.unit));
    }
    return text.empty() ? "" : text + "}";
  }
};

using Lines = std::vector<std::string>;

Lines lines_of(const Schema& schema, const void* object);

void append_indented(Lines& lines, const Lines& inner) {
  for (const std::string& line : inner) lines.push_back("  " + line);
}

/// "name:" over its indented map, or "name: {}".
void append_map(Lines& lines, const std::string& name, const Lines& inner) {
  lines.push_back(name + (inner.empty() ? ": {}" : ":"));
  append_indented(lines, inner);
}

Lines entry_lines(const Key& key, std::size_t alternative, const void* object) {
  Lines lines = lines_of(key.alternatives[alternative].schema(), object);
  if (!key.discriminator.empty()) {
    lines.insert(lines.begin(),
                 key.discriminator + ": " + yaml_text(key.alternatives[alternative].name));
  }
  return lines;
}

/// What may be written in the place of a section of which only one key is given; "" if nothing.
std::string value_in_place(const Key& key, const Lines& inner) {
  if (inner.size() != 1) return "";
  for (const std::string& name : {key.number_key, key.list_key}) {
    if (!name.empty() && inner.front().starts_with(name + ": "))
      return inner.front().substr(name.size() + 2);
  }
  return "";
}

void append_sections(Lines& lines, const Key& key, const void* object) {
  Lines inner;
  bool is_present = key.kind != KeyKind::section;
  key.visit(object, [&](const std::string& name, std::size_t alternative, const void* nested) {
    Lines entry = entry_lines(key, alternative, nested);
    is_present = true;
    if (key.kind == KeyKind::named_sections) {
      append_map(inner, yaml_text(name), entry);
    } else if (key.kind == KeyKind::section_list) {
      if (entry.empty()) entry = {"{}"};
      for (std::size_t i = 0; i < entry.size(); ++i)
        inner.push_back((i == 0 ? "- " : "  ") + entry[i]);
    } else {
      inner = std::move(entry);
    }
  });
  if (!is_present && !key.absent_word.empty()) lines.push_back(key.name + ": " + key.absent_word);
  if (!is_present) return;
  if (const std::string value = value_in_place(key, inner); !value.empty()) {
    lines.push_back(key.name + ": " + value);
    return;
  }
  if (key.kind == KeyKind::section_list && inner.empty()) {
    lines.push_back(key.name + ": []");
  } else {
    append_map(lines, key.name, inner);
  }
}

Lines lines_of(const Schema& schema, const void* object) {
  Lines lines;
  for (const Key& key : schema.keys) {
    if (key.visit) {
      append_sections(lines, key, object);
      continue;
    }
    const std::string value = std::visit(InOneLine{}, key.read(object));
    if (!value.empty()) lines.push_back(key.name + ": " + value);
  }
  return lines;
}

}  // namespace

std::string resolved_yaml(const Schema& schema, const void* object) {
  const Lines lines = lines_of(schema, object);
  if (lines.empty()) return "{}\n";
  std::string text;
  for (const std::string& line : lines) text += line + "\n";
  return text;
}

}  // namespace stridor
