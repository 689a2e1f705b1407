// The propagator that a scene's time section asks for.
#pragma once

#include <array>
#include <memory>
#include <optional>
#include <span>
#include <string>

#include "coupling/system.hpp"
#include "solvers/propagator.hpp"
#include "solvers/time_parameters.hpp"

namespace stridor {

/// Amplitudes of the load patterns of a body: the drive's load, N, its acceleration, m/s², and 1 for the
/// load that the body holds.
using LoadAmplitudes = std::array<double, 3>;
inline LoadAmplitudes load_amplitudes(const Drive& drive, double time) {
  return {drive.load.value(time), drive.acceleration(time), 1.0};
}
/// Whether a body has load patterns.
inline bool is_loaded(const SystemBody& body) {
  return body.feels_drive() || body.held_load.size() > 0;
}

/// A body of the system, at rest at t = 0, ready to be marched.
///
/// Load patterns of a body: the drive's load on its guided support (N), the acceleration of the drive
/// (m/s²), which acts as −base_inertia where the body follows it, and the load that it holds.
/// Bodies without any of them have none.
///
/// @param surplus   prompt_surplus()
/// @param num_slots ports for contacts, two per point
/// @param loads     amplitudes of the patterns at t = 0
std::unique_ptr<Propagator> make_propagator(const SystemBody& body, const TimeParameters& time,
                                            std::optional<double> surplus, int num_slots,
                                            std::span<const double> loads);

/// Whether no body of the system starts with a displacement or a velocity.
bool starts_at_rest(const System& system);

/// Propagator::foresee_start() with the initial motion of the body.
void foresee_start(Propagator& propagator, const SystemBody& body, const TimeParameters& time);

/// Sets the initial displacements and velocities of the body. To be called when its ports watch the
/// rows that they start with, whose increments follow from the velocities.
/// @param forces that will act on the ports at t = 0, as far as they are known
void start_motion(Propagator& propagator, const SystemBody& body, const TimeParameters& time,
                  const double* forces);

/// Largest stable step over all bodies of the central difference, s, and the body that sets it.
struct StepLimit {
  double step;
  std::string body;
};
StepLimit step_limit(const System& system);

/// The same of a run: of the modes that it keeps, and nine tenths of it where it truncates others,
/// whose instantaneous response leaves no room beside the fastest damped ones (docs/theory.md,
/// 3.6); infinite for exact propagation.
/// @param system with all modes
StepLimit step_limit(const System& system, const TimeParameters& time);

}  // namespace stridor
