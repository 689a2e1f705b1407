// The propagator that a scene's time section asks for.
#pragma once

#include <memory>
#include <optional>
#include <span>
#include <string>

#include "coupling/system.hpp"
#include "solvers/propagator.hpp"
#include "solvers/time_parameters.hpp"

namespace stridor {

/// Circular frequency up to which modes move, rad/s; infinite where all do. The lower of that of
/// `time.retain` and, with exact propagation, of what the step resolves, ω h = 2.
double retained_frequency(const TimeParameters& time);
/// The system with those modes in its bodies; the others are their residual.
System retained(const System& system, const TimeParameters& time);
/// How many modes that leaves moving.
Eigen::Index num_retained(const ModalBody& body, const TimeParameters& time);

/// A body of the system, at rest at t = 0, ready to be marched.
///
/// Load patterns of a body that follows the drive: the drive's load on its guided support (N), and
/// the acceleration of the drive (m/s²), which acts as −base_inertia. Other bodies have none.
///
/// @param surplus   prompt_surplus()
/// @param num_slots slots for contacts, two per point
/// @param loads     amplitudes of the patterns at t = 0
std::unique_ptr<Propagator> make_propagator(const SystemBody& body, const TimeParameters& time,
                                            std::optional<double> surplus, int num_slots,
                                            std::span<const double> loads);

/// How much more than the scheme says the bodies answer at once: the least δ with which the
/// contacts of a system are stable (docs/theory.md, 3.5), 4 P − W positive definite, with a margin,
/// at every node of the master that the slave passes until time.end, where P is the flexibility
/// with which the bodies answer at once and W that of the next step.
/// @param system with the modes that time.retain keeps
/// @return nothing where bodies do not answer at once: the central difference with all modes
std::optional<double> prompt_surplus(const System& system, const TimeParameters& time);

/// Whether no body of the system starts with a displacement or a velocity.
bool starts_at_rest(const System& system);

/// Propagator::foresee_start() with what the body starts with.
void foresee_start(Propagator& propagator, const SystemBody& body, const TimeParameters& time);

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
