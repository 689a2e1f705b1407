// The vocabulary in which scene keys are declared: once, beside the struct that they fill.
//
// A parameter struct declares its keys in a static function
//
//   struct Material {
//     double youngs_modulus, poissons_ratio, density;
//     static const Schema& schema();
//   };
//   const Schema& Material::schema() {
//     static const Schema keys = SchemaOf<Material>("material")
//         .real("youngs_modulus", &Material::youngs_modulus,
//               {.doc = "Young's modulus.", .unit = "Pa", .range = Range::positive()})
//         ...;
//     return keys;
//   }
//
// The reader of scenes, the checker, the JSON Schema and the reference page all walk the same
// declarations. A key is required unless it is declared `.optional = true`; the default of an
// optional key is the value that its member has in a default-constructed struct.
#pragma once

#include <cstddef>
#include <functional>
#include <map>
#include <string>
#include <type_traits>
#include <utility>
#include <variant>
#include <vector>

#include "core/errors.hpp"
#include "core/key.hpp"
#include "core/member_value.hpp"

namespace stridor {

/// Declaration of a number (or of a list of numbers, or a curve) besides its name and member.
struct RealKey {
  std::string doc;
  std::string unit = "";
  Range range = Range::any();
  bool optional = false;
};
/// Declaration of any other key besides its name and member.
struct PlainKey {
  std::string doc;
  bool optional = false;
  Range range = Range::any();
  std::string absent_word = "";  ///< of an optional section: may stand for "not given"
  /// Of a section: its key that a number (a list) in its place stands for.
  std::string number_key = "";
  std::string list_key = "";
};

/// The words that stand for the values of an enum in a scene.
template <class Enum>
using ChoiceWords = std::vector<std::pair<std::string, Enum>>;

/// The word of a value that is among them; empty for another.
template <class Enum>
std::string word_of(const ChoiceWords<Enum>& words, Enum value) {
  for (const auto& [word, meaning] : words) {
    if (meaning == value) return word;
  }
  return {};
}

/// Builder of the Schema of the struct T.
template <class T>
class SchemaOf {
 public:
  explicit SchemaOf(std::string name) {
    schema_.name = std::move(name);
    schema_.default_of = [](const Key& key) {
      const T defaults{};
      return key.read ? key.read(&defaults) : Value{};
    };
  }

  /// double or std::optional<double>.
  template <class M>
  SchemaOf& real(std::string name, M T::*member, RealKey says) {
    return add(KeyKind::real, std::move(name), member, std::move(says));
  }
  /// std::vector<double>.
  template <class M>
  SchemaOf& real_list(std::string name, M T::*member, RealKey says) {
    return add(KeyKind::real_list, std::move(name), member, std::move(says));
  }
  /// TimeCurve: a number, or {times, values}.
  template <class M>
  SchemaOf& curve(std::string name, M T::*member, RealKey says) {
    return add(KeyKind::curve, std::move(name), member, std::move(says));
  }
  template <class M>
  SchemaOf& integer(std::string name, M T::*member, PlainKey says) {
    add(KeyKind::integer, std::move(name), member,
        RealKey{std::move(says.doc), "", says.range, says.optional});
    schema_.keys.back().storable = detail::storable_range<M>();
    return *this;
  }
  template <class M>
  SchemaOf& flag(std::string name, M T::*member, PlainKey says) {
    return add(KeyKind::flag, std::move(name), member,
               RealKey{std::move(says.doc), "", {}, says.optional});
  }
  template <class M>
  SchemaOf& text(std::string name, M T::*member, PlainKey says) {
    return add(KeyKind::text, std::move(name), member,
               RealKey{std::move(says.doc), "", {}, says.optional});
  }
  template <class M>
  SchemaOf& text_list(std::string name, M T::*member, PlainKey says) {
    return add(KeyKind::text_list, std::move(name), member,
               RealKey{std::move(says.doc), "", {}, says.optional});
  }

  /// A text_list of which an entry may also be a list of numbers, `[1, 0]` for "1 0".
  template <class M>
  SchemaOf& text_rows(std::string name, M T::*member, PlainKey says) {
    text_list(std::move(name), member, std::move(says));
    schema_.keys.back().has_rows = true;
    return *this;
  }

  /// NamedNumbers, on which expressions of the other keys may depend.
  SchemaOf& parameters(std::string name, NamedNumbers T::*member, PlainKey says) {
    return add(KeyKind::parameters, std::move(name), member,
               RealKey{std::move(says.doc), "", {}, says.optional});
  }

  /// An enum, and the words that the user writes for its values.
  template <class Enum>
  SchemaOf& choice(std::string name, Enum T::*member, ChoiceWords<std::type_identity_t<Enum>> words,
                   PlainKey says) {
    Key key;
    key.kind = KeyKind::choice;
    key.name = std::move(name);
    key.doc = std::move(says.doc);
    key.is_optional = says.optional;
    for (const auto& entry : words) key.choices.push_back(entry.first);
    key.assign = [member, words](void* object, const Value& value) {
      for (const auto& [text, meaning] : words) {
        if (text == std::get<std::string>(value)) static_cast<T*>(object)->*member = meaning;
      }
    };
    key.read = [member, words](const void* object) -> Value {
      for (const auto& [word, meaning] : words) {
        if (static_cast<const T*>(object)->*member == meaning) return word;
      }
      return {};
    };
    schema_.keys.push_back(std::move(key));
    return *this;
  }

  /// A nested struct S (or std::optional<S>, which an absent section leaves empty).
  template <class M>
  SchemaOf& section(std::string name, M T::*member, PlainKey says) {
    Key key;
    key.kind = KeyKind::section;
    key.name = std::move(name);
    key.doc = std::move(says.doc);
    key.is_optional = says.optional;
    key.absent_word = std::move(says.absent_word);
    key.number_key = std::move(says.number_key);
    key.list_key = std::move(says.list_key);
    key.open = [member](void* object, const std::string&, std::size_t) -> void* {
      M& nested = static_cast<T*>(object)->*member;
      if constexpr (detail::is_optional<M>::value) {
        return &nested.emplace();
      } else {
        return &nested;
      }
    };
    if constexpr (detail::is_optional<M>::value) {
      key.alternatives = {{"", []() -> const Schema& { return M::value_type::schema(); }}};
      key.visit = [member](const void* object, const Key::Visitor& see) {
        const M& nested = static_cast<const T*>(object)->*member;
        if (nested) see("", 0, &*nested);
      };
    } else {
      key.alternatives = {{"", []() -> const Schema& { return M::schema(); }}};
      key.visit = [member](const void* object, const Key::Visitor& see) {
        see("", 0, &(static_cast<const T*>(object)->*member));
      };
    }
    schema_.keys.push_back(std::move(key));
    return *this;
  }

  /// std::map<std::string, S> of one form.
  template <class S>
  SchemaOf& named_sections(std::string name, std::map<std::string, S> T::*member, PlainKey says) {
    Key key;
    key.kind = KeyKind::named_sections;
    key.name = std::move(name);
    key.doc = std::move(says.doc);
    key.is_optional = says.optional;
    key.alternatives = {{"", []() -> const Schema& { return S::schema(); }}};
    key.open = [member](void* object, const std::string& entry, std::size_t) -> void* {
      return &(static_cast<T*>(object)->*member)[entry];
    };
    key.visit = [member](const void* object, const Key::Visitor& see) {
      for (const auto& [entry, nested] : static_cast<const T*>(object)->*member)
        see(entry, 0, &nested);
    };
    schema_.keys.push_back(std::move(key));
    return *this;
  }

  /// std::map<std::string, std::variant<S...>>; the key `discriminator` of an entry says which S it
  /// is, `names` in the order of the variant.
  template <class... S>
  SchemaOf& named_variants(std::string name, std::map<std::string, std::variant<S...>> T::*member,
                           std::string discriminator, std::vector<std::string> names,
                           PlainKey says) {
    Key key;
    key.kind = KeyKind::named_sections;
    key.name = std::move(name);
    key.doc = std::move(says.doc);
    key.is_optional = says.optional;
    key.discriminator = std::move(discriminator);
    const std::vector<std::function<const Schema&()>> schemas{
        []() -> const Schema& { return S::schema(); }...};
    for (std::size_t i = 0; i < names.size(); ++i)
      key.alternatives.push_back({names[i], schemas[i]});
    key.open = [member](void* object, const std::string& entry, std::size_t alternative) -> void* {
      auto& slot = (static_cast<T*>(object)->*member)[entry];
      void* opened = nullptr;
      std::size_t index = 0;
      ((index++ == alternative ? void(opened = &slot.template emplace<S>()) : void()), ...);
      return opened;
    };
    key.visit = [member](const void* object, const Key::Visitor& see) {
      for (const auto& entry : static_cast<const T*>(object)->*member) {
        std::visit([&](const auto& nested) { see(entry.first, entry.second.index(), &nested); },
                   entry.second);
      }
    };
    schema_.keys.push_back(std::move(key));
    return *this;
  }

  /// std::map<std::string, H> whose entries are of one of the types that H::types() lists, each with
  /// name, schema and emplace(); the key `discriminator` of an entry says of which.
  template <class H>
  SchemaOf& named_types(std::string name, std::map<std::string, H> T::*member,
                        std::string discriminator, PlainKey says) {
    Key key;
    key.kind = KeyKind::named_sections;
    key.name = std::move(name);
    key.doc = std::move(says.doc);
    key.is_optional = says.optional;
    key.discriminator = std::move(discriminator);
    for (const auto& type : H::types())
      key.alternatives.push_back({type.name, [schema = type.schema]() -> const Schema& {
                                    return schema();
                                  }});
    key.open = [member](void* object, const std::string& entry, std::size_t alternative) -> void* {
      return H::types()[alternative].emplace((static_cast<T*>(object)->*member)[entry]);
    };
    key.visit = [member](const void* object, const Key::Visitor& see) {
      for (const auto& [entry, nested] : static_cast<const T*>(object)->*member)
        see(entry, nested.type_index(), nested.object());
    };
    schema_.keys.push_back(std::move(key));
    return *this;
  }

  /// std::vector<S>.
  template <class S>
  SchemaOf& section_list(std::string name, std::vector<S> T::*member, PlainKey says) {
    Key key;
    key.kind = KeyKind::section_list;
    key.name = std::move(name);
    key.doc = std::move(says.doc);
    key.is_optional = says.optional;
    key.alternatives = {{"", []() -> const Schema& { return S::schema(); }}};
    key.open = [member](void* object, const std::string&, std::size_t) -> void* {
      return &(static_cast<T*>(object)->*member).emplace_back();
    };
    key.visit = [member](const void* object, const Key::Visitor& see) {
      for (const S& nested : static_cast<const T*>(object)->*member) see("", 0, &nested);
    };
    schema_.keys.push_back(std::move(key));
    return *this;
  }

  /// Declares the keys of the nested struct as keys of this map (no level of their own).
  template <class S>
  SchemaOf& include(S T::*member) {
    const Schema& nested = S::schema();
    for (Key key : nested.keys) {
      if (key.assign) {
        key.assign = [member, inner = key.assign](void* object, const Value& value) {
          inner(&(static_cast<T*>(object)->*member), value);
        };
        key.read = [member, inner = key.read](const void* object) {
          return inner(&(static_cast<const T*>(object)->*member));
        };
      }
      if (key.open) {
        key.open = [member, inner = key.open](void* object, const std::string& entry,
                                              std::size_t alternative) {
          return inner(&(static_cast<T*>(object)->*member), entry, alternative);
        };
        key.visit = [member, inner = key.visit](const void* object, const Key::Visitor& see) {
          inner(&(static_cast<const T*>(object)->*member), see);
        };
      }
      schema_.keys.push_back(std::move(key));
    }
    for (const auto& check : nested.checks) {
      schema_.checks.push_back([member, check](const void* object, std::vector<Problem>& problems) {
        check(&(static_cast<const T*>(object)->*member), problems);
      });
    }
    return *this;
  }

  /// A condition between keys: void(const T&, std::vector<Problem>&).
  template <class F>
  SchemaOf& check(F condition) {
    schema_.checks.push_back([condition](const void* object, std::vector<Problem>& problems) {
      condition(*static_cast<const T*>(object), problems);
    });
    return *this;
  }

  operator Schema() const { return schema_; }

 private:
  template <class M>
  SchemaOf& add(KeyKind kind, std::string name, M T::*member, RealKey says) {
    Key key;
    key.kind = kind;
    key.name = std::move(name);
    key.doc = std::move(says.doc);
    key.unit = std::move(says.unit);
    key.range = says.range;
    key.is_optional = says.optional;
    key.assign = [member](void* object, const Value& value) {
      detail::from_value(static_cast<T*>(object)->*member, value);
    };
    key.read = [member](const void* object) {
      return detail::to_value(static_cast<const T*>(object)->*member);
    };
    schema_.keys.push_back(std::move(key));
    return *this;
  }

  Schema schema_;
};

}  // namespace stridor
