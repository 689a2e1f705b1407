#include "core/key.hpp"

#include <fmt/format.h>

namespace stridor {

std::string Range::text() const {
  const bool has_low = std::isfinite(low);
  const bool has_high = std::isfinite(high);
  if (has_low && has_high) {
    return fmt::format("in {}{}, {}{}", excludes_low ? '(' : '[', low, high,
                       excludes_high ? ')' : ']');
  }
  if (has_low) return fmt::format("{} {}", excludes_low ? ">" : ">=", low);
  if (has_high) return fmt::format("{} {}", excludes_high ? "<" : "<=", high);
  return "a finite number";
}

const Key* Schema::find(const std::string& key) const {
  for (const Key& candidate : keys) {
    if (candidate.name == key) return &candidate;
  }
  return nullptr;
}

namespace {

const Key* key_in_place(const Key& section, const std::string& name) {
  return name.empty() ? nullptr : section.alternatives.front().schema().find(name);
}

}  // namespace

const Key* number_in_place_of(const Key& section) {
  return key_in_place(section, section.number_key);
}

const Key* list_in_place_of(const Key& section) {
  return key_in_place(section, section.list_key);
}

}  // namespace stridor
