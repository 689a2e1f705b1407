// Systems that are one mass on a sliding viscoelastic half-space, as the oscillator that has closed
// forms and an integrator of its own.
#pragma once

#include <Eigen/Core>
#include <optional>
#include <string>

#include "coupling/system/system.hpp"
#include "solvers/transient/substrate_oscillator.hpp"

namespace stridor {

/// One mass on springs and dampers that a half-space slides under, SI:
///
///   m ü + C u̇ + K u = p + f(u, u̇)
///
/// with u the displacement of the point in contact, x along +x and y out of the half-space.
struct SlidingMass {
  int body = 0;                                              ///< index into System::bodies
  double mass = 0.0;                                         ///< m, kg, > 0
  Eigen::Matrix2d damping = Eigen::Matrix2d::Zero();         ///< C, N s/m
  Eigen::Matrix2d stiffness = Eigen::Matrix2d::Zero();       ///< K, N/m
  Eigen::Vector2d load_direction = Eigen::Vector2d::Zero();  ///< p per unit of `load`
  double load = 0.0;  ///< of a single BodyLoad, N or m; 1 where the direction is the sum of several
  double base_speed = 0.0;   ///< of the frame in which u is counted, along +x, m/s
  double speed = 0.0;        ///< of the half-space in that frame, along +x, m/s, not 0
  SubstrateContact contact;  ///< SI
  Eigen::Matrix2d to_contact = Eigen::Matrix2d::Identity();  ///< u of the body's coordinates
  Eigen::Matrix2d to_body = Eigen::Matrix2d::Identity();     ///< its inverse
};

/// The same in its own units, m, T = (m/k_xx)^½ and the length p/k_xx, with y into the half-space
/// and x along its motion (docs/theory.md, 9.1): its numbers are of the order of one.
struct SlidingOscillator {
  SubstrateOscillator oscillator;
  double length = 1.0;     ///< m
  double time = 1.0;       ///< s
  double force = 1.0;      ///< N
  double direction = 1.0;  ///< of the x of the oscillator along +x, ±1
  SlidingMass mass;

  double velocity_unit() const { return length / time; }
  double acceleration_unit() const { return length / (time * time); }
  /// Displacement of the point in contact, m, from one of the oscillator; likewise velocities and
  /// accelerations with other units.
  Eigen::Vector2d to_si(const Eigen::Vector2d& u, double unit) const {
    return {direction * unit * u.x(), -unit * u.y()};
  }
  /// The other way.
  Eigen::Vector2d from_si(const Eigen::Vector2d& u, double unit) const {
    return {direction * u.x() / unit, -u.y() / unit};
  }
  /// Motion of the body at the start, in units of the oscillator.
  Eigen::Vector2d initial_displacement(const System& system) const;
  Eigen::Vector2d initial_velocity(const System& system) const;
};

/// The mass that a system is, found by its properties: one body with two unknowns, which are the
/// displacements of the only slave point and have one mass; its master a half-space with a force
/// law; no circulatory terms, a spring along x, and damping, load and speeds that are constant from
/// the start.
/// @param why receives what the system has instead, as the end of a sentence; may be null
std::optional<SlidingMass> as_sliding_mass(const System& system, std::string* why = nullptr);

/// A mass in its own units. @return the oscillator; without load its length unit is that of the law
SlidingOscillator scaled(SlidingMass mass);

/// Both.
std::optional<SlidingOscillator> as_oscillator(const System& system, std::string* why = nullptr);

}  // namespace stridor
