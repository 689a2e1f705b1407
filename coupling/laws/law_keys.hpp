// Keys of sections that name a law and give it numbers: what friction and normal laws share.
#pragma once

#include <algorithm>
#include <map>
#include <string>
#include <variant>
#include <vector>

#include "core/schema.hpp"

namespace stridor {

/// The numbers that a scene gives to a law, SI, by their keys.
using LawNumbers = std::map<std::string, double>;

/// The keys of all laws, each once.
template <class Type>
auto keys_of_all(const std::vector<Type>& types) {
  auto all = decltype(Type::keys)();
  for (const Type& type : types) {
    for (const auto& key : type.keys) {
      if (std::none_of(all.begin(), all.end(),
                       [&](const auto& other) { return other.name == key.name; }))
        all.push_back(key);
    }
  }
  return all;
}

/// `law`, by the name of its type. Parameters: a struct with a pointer `law` to one of the types.
template <class Parameters, class Type>
Key law_key(const std::vector<Type>& types) {
  Key key;
  key.kind = KeyKind::choice;
  key.name = "law";
  key.is_optional = true;
  for (const Type& type : types) {
    key.choices.push_back(type.name);
    key.doc += (key.doc.empty() ? "" : "; ") + type.name + ": " + type.doc;
  }
  key.doc += ".";
  key.assign = [&types](void* object, const Value& value) {
    const auto& name = std::get<std::string>(value);
    static_cast<Parameters*>(object)->law = &*std::find_if(
        types.begin(), types.end(), [&](const Type& type) { return type.name == name; });
  };
  key.read = [](const void* object) -> Value {
    return static_cast<const Parameters*>(object)->law->name;
  };
  return key;
}

/// A number of a law. Parameters: a struct with LawNumbers `numbers`.
template <class Parameters, class LawKey>
Key number_key(const LawKey& of) {
  Key key;
  key.kind = KeyKind::real;
  key.name = of.name;
  key.doc = of.says.doc;
  key.unit = of.says.unit;
  key.range = of.says.range;
  key.is_optional = true;
  key.assign = [name = of.name](void* object, const Value& value) {
    static_cast<Parameters*>(object)->numbers[name] = std::get<double>(value);
  };
  key.read = [name = of.name](const void* object) -> Value {
    const LawNumbers& numbers = static_cast<const Parameters*>(object)->numbers;
    const auto given = numbers.find(name);
    return given == numbers.end() ? Value{} : Value{given->second};
  };
  return key;
}

/// Puts `law` and the numbers of all laws before the other keys of a section.
template <class Parameters, class Type>
void add_law_keys(Schema& section, const std::vector<Type>& types) {
  std::vector<Key> of_laws{law_key<Parameters>(types)};
  for (const auto& key : keys_of_all(types)) of_laws.push_back(number_key<Parameters>(key));
  section.keys.insert(section.keys.begin(), of_laws.begin(), of_laws.end());
}

}  // namespace stridor
