// The coupled system: bodies, the surfaces and points where they may touch, and what drives them.
#pragma once

#include <algorithm>
#include <limits>
#include <string>
#include <vector>

#include "core/time_curve.hpp"
#include "coupling/contact.hpp"
#include "coupling/friction_law.hpp"
#include "substructures/modal_body.hpp"

namespace stridor {

/// Rows of ReducedBody::rows that carry the x and y displacement of one point.
struct PointRows {
  int x = 0;
  int y = 0;
};

/// One component and where it stands.
struct SystemBody {
  std::string name;
  ReducedBody reduced;
  ModalBody modal;  ///< the same body in its modes
  bool follows_drive = false;
  int load_row = -1;  ///< row on which the drive's load acts; −1 where none
  /// Motion at t = 0 in reduced coordinates, m and m/s; empty for a body at rest.
  Eigen::VectorXd initial_displacement;
  Eigen::VectorXd initial_velocity;
};

/// A master surface: nodes in order, the body on their right-hand side.
struct MasterSurface {
  std::string name;  ///< "<body>.<surface>", or "rigid"
  int body = 0;
  std::vector<PointRows> rows;
  std::vector<Eigen::Vector2d> positions;  ///< undeformed, global, m
  std::vector<double> arc_length;          ///< along the undeformed surface from its first node, m
  bool is_endless = false;                 ///< the first and last segment go on for ever

  int num_segments() const { return static_cast<int>(positions.size()) - 1; }
  Segment undeformed_segment(int segment) const {
    const auto s = static_cast<std::size_t>(segment);
    return {positions[s], positions[s + 1]};
  }
};

/// What becomes of a contact whose assumption of persistent sliding is violated once it is armed.
enum class OnViolation {
  stop,        ///< the run ends
  unilateral,  ///< it sticks, slips and lifts off
};

/// One slave point on one master surface.
struct ContactPoint {
  std::string name;  ///< of the pair it belongs to, with "[k]" where the pair has several points
  int slave_body = 0;
  PointRows slave_rows;
  Eigen::Vector2d slave_position;  ///< undeformed, global, at the start of the drive, m
  int surface = 0;                 ///< index into System::surfaces
  int first_segment = 0;           ///< of the surface, under the undeformed slave point
  ContactAssumption assumption = ContactAssumption::subs_b;
  FrictionLaw friction;
  TimeCurve friction_rise{1.0};  ///< factor on the law over time
  OnViolation on_violation = OnViolation::stop;
  /// Violations of persistent sliding before this time are only counted, s.
  double armed_from = 0.0;

  /// From this time on the contact sticks, slips and lifts off; before it slides bilaterally.
  double unilateral_from() const {
    if (assumption == ContactAssumption::film) return -std::numeric_limits<double>::infinity();
    return on_violation == OnViolation::unilateral ? armed_from
                                                   : std::numeric_limits<double>::infinity();
  }
};

/// What moves the system from outside.
struct Drive {
  TimeCurve velocity;      ///< of guided supports in +x, m/s
  TimeCurve load;          ///< on every guided support in +y, N
  bool is_frozen = false;  ///< the supports stay where they are, friction acts as if they moved

  /// Displacement of the guided supports in +x, m.
  double displacement(double time) const { return is_frozen ? 0.0 : velocity.integral(time); }
  double acceleration(double time) const { return is_frozen ? 0.0 : velocity.slope(time); }
  /// From this time on velocity and load no longer change.
  double constant_from() const { return std::max(velocity.constant_from(), load.constant_from()); }
};

struct System {
  std::vector<SystemBody> bodies;
  std::vector<MasterSurface> surfaces;
  std::vector<ContactPoint> contacts;
  Drive drive;
};

}  // namespace stridor
