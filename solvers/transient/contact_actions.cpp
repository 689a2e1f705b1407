#include "solvers/transient/contact_actions.hpp"

namespace stridor {

ContactAction action_of(const RunningLine& contact) {
  ContactAction action;
  action.segment = contact.sliding.segment();
  action.projection = contact.sliding.projection();
  action.force = contact.force;
  action.friction_force = contact.friction_force;
  action.state = contact.state;
  action.roughness = contact.sliding.roughness();
  return action;
}

ContactAction action_of(const RunningFace& face, const StepClock& clock) {
  ContactAction action;
  action.force = face.force;
  action.friction_force = face.friction_force;
  action.state = face.state;
  action.friction_across = face.friction_across;
  action.sliding = face.velocities[0];
  const FacePoint& kinematics = *face.kinematics;
  action.num_master_rows = kinematics.num_master_ports();
  action.master_rows = kinematics.master_rows();
  action.normal = kinematics.normal();
  action.along = kinematics.along();
  action.across = kinematics.across();
  const double began = clock.time(clock.index - 1);
  action.drawn = kinematics.drawn(began, clock.step);
  action.lifted = kinematics.lifted(began, clock.step);
  return action;
}

}  // namespace stridor
