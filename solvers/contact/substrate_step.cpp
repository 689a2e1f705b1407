#include "solvers/contact/substrate_step.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace stridor {

SubstrateStep solve_substrate_step(const SubstrateContact& contact, double indentation,
                                   double last_slip, const SlipAnswer& slip, double speed) {
  SubstrateStep step;
  if (!(indentation > 0.0)) return step;
  const SubstrateForces::Force at_rest = contact.at(indentation, 0.0, 1.0).normal;
  const double sticking_normal = at_rest.value;
  const double required = -(slip.free + slip.by_normal * sticking_normal) / slip.by_tangential;
  const double strength = contact.static_strength(indentation).value;
  if (std::abs(required) <= strength) {
    step.state = ContactState::stick;
    step.normal = sticking_normal;
    step.stiffness = at_rest.by_indentation;
    step.tangential = required;
    return step;
  }
  // Friction of magnitude above zero leaves less slip than none at all does.
  const double direction = required > 0.0 ? -1.0 : 1.0;
  step.state = ContactState::slip;
  step.direction = direction;
  double low = 0.0;
  double high = std::numeric_limits<double>::infinity();
  double w = std::abs(slip.free - direction * slip.by_tangential * strength +
                      slip.by_normal * sticking_normal);
  for (int i = 0; i < 100; ++i) {
    const double mean = std::max(0.0, 0.5 * (w + direction * last_slip));
    const double by_w = mean > 0.0 ? 0.5 : 0.0;
    const SubstrateForces forces = contact.at(indentation, direction * mean, direction);
    step.normal = forces.normal.value;
    step.stiffness = forces.normal.by_indentation;
    step.tangential = forces.tangential.value;
    const double miss = w - direction * (slip.free + slip.by_tangential * step.tangential +
                                         slip.by_normal * step.normal);
    const double slope = 1.0 - by_w * (slip.by_tangential * forces.tangential.by_slip +
                                       slip.by_normal * forces.normal.by_slip);
    (miss > 0.0 ? high : low) = w;
    double next = w - miss / slope;
    if (!(next > low && next < high)) next = std::isinf(high) ? 2.0 * w : 0.5 * (low + high);
    if (std::abs(next - w) <= 1e-14 * (w + speed) || next == w) break;
    w = next;
  }
  return step;
}

}  // namespace stridor
