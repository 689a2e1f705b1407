#include "coupling/laws/substrate_contact.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace stridor {

SubstrateForces SubstrateContact::at(double indentation, double slip, double direction) const {
  SubstrateForces forces;
  const ViscoelasticContact contact = law->at(indentation / indentation_unit, slip / speed_unit);
  forces.range = contact.range;
  forces.indentation = indentation;
  if (contact.range == LawRange::no_contact) return forces;
  const double by_y = 1.0 / indentation_unit;
  const double by_v = direction / speed_unit;  // of |v̂|

  const LawValue& force = contact.force;
  forces.normal = {force_unit * force.value, force_unit * force.by_indentation * by_y,
                   force_unit * force.by_speed * by_v};
  const LawValue& friction = contact.friction;
  const LawValue& area = contact.area;
  double value = shear * area.value;
  double value_by_y = shear * area.by_indentation * by_y;
  double value_by_v = shear * area.by_speed * by_v;
  const bool is_applied = friction_load == FrictionLoad::applied;
  const double pressing = is_applied ? load : forces.normal.value;
  value += pressing * friction.value;
  value_by_y += pressing * friction.by_indentation * by_y;
  value_by_v += pressing * friction.by_speed * by_v;
  if (!is_applied) {
    value_by_y += forces.normal.by_indentation * friction.value;
    value_by_v += forces.normal.by_slip * friction.value;
  }
  if (!interface_friction.is_frictionless()) {
    const double coefficient = sliding_friction(interface_friction, slip);
    value += coefficient * forces.normal.value;
    value_by_y += coefficient * forces.normal.by_indentation;
    value_by_v +=
        coefficient * forces.normal.by_slip +
        direction * sliding_friction_slope(interface_friction, slip) * forces.normal.value;
  }
  if (!sign.is_set_valued()) {
    const RegularisedSign::Value s = sign.at(std::max(0.0, direction * slip));
    value_by_y *= s.value;
    value_by_v = s.value * value_by_v + s.slope * direction * value;
    value *= s.value;
  }
  forces.tangential = {-direction * value, -direction * value_by_y, -direction * value_by_v};
  return forces;
}

SubstrateForces SubstrateContact::under(double normal, double slip, double direction) const {
  double low = 0.0;
  double high = std::numeric_limits<double>::infinity();
  // F̃ lies between 4/3 ŷ^{3/2} and some ten times that.
  double y = indentation_unit * std::cbrt(std::pow(0.3 * normal / force_unit, 2.0));
  for (int i = 0; i < 200; ++i) {
    const SubstrateForces forces = at(y, slip, direction);
    const double value = forces.normal.value;
    if (value == normal) return forces;
    (value < normal ? low : high) = y;
    double next = y + 1.5 * value / forces.normal.by_indentation *
                          (std::pow(normal / value, 2.0 / 3.0) - 1.0);
    if (!(next > low && next < high)) next = std::isinf(high) ? 8.0 * y : 0.5 * (low + high);
    if (std::abs(next - y) <= 4e-16 * y || !(next > low && next < high)) return forces;
    y = next;
  }
  return at(y, slip, direction);
}

SubstrateForces::Force SubstrateContact::static_strength(double indentation) const {
  if (!sign.is_set_valued()) return {};
  const ViscoelasticContact contact = law->at(indentation / indentation_unit, 0.0);
  const double held = interface_friction.static_coefficient * force_unit;
  return {shear * contact.area.value + held * contact.force.value,
          (shear * contact.area.by_indentation + held * contact.force.by_indentation) /
              indentation_unit,
          0.0};
}

}  // namespace stridor
