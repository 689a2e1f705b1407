#include "core/state.hpp"

#include <algorithm>
#include <stdexcept>

namespace stridor {

void State::put(const std::string& name, std::span<const double> values) {
  arrays_[name].assign(values.begin(), values.end());
}

const std::vector<double>& State::array(const std::string& name) const {
  const auto found = arrays_.find(name);
  if (found == arrays_.end()) throw std::invalid_argument("state: no array '" + name + "'");
  return found->second;
}

void State::get(const std::string& name, std::span<double> values) const {
  const std::vector<double>& stored = array(name);
  if (stored.size() != values.size()) {
    throw std::invalid_argument("state: array '" + name + "' has " + std::to_string(stored.size()) +
                                " entries, expected " + std::to_string(values.size()));
  }
  std::copy(stored.begin(), stored.end(), values.begin());
}

double State::get(const std::string& name) const {
  double value = 0.0;
  get(name, std::span<double>(&value, 1));
  return value;
}

}  // namespace stridor
