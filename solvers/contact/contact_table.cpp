#include "solvers/contact/contact_table.hpp"

#include <algorithm>

namespace stridor {

bool ComputedContactTable::converged() const {
  return std::all_of(results.begin(), results.end(),
                     [](const SlidingContactResult& result) { return result.converged; });
}

ComputedContactTable compute_contact_table(const IndenterProfile& profile,
                                           const CreepLengths& creep,
                                           const std::vector<double>& speeds,
                                           const std::vector<double>& indentations,
                                           const SlidingContactParameters& parameters,
                                           const std::function<void(std::size_t)>& advanced) {
  const double radius = profile.radius();
  SlidingContact contact(parameters, profile);
  ComputedContactTable computed;
  computed.table.speeds = speeds;
  computed.table.indentations = indentations;
  for (const double indentation : indentations) {
    for (const double speed : speeds) {
      CreepLengths here = creep;
      for (SlidingCreep& one : here) one.length *= speed;
      const SlidingContactResult result = contact.indent(indentation * radius, here);
      computed.table.force.push_back(result.force / (radius * radius));
      computed.table.area.push_back(result.area / (radius * radius));
      computed.table.friction.push_back(result.friction);
      computed.results.push_back(result);
      if (advanced) advanced(computed.results.size());
    }
  }
  return computed;
}

}  // namespace stridor
