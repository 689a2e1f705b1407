// The propagator that a scene's time section asks for.
#pragma once

#include <memory>
#include <span>
#include <string>

#include "coupling/system.hpp"
#include "solvers/propagator.hpp"
#include "solvers/time_parameters.hpp"

namespace stridor {

/// The system with the modes that `time.retain` keeps in its bodies; the others are their residual.
System retained(const System& system, const TimeParameters& time);
/// How many modes that leaves moving.
Eigen::Index num_retained(const ModalBody& body, const TimeParameters& time);

/// A body of the system, at rest at t = 0, ready to be marched.
///
/// Load patterns of a body that follows the drive: the drive's load on its guided support (N), and
/// the acceleration of the drive (m/s²), which acts as −base_inertia. Other bodies have none.
///
/// @param num_slots slots for contacts, two per point
/// @param loads     amplitudes of the patterns at t = 0
std::unique_ptr<Propagator> make_propagator(const SystemBody& body, const TimeParameters& time,
                                            int num_slots, std::span<const double> loads);

/// Gives it the displacements and velocities that the body starts with. To be called when its slots
/// watch the rows that they start with, whose increments follow from the velocities.
/// @param forces that will act on the slots at t = 0, as far as they are known
void start_motion(Propagator& propagator, const SystemBody& body, const TimeParameters& time,
                  const double* forces);

/// Largest stable step over all bodies of the central difference, s, and the body that sets it.
struct StepLimit {
  double step;
  std::string body;
};
StepLimit step_limit(const System& system);

}  // namespace stridor
