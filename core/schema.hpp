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

#include <cmath>
#include <cstdint>
#include <functional>
#include <limits>
#include <map>
#include <optional>
#include <string>
#include <type_traits>
#include <utility>
#include <variant>
#include <vector>

#include "core/errors.hpp"
#include "core/time_curve.hpp"

namespace stridor {

/// A number that a scene has given a name, for its expressions.
struct NamedNumber {
  std::string name;
  double value = 0.0;    ///< in `unit`
  std::string unit;      ///< SI; empty where it was written without one, or as an expression
  bool is_used = false;  ///< some key depends on it, directly or through other parameters
  bool operator==(const NamedNumber&) const = default;
};
using NamedNumbers = std::vector<NamedNumber>;

/// What a key can hold once read. `monostate` stands for "not given".
using Value = std::variant<std::monostate, bool, std::int64_t, double, std::string,
                           std::vector<double>, std::vector<std::string>, TimeTable, NamedNumbers>;

/// An interval of allowed numbers.
struct Range {
  double low = -std::numeric_limits<double>::infinity();
  double high = std::numeric_limits<double>::infinity();
  bool excludes_low = false;
  bool excludes_high = false;

  static constexpr Range any() { return {}; }
  static constexpr Range positive() {
    return {0.0, std::numeric_limits<double>::infinity(), true, false};
  }
  static constexpr Range non_negative() {
    return {0.0, std::numeric_limits<double>::infinity(), false, false};
  }
  static constexpr Range between(double low, double high) { return {low, high, false, false}; }
  static constexpr Range inside(double low, double high) { return {low, high, true, true}; }

  /// False for NaN and infinities, whatever the bounds.
  bool contains(double value) const {
    return std::isfinite(value) && (excludes_low ? value > low : value >= low) &&
           (excludes_high ? value < high : value <= high);
  }
  /// "> 0", ">= 0", "in (-1, 0.5)", "a finite number".
  std::string text() const;
};

enum class KeyKind {
  flag,            ///< true | false
  integer,         ///< std::int64_t
  real,            ///< double, in `unit`
  text,            ///< string
  choice,          ///< one of `choices`
  real_list,       ///< list of double, in `unit`
  text_list,       ///< list of strings; a single string is a list of one
  curve,           ///< a real, or {times: [...], values: [...]} with values in `unit`
  section,         ///< a map with the keys of `alternatives[0]`
  named_sections,  ///< a map name -> map; `alternatives` distinguished by `discriminator`
  section_list,    ///< a list of maps with the keys of `alternatives[0]`
  parameters,      ///< a map name -> number, for the expressions of the other keys
};

class Schema;

/// One form that the entries of a `section`, `named_sections` or `section_list` may take.
struct Alternative {
  std::string name;  ///< value of the discriminator; empty where there is one form only
  std::function<const Schema&()>
      schema;  ///< called late, so that sections may be declared anywhere
};

/// One declared key of one map.
struct Key {
  std::string name;
  KeyKind kind = KeyKind::text;
  std::string doc;   ///< one line
  std::string unit;  ///< SI unit as udunits reads it; empty: dimensionless
  Range range;       ///< of numbers and of every entry of lists and tables
  Range storable;    ///< of an integer: what its member can hold
  bool is_optional = false;
  std::string absent_word;           ///< of an optional section: may stand for "not given"
  /// Of a section: which of its keys a single number, or a list, in its place is the value of.
  std::string number_key, list_key;
  std::vector<std::string> choices;  ///< of a choice
  bool has_rows = false;             ///< of a text_list: a list of numbers stands for their text
  std::string discriminator;         ///< of named_sections with several alternatives, e.g. "type"
  std::vector<Alternative> alternatives;

  /// Scalars and lists: write the value into / read it from the struct (void* is that struct).
  std::function<void(void*, const Value&)> assign;
  std::function<Value(const void*)> read;

  /// Sections: makes the entry (by name; by alternative where there are several) and returns the
  /// struct that its keys fill. A `section` that is optional and not given is never opened.
  std::function<void*(void*, const std::string& name, std::size_t alternative)> open;
  /// Calls back with (name, alternative, struct) for every entry present.
  using Visitor = std::function<void(const std::string&, std::size_t, const void*)>;
  std::function<void(const void*, const Visitor&)> visit;
};

/// The declared keys of one map, and what must hold between them.
class Schema {
 public:
  std::string name;
  std::vector<Key> keys;
  /// Checks that involve several keys; adds to the list, with key paths relative to this map.
  std::vector<std::function<void(const void*, std::vector<Problem>&)>> checks;
  /// A default-constructed struct, from which the defaults of optional keys are read.
  std::function<Value(const Key&)> default_of;

  const Key* find(const std::string& key) const;
};

/// The key of a section that a number in its place is the value of; null where it takes none.
const Key* number_in_place_of(const Key& section);
/// The same of a list.
const Key* list_in_place_of(const Key& section);

/// What is said of a number (or of a list of numbers, or a curve) besides its name and member.
struct RealKey {
  std::string doc;
  std::string unit = "";
  Range range = Range::any();
  bool optional = false;
};
/// What is said of any other key besides its name and member.
struct PlainKey {
  std::string doc;
  bool optional = false;
  Range range = Range::any();
  std::string absent_word = "";  ///< of an optional section: may stand for "not given"
  /// Of a section: its key that a number (a list) in its place stands for.
  std::string number_key = "";
  std::string list_key = "";
};

namespace detail {

template <class M>
struct is_optional : std::false_type {};
template <class M>
struct is_optional<std::optional<M>> : std::true_type {};

/// The numbers that an integer member can hold.
template <class M>
Range storable_range() {
  if constexpr (is_optional<M>::value) {
    return storable_range<typename M::value_type>();
  } else {
    return Range::between(static_cast<double>(std::numeric_limits<M>::lowest()),
                          static_cast<double>(std::numeric_limits<M>::max()));
  }
}

template <class M>
Value to_value(const M& member) {
  if constexpr (is_optional<M>::value) {
    return member ? to_value(*member) : Value{};
  } else if constexpr (std::is_same_v<M, bool>) {
    return member;
  } else if constexpr (std::is_integral_v<M>) {
    return static_cast<std::int64_t>(member);
  } else if constexpr (std::is_same_v<M, TimeCurve>) {
    if (member.is_constant()) return member.value(0.0);
    return member.table();
  } else {
    return member;
  }
}

template <class M>
void from_value(M& member, const Value& value) {
  if constexpr (is_optional<M>::value) {
    member.emplace();
    from_value(*member, value);
  } else if constexpr (std::is_same_v<M, bool>) {
    member = std::get<bool>(value);
  } else if constexpr (std::is_integral_v<M>) {
    member = static_cast<M>(std::get<std::int64_t>(value));
  } else if constexpr (std::is_same_v<M, TimeCurve>) {
    if (const double* constant = std::get_if<double>(&value)) {
      member = TimeCurve(*constant);
    } else {
      member = TimeCurve(std::get<TimeTable>(value));
    }
  } else {
    member = std::get<M>(value);
  }
}

}  // namespace detail

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

  /// An enum; `names` pairs what the user writes with what it means.
  template <class Enum>
  SchemaOf& choice(std::string name, Enum T::*member,
                   std::vector<std::pair<std::string, Enum>> names, PlainKey says) {
    Key key;
    key.kind = KeyKind::choice;
    key.name = std::move(name);
    key.doc = std::move(says.doc);
    key.is_optional = says.optional;
    for (const auto& entry : names) key.choices.push_back(entry.first);
    key.assign = [member, names](void* object, const Value& value) {
      for (const auto& [text, meaning] : names) {
        if (text == std::get<std::string>(value)) static_cast<T*>(object)->*member = meaning;
      }
    };
    key.read = [member, names](const void* object) -> Value {
      for (const auto& [text, meaning] : names) {
        if (static_cast<const T*>(object)->*member == meaning) return text;
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
