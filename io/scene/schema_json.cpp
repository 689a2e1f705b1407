#include "io/scene/schema_json.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <map>
#include <nlohmann/json.hpp>
#include <tuple>
#include <utility>

namespace stridor {
namespace {

using Json = nlohmann::ordered_json;

/// Beyond this, whole numbers are no longer all exact as JSON numbers.
constexpr double largest_exact = 9007199254740992.0;

/// 0 rather than 0.0, as users write it.
Json number_json(double value) {
  if (std::abs(value) < largest_exact && value == std::trunc(value)) {
    return static_cast<std::int64_t>(value);
  }
  return value;
}

Json numbers_json(const std::vector<double>& values) {
  Json list = Json::array();
  for (const double value : values) list.push_back(number_json(value));
  return list;
}

bool are_finite(const std::vector<double>& values) {
  return std::all_of(values.begin(), values.end(),
                     [](double value) { return std::isfinite(value); });
}

/// A default; null where the key simply is not given.
struct DefaultJson {
  Json operator()(std::monostate) const { return nullptr; }
  Json operator()(bool value) const { return value; }
  Json operator()(std::int64_t value) const { return value; }
  Json operator()(double value) const {
    return std::isfinite(value) ? number_json(value) : Json(nullptr);
  }
  Json operator()(const std::string& value) const { return value; }
  Json operator()(const std::vector<double>& values) const {
    return are_finite(values) ? numbers_json(values) : Json(nullptr);
  }
  Json operator()(const std::vector<std::string>& values) const {
    Json list = Json::array();
    for (const std::string& value : values) list.push_back(value);
    return list;
  }
  Json operator()(const TimeTable& table) const {
    Json json = Json::object();
    json["times"] = numbers_json(table.times);
    json["values"] = numbers_json(table.values);
    return json;
  }
  Json operator()(const NamedNumbers&) const { return nullptr; }
};

void add_bounds(Json& json, const Range& range) {
  if (std::isfinite(range.low)) {
    json[range.excludes_low ? "exclusiveMinimum" : "minimum"] = number_json(range.low);
  }
  if (std::isfinite(range.high)) {
    json[range.excludes_high ? "exclusiveMaximum" : "maximum"] = number_json(range.high);
  }
}

/// An expression (io/scene/expression.hpp).
constexpr const char* expression_pattern = "^=.";

/// An expression, or what parse_quantity (core/units.hpp) reads, as a regular expression without look-ahead, which
/// not every validator knows. Of the range only the sign is seen: the rest depends on the unit.
std::string quantity_pattern(const Range& range, const std::string& unit) {
  const std::string exponent = "([eE][+-]?[0-9]+)?";
  const std::string digits = "([0-9]+[.]?[0-9]*|[.][0-9]+)" + exponent;
  std::string number = "[+-]?" + digits;
  if (range.low > 0.0 || (range.low == 0.0 && range.excludes_low)) {
    number = "[+]?" + digits;
  } else if (range.low == 0.0) {
    number = "([+]?" + digits + "|-(0+[.]?0*|[.]0+)" + exponent + ")";
  }
  const std::string suffix =
      unit.empty() ? "([ \\t]*%|[ \\t]+1)?[ \\t]*" : "[ \\t]*((1?/)?[^ \\t0-9+.,:;_*/^-].*)?";
  return expression_pattern + ("|^[ \\t]*" + number + suffix + "$");
}

Json typed(const std::string& type) {
  Json json = Json::object();
  json["type"] = type;
  return json;
}

Json typed(const std::string& one, const std::string& other) {
  Json json = Json::object();
  json["type"] = Json::array({one, other});
  return json;
}

/// Bounds hold for a number and the pattern for a string; each ignores the other type.
Json real_json(const std::string& unit, const Range& range) {
  Json json = typed("number", "string");
  add_bounds(json, range);
  json["pattern"] = quantity_pattern(range, unit);
  return json;
}

Json integer_json(const Key& key) {
  Json json = typed("integer", "string");
  json["pattern"] = expression_pattern;
  Range range = key.range;
  if (key.storable.low > range.low && key.storable.low > -largest_exact) {
    range.low = key.storable.low;
    range.excludes_low = false;
  }
  if (key.storable.high < range.high && key.storable.high < largest_exact) {
    range.high = key.storable.high;
    range.excludes_high = false;
  }
  add_bounds(json, range);
  return json;
}

Json table_json(const Key& key) {
  const auto column = [](const std::string& doc, const std::string& unit, const Range& range) {
    Json json = Json::object();
    json["description"] = doc;
    json["type"] = "array";
    json["minItems"] = 1;
    json["items"] = real_json(unit, range);
    return json;
  };
  Json json = typed("object");
  json["properties"]["times"] = column("Strictly increasing times. Unit: s.", "s", Range::any());
  json["properties"]["values"] = column(
      fmt::format("Values at these times.{}", key.unit.empty() ? "" : " Unit: " + key.unit + "."),
      key.unit, key.range);
  json["required"] = Json::array({"times", "values"});
  json["additionalProperties"] = false;
  return json;
}

/// "Length along the axis. Unit: m. Range: > 0."
std::string description_of(const Key& key) {
  std::string text = key.doc;
  if (!key.unit.empty()) text += fmt::format(" Unit: {}.", key.unit);
  if (std::isfinite(key.range.low) || std::isfinite(key.range.high)) {
    text += fmt::format(" Range: {}.", key.range.text());
  }
  return text;
}

class Writer {
 public:
  /// The keys of a map; `discriminator` is one more that says which alternative it is.
  Json map_json(const Schema& schema, const std::string& discriminator,
                const std::string& alternative) {
    Json json = Json::object();
    json["title"] = schema.name;
    json["type"] = "object";
    Json properties = Json::object();
    Json required = Json::array();
    if (!discriminator.empty()) {
      Json& kind = properties[discriminator];
      kind["title"] = discriminator;
      kind["description"] = "Says which kind of entry this is.";
      kind["const"] = alternative;
      required.push_back(discriminator);
    }
    for (const Key& key : schema.keys) {
      properties[key.name] = key_json(schema, key);
      if (!key.is_optional) required.push_back(key.name);
    }
    json["properties"] = std::move(properties);
    if (!required.empty()) json["required"] = std::move(required);
    json["additionalProperties"] = false;
    return json;
  }

  /// {"$ref": ...} to the definition of a map of one kind.
  Json definition(const Schema& schema) {
    return reference({}, {"", [&schema]() -> const Schema& { return schema; }});
  }
  const Json& definitions() const { return definitions_; }

 private:
  Json key_json(const Schema& schema, const Key& key) {
    Json json = Json::object();
    json["title"] = key.name;
    json["description"] = description_of(key);
    json.update(value_json(key));
    if (key.is_optional && key.read) {
      Json value = std::visit(DefaultJson{}, schema.default_of(key));
      if (!value.is_null()) json["default"] = std::move(value);
    }
    return json;
  }

  Json value_json(const Key& key) {
    Json json = Json::object();
    switch (key.kind) {
      case KeyKind::flag:
        return typed("boolean");
      case KeyKind::integer:
        return integer_json(key);
      case KeyKind::real:
        return real_json(key.unit, key.range);
      case KeyKind::text:
        return typed("string");
      case KeyKind::choice:
        json["enum"] = key.choices;
        return json;
      case KeyKind::real_list:
        json = typed("array");
        json["items"] = real_json(key.unit, key.range);
        return json;
      case KeyKind::text_list:
        json = typed("string", "array");
        json["items"] = key.has_rows ? typed("string", "array") : typed("string");
        if (key.has_rows) json["items"]["items"] = real_json("", Range::any());
        return json;
      case KeyKind::curve:
        json["oneOf"] = Json::array({real_json(key.unit, key.range), table_json(key)});
        return json;
      case KeyKind::section:
        return section_json(key);
      case KeyKind::named_sections:
        json = typed("object");
        json["patternProperties"]["^[A-Za-z_][A-Za-z0-9_-]*$"] = entry_json(key);
        json["additionalProperties"] = false;
        return json;
      case KeyKind::section_list:
        json = typed("array");
        json["items"] = reference(key, key.alternatives.front());
        return json;
      case KeyKind::parameters:
        json = typed("object");
        json["patternProperties"]["^[A-Za-z_][A-Za-z0-9_]*$"] = real_json("any", Range::any());
        json["additionalProperties"] = false;
        return json;
    }
    return json;
  }

  /// A map, or what may stand in its place.
  Json section_json(const Key& key) {
    Json forms = Json::array();
    if (!key.absent_word.empty()) forms.push_back({{"const", key.absent_word}});
    for (const Key* nested : {number_in_place_of(key), list_in_place_of(key)})
      if (nested != nullptr) forms.push_back(value_json(*nested));
    if (forms.empty()) return reference(key, key.alternatives.front());
    forms.push_back(reference(key, key.alternatives.front()));
    Json json = Json::object();
    json["oneOf"] = std::move(forms);
    return json;
  }

  /// By the discriminator, the first form where it names none: messages about `oneOf` name no key.
  Json entry_json(const Key& key) {
    Json json = reference(key, key.alternatives.front());
    for (std::size_t i = key.alternatives.size(); i-- > 1;) {
      Json choice = Json::object();
      choice["if"]["properties"][key.discriminator]["const"] = key.alternatives[i].name;
      choice["if"]["required"] = Json::array({key.discriminator});
      choice["then"] = reference(key, key.alternatives[i]);
      choice["else"] = std::move(json);
      json = std::move(choice);
    }
    return json;
  }

  /// {"$ref": ...} to the definition of this map, which is written at its first use.
  Json reference(const Key& key, const Alternative& alternative) {
    const Schema& schema = alternative.schema();
    const auto [known, is_new] =
        names_.try_emplace({&schema, key.discriminator, alternative.name}, "");
    if (is_new) {
      std::string name = schema.name;
      for (int i = 2; definitions_.contains(name); ++i) {
        name = fmt::format("{}_{}", schema.name, i);
      }
      known->second = name;
      definitions_[name] = nullptr;  // keeps its place before those that it leads to
      Json definition = map_json(schema, key.discriminator, alternative.name);
      definitions_[name] = std::move(definition);
    }
    Json json = Json::object();
    json["$ref"] = "#/$defs/" + known->second;
    return json;
  }

  Json definitions_ = Json::object();
  std::map<std::tuple<const Schema*, std::string, std::string>, std::string> names_;
};

Json preamble() {
  Json json = Json::object();
  json["$schema"] = "https://json-schema.org/draft/2020-12/schema";
  json["$comment"] = "Made by `stridor schema` from the keys declared in the source; do not edit.";
  return json;
}

}  // namespace

Json json_schema(const Schema& schema) {
  Json json = preamble();
  Writer writer;
  json.update(writer.map_json(schema, "", ""));
  if (!writer.definitions().empty()) json["$defs"] = writer.definitions();
  return json;
}

std::string json_schema_text(const Schema& schema) {
  return json_schema(schema).dump(2) + "\n";
}

}  // namespace stridor
