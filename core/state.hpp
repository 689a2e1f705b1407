// The complete state of a computation as named arrays, so that it can be stored and taken up again.
#pragma once

#include <cstdint>
#include <map>
#include <span>
#include <string>
#include <vector>

namespace stridor {

/// Named arrays of doubles. Integers are stored exactly as doubles (|i| <= 2⁵³).
///
/// A value is retrieved under the name and with the length with which it was stored; parts of a
/// state use names with a prefix of their own ("bodies/oblique/increment").
class State {
 public:
  void put(const std::string& name, std::span<const double> values);
  void put(const std::string& name, double value) { put(name, std::span<const double>(&value, 1)); }

  /// @throws std::invalid_argument if there is no such array or its length differs; `values` is
  ///         untouched then.
  void get(const std::string& name, std::span<double> values) const;
  double get(const std::string& name) const;
  /// Array of any length. @throws std::invalid_argument if there is none.
  const std::vector<double>& array(const std::string& name) const;

  const std::map<std::string, std::vector<double>>& arrays() const { return arrays_; }
  bool operator==(const State&) const = default;

 private:
  std::map<std::string, std::vector<double>> arrays_;
};

}  // namespace stridor
