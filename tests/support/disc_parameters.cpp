#include "tests/support/disc_parameters.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <stdexcept>

namespace stridor {

const std::vector<std::string>& disc_term_names() {
  static const std::vector<std::string> names{"gyroscopic", "friction", "friction_damping",
                                              "geometric", "structural_damping"};
  return names;
}

DiscTerms disc_terms(const std::vector<std::string>& names) {
  DiscTerms terms;
  const std::vector<bool*> switches{&terms.gyroscopic, &terms.friction, &terms.friction_damping,
                                    &terms.geometric, &terms.structural_damping};
  for (const std::string& name : names) {
    const auto& known = disc_term_names();
    const auto found = std::find(known.begin(), known.end(), name);
    if (found == known.end())
      throw std::invalid_argument(fmt::format("disc: there is no term '{}'", name));
    *switches[static_cast<std::size_t>(found - known.begin())] = true;
  }
  return terms;
}

std::vector<double> contact_offsets(const DiscModelParameters& parameters) {
  if (!parameters.contact.offsets.empty()) return parameters.contact.offsets;
  if (parameters.pads.elastic) return face_nodes(*parameters.pads.elastic);
  return {0.0};
}

}  // namespace stridor
