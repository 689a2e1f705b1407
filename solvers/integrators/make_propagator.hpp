// The propagator that a scene's time section asks for.
#pragma once

#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "coupling/system/system.hpp"
#include "solvers/integrators/propagator.hpp"
#include "solvers/integrators/time_parameters.hpp"

namespace stridor {

/// What drives do to a body over time, as amplitudes of its load patterns: one of every BodyLoad in
/// their order, N or m, the acceleration of the drive that it follows, m/s², and 1 for the load that it
/// holds. None of a body without any of them.
class BodyLoading {
 public:
  explicit BodyLoading(const SystemBody& body);

  bool is_any() const { return !amplitudes_.empty(); }
  std::size_t num_loads() const { return loads_.size(); }
  /// At a time; valid until the next call. No allocation.
  std::span<const double> amplitudes(const std::vector<Drive>& drives, double time);

 private:
  std::vector<BodyLoad> loads_;
  int drive_ = -1;
  std::vector<double> amplitudes_;
};

/// A body of the system, at rest at t = 0, ready to be marched.
///
/// Load patterns of a body: the rows of its loads, −base_inertia where it follows a drive, and the load
/// that it holds, with the amplitudes of BodyLoading.
///
/// @param added   added_feedthrough()
/// @param num_ports ports for contacts, two per point
/// @param loads     amplitudes of the patterns at t = 0
std::unique_ptr<Propagator> make_propagator(const SystemBody& body, const TimeParameters& time,
                                            std::optional<double> added, int num_ports,
                                            std::span<const double> loads);

/// Whether no body of the system starts with a displacement or a velocity.
bool starts_at_rest(const System& system);

/// Propagator::predict_start() with the initial motion of the body.
void predict_start(Propagator& propagator, const SystemBody& body, const TimeParameters& time);

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
