#include "core/schema.hpp"

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

}  // namespace stridor
