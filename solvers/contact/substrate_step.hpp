// One step of a contact with a viscoelastic substrate.
#pragma once

#include "coupling/laws/substrate_contact.hpp"
#include "solvers/contact/contact_solver.hpp"

namespace stridor {

/// Response of the slip velocity at the end of the step to the forces of a contact:
/// w_{n+1} = free + by_tangential f_t + by_normal f_n.
struct SlipAnswer {
  double free = 0.0;
  double by_tangential = 0.0;  ///< > 0
  double by_normal = 0.0;
};

struct SubstrateStep {
  double normal = 0.0;      ///< f_n, pushes the body out
  double tangential = 0.0;  ///< f_t, along the direction of the slip where that is positive
  double stiffness = 0.0;   ///< ∂f_n/∂y
  ContactState state = ContactState::open;
  double direction = -1.0;  ///< of the slip, ±1
};

/// Force of a contact at t_n and the slip that it makes, together (docs/theory.md, 9.4).
///
/// Sticking, w_{n+1} = 0, where the friction for that is below the static strength; else slip to
/// the side to which it is too large, with the law at the mean of w_n and w_{n+1}, by Newton's
/// method in a bracket.
/// @param indentation y_n
/// @param last_slip   w_n
/// @param speed       by which small changes of w are measured, >= 0
SubstrateStep solve_substrate_step(const SubstrateContact& contact, double indentation,
                                   double last_slip, const SlipAnswer& slip, double speed);

/// Whether the substrate is too stiff for the step, k W > 4: every small change of the indentation
/// is followed by a larger one to the other side, whatever the bodies are (docs/theory.md, 9.4).
/// @param stiffness  k = ∂f_n/∂y
/// @param compliance W, displacement of the body in the step per unit of f_n
inline bool overshoots(double stiffness, double compliance) {
  return stiffness * compliance > 4.0;
}

}  // namespace stridor
