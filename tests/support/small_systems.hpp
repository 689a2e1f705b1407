// Systems of a few numbers on rigid ground, made without a mesh: everything in closed form.
#pragma once

#include <Eigen/Dense>
#include <cmath>
#include <numbers>
#include <string>
#include <utility>

#include "coupling/system/system.hpp"
#include "solvers/transient/simulation.hpp"

namespace stridor::test {

/// A body from its matrices; `rows` as ReducedBody::rows. It follows the drive, whose load acts as
/// the transpose of row `load_row`.
inline SystemBody driven_body(std::string name, Eigen::MatrixXd mass, Eigen::MatrixXd stiffness,
                              Eigen::MatrixXd rows, int load_row, double alpha = 0.0) {
  SystemBody body;
  body.name = std::move(name);
  body.reduced.base_inertia = Eigen::VectorXd::Zero(mass.rows());
  body.reduced.mass = std::move(mass);
  body.reduced.stiffness = std::move(stiffness);
  body.reduced.rows = std::move(rows);
  body.reduced.damping.alpha = alpha;
  body.modal = make_modal(body.reduced);
  body.drive = 0;
  body.loads = {BodyLoad{load_row}};
  return body;
}

/// A body without degrees of freedom: rigid ground for others.
inline SystemBody rigid_body(std::string name) {
  SystemBody body;
  body.name = std::move(name);
  body.reduced.rows.resize(1, 0);
  body.modal.rows.resize(1, 0);
  return body;
}

/// The straight line y = 0 without end.
inline MasterSurface rigid_line(int body) {
  MasterSurface surface;
  surface.name = "rigid";
  surface.body = body;
  surface.rows = {{0, 0}, {0, 0}};
  surface.positions = {{0.0, 0.0}, {1.0, 0.0}};
  surface.arc_length = {0.0, 1.0};
  surface.is_endless = true;
  return surface;
}

/// A point mass between a spring in x, whose other end follows the drive, and rigid ground, on
/// which the drive's load presses it. In the frame of the spring this is a mass on a belt that runs
/// with minus the drive's velocity.
struct MassOnGround {
  double mass = 1.0;           ///< kg
  double stiffness = 100.0;    ///< N/m
  double alpha = 0.0;          ///< damping c/m, 1/s
  double load = 10.0;          ///< downwards, N
  double belt_velocity = 0.0;  ///< m/s
  double displacement = 0.0;   ///< at the start, m
  double velocity = 0.0;       ///< at the start, m/s
  FrictionLaw friction = constant_friction(0.0);
  ContactAssumption assumption = ContactAssumption::film;

  static constexpr int x_row = 0;
  static constexpr int y_row = 1;

  System system() const {
    System result;
    Eigen::Matrix2d k = Eigen::Matrix2d::Zero();
    k(0, 0) = stiffness;
    result.bodies.push_back(driven_body("mass", mass * Eigen::Matrix2d::Identity(), k,
                                        Eigen::Matrix2d::Identity(), y_row, alpha));
    result.bodies[0].reduced.base_inertia(0) = mass;
    result.bodies[0].modal = make_modal(result.bodies[0].reduced);
    result.bodies[0].initial_displacement = Eigen::Vector2d(displacement, 0.0);
    result.bodies[0].initial_velocity = Eigen::Vector2d(velocity, 0.0);
    result.bodies.push_back(rigid_body("ground"));
    result.surfaces.push_back(rigid_line(1));
    ContactPoint contact;
    contact.name = "contact";
    contact.slave_rows = {x_row, y_row};
    contact.slave_position = {0.0, 0.0};
    contact.assumption = assumption;
    contact.friction = friction;
    contact.armed_from = 1e9;
    result.contacts.push_back(contact);
    result.drives[0].velocity = TimeCurve(-belt_velocity);
    result.drives[0].load = TimeCurve(-load);
    return result;
  }
};

/// An upright elastic bar that falls on rigid ground, of linear elements with lumped mass.
struct FallingBar {
  double youngs_modulus = 900.0;  ///< Pa
  double density = 1.0;           ///< kg/m³; the cross-section is 1 m²
  double length = 10.0;           ///< m
  double height = 5.0;            ///< of its lower end at the start, m
  double gravity = 10.0;          ///< m/s²
  double velocity = 0.0;          ///< upwards at the start, m/s
  int num_elements = 20;

  static constexpr int held_row = 0;   ///< its horizontal motion
  static constexpr int lower_row = 1;  ///< lower end, upwards
  static constexpr int middle_row = 2;
  static constexpr int upper_row = 3;
  static constexpr int gravity_row = 4;  ///< Mᵀ 1, the work of gravity per unit of it

  double wave_speed() const { return std::sqrt(youngs_modulus / density); }
  double element_length() const { return length / num_elements; }
  /// Largest stable step, s: the time in which a wave crosses an element.
  double step_limit() const { return element_length() / wave_speed(); }

  System system() const {
    const Eigen::Index n = num_elements + 1;
    const double k = youngs_modulus / element_length();
    const double m = density * element_length();
    Eigen::MatrixXd stiffness = Eigen::MatrixXd::Zero(n, n);
    Eigen::VectorXd mass = Eigen::VectorXd::Constant(n, m);
    mass(0) = mass(n - 1) = 0.5 * m;
    for (Eigen::Index e = 0; e + 1 < n; ++e) {
      stiffness(e, e) += k;
      stiffness(e + 1, e + 1) += k;
      stiffness(e, e + 1) -= k;
      stiffness(e + 1, e) -= k;
    }
    Eigen::MatrixXd rows = Eigen::MatrixXd::Zero(5, n);
    rows(lower_row, 0) = 1.0;
    rows(middle_row, num_elements / 2) = 1.0;
    rows(upper_row, n - 1) = 1.0;
    rows.row(gravity_row) = mass.transpose();
    System result;
    result.bodies.push_back(driven_body("bar", mass.asDiagonal(), stiffness, rows, gravity_row));
    result.bodies[0].initial_velocity = Eigen::VectorXd::Constant(n, velocity);
    result.bodies.push_back(rigid_body("ground"));
    result.surfaces.push_back(rigid_line(1));
    ContactPoint contact;
    contact.name = "contact";
    contact.slave_rows = {held_row, lower_row};
    contact.slave_position = {0.0, height};
    contact.assumption = ContactAssumption::film;
    result.contacts.push_back(contact);
    result.drives[0].load = TimeCurve(-gravity);
    return result;
  }
};

/// A light mass that the drive pushes over a simply supported beam (Euler-Bernoulli, in its exact
/// modes, drawn as a polyline) with a constant force.
struct MovingForce {
  double length = 1.0;             ///< of the beam, m
  double bending_stiffness = 1.0;  ///< E I, N m²
  double line_density = 1.0;       ///< kg/m
  double force = 1e-3;             ///< N
  double speed_ratio = 0.1;        ///< of the critical speed
  double mover_mass = 1e-9;        ///< kg
  int num_modes = 10;
  int num_segments = 200;

  double first_omega() const {
    const double wave_number = std::numbers::pi / length;
    return wave_number * wave_number * std::sqrt(bending_stiffness / line_density);
  }
  /// v_cr = ω_1 L/π
  double speed() const { return speed_ratio * first_omega() * length / std::numbers::pi; }
  double largest_omega() const { return num_modes * num_modes * first_omega(); }
  int middle_row() const { return 1 + num_segments / 2; }

  /// Row 0 of the beam is held, row 1 + k the deflection of node k of the polyline.
  System system() const {
    System result;
    result.bodies.push_back(driven_body("mover", mover_mass * Eigen::Matrix2d::Identity(),
                                        Eigen::Matrix2d::Zero(), Eigen::Matrix2d::Identity(), 1));
    SystemBody beam;
    beam.name = "beam";
    Eigen::VectorXd squares(num_modes);
    Eigen::MatrixXd rows = Eigen::MatrixXd::Zero(num_segments + 2, num_modes);
    for (int i = 1; i <= num_modes; ++i) {
      squares(i - 1) = std::pow(i, 4) * first_omega() * first_omega();
      for (int k = 0; k <= num_segments; ++k) {
        rows(1 + k, i - 1) = std::sqrt(2.0 / (line_density * length)) *
                             std::sin(i * k * std::numbers::pi / num_segments);
      }
    }
    beam.reduced.mass = Eigen::MatrixXd::Identity(num_modes, num_modes);
    beam.reduced.stiffness = squares.asDiagonal();
    beam.reduced.rows = rows;
    beam.modal = make_modal(beam.reduced);
    result.bodies.push_back(std::move(beam));

    MasterSurface surface;
    surface.name = "beam.top";
    surface.body = 1;
    for (int k = 0; k <= num_segments; ++k) {
      surface.rows.push_back({0, 1 + k});
      surface.positions.emplace_back(k * length / num_segments, 0.0);
      surface.arc_length.push_back(k * length / num_segments);
    }
    result.surfaces.push_back(std::move(surface));
    ContactPoint contact;
    contact.name = "contact";
    contact.slave_rows = {0, 1};
    contact.slave_position = {0.0, 0.0};
    contact.assumption = ContactAssumption::subs_a;
    contact.armed_from = 1e9;
    result.contacts.push_back(contact);
    result.drives[0].velocity = TimeCurve(speed());
    result.drives[0].load = TimeCurve(-force);
    return result;
  }
};

inline TimeParameters time_of(double step, Coordinates coordinates = Coordinates::modal) {
  TimeParameters time;
  time.step = step;
  time.coordinates = coordinates;
  return time;
}

}  // namespace stridor::test
