// A scene key as its readers know it: name, kind, unit, range, and how its value gets into a struct
// and out of it. Keys are declared with the builder of core/schema.hpp.
#pragma once

#include <cmath>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <limits>
#include <string>
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

/// Value of a key once read. `monostate` stands for "not given".
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

}  // namespace stridor
