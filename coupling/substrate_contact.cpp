#include "coupling/substrate_contact.hpp"

#include <algorithm>

namespace stridor {

SubstrateForces SubstrateContact::at(double indentation, double slip, double direction) const {
  SubstrateForces forces;
  const ViscoelasticContact contact = law->at(indentation / indentation_unit, slip / speed_unit);
  forces.range = contact.range;
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
  if (!sign.is_set_valued()) {
    const RegularisedSign::Value s = sign.at(std::max(0.0, direction * slip));
    value_by_y *= s.value;
    value_by_v = s.value * value_by_v + s.slope * direction * value;
    value *= s.value;
  }
  forces.tangential = {-direction * value, -direction * value_by_y, -direction * value_by_v};
  return forces;
}

SubstrateForces::Force SubstrateContact::static_strength(double indentation) const {
  if (!sign.is_set_valued()) return {};
  const LawValue area = law->at(indentation / indentation_unit, 0.0).area;
  return {shear * area.value, shear * area.by_indentation / indentation_unit, 0.0};
}

}  // namespace stridor
