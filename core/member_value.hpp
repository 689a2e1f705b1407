// How the members of parameter structs hold the values of keys: as they are, as optionals, as
// integers of any size, as curves over time.
#pragma once

#include <cstdint>
#include <limits>
#include <optional>
#include <type_traits>
#include <variant>

#include "core/key.hpp"
#include "core/time_curve.hpp"

namespace stridor {

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

}  // namespace stridor
