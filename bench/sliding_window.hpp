// A stretch of a run of one sliding contact as a problem of its own, for any integrator.
#pragma once

#include <cstdint>

#include "analysis/precision_study.hpp"
#include "coupling/system/system.hpp"
#include "models/model.hpp"

namespace stridor::bench {

/// A system in motion at t = 0, all that is prescribed constant.
struct SlidingWindow {
  System system;
  ObservedRow observed;
  double interval = 0.0;  ///< between samples, s
  std::int64_t num_samples = 0;
};

/// Result of marching a window, and its processor time in s.
struct WindowRun {
  SampledRun samples;
  std::int64_t steps = 0;
  double setup = 0.0;     ///< before the first step
  double stepping = 0.0;  ///< of all steps, at the pace of the fastest stretch
};

/// Whether a run is looked at; the cheap ones are timed without.
enum class Sampling { none, every_interval };

/// Marches a scene with one contact under Subs-b to `from` by exact propagation of all modes and
/// takes its state there.
///
/// Displacements are those of the step, velocities central differences of them, freed by an impulse
/// along the force direction of the rate at which the gap would open or close, so that the state
/// belongs to the constraint and integrators differ in the motion from there on only.
///
/// @param from     s, after everything prescribed has become constant
/// @param to       s, > from
/// @param interval between samples, s
/// @throws std::runtime_error if the scene is of another kind or its run fails
SlidingWindow make_sliding_window(const Model& model, ObservedRow observed, double from, double to,
                                  double interval);

/// Geometry of a contact between its slave and one segment of its master.
struct SlidingFrame {
  Eigen::Vector2d tangent, normal;
  double xi;   ///< 0 at the first node, 1 at the second
  double gap;  ///< m
};

/// @param segment of the surface
/// @param slave, first, second displacements of the slave and of both nodes, m, that of the drive
///                             included
SlidingFrame sliding_frame(const ContactPoint& contact, const MasterSurface& surface, int segment,
                           const Eigen::Vector2d& slave, const Eigen::Vector2d& first,
                           const Eigen::Vector2d& second);

/// Where a motion in modal coordinates starts.
struct ModalStart {
  Eigen::VectorXd position;  ///< kg^½ m
  Eigen::VectorXd velocity;  ///< kg^½ m/s
};
ModalStart modal_start(const SystemBody& body);

}  // namespace stridor::bench
