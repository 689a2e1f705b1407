// One slave point on its master while the bodies move.
#pragma once

#include <array>

#include "coupling/system/system.hpp"
#include "solvers/contact/contact_record.hpp"
#include "solvers/contact/port_block.hpp"
#include "solvers/integrators/propagator.hpp"

namespace stridor {

/// Row of one direction of a contact: entries at the ports of the slave (x, y) and of the nodes of
/// the master's stencil (x, y each), e·(u_C − Σ w_k u_k) for the direction e.
/// Forces along e act through the same entries.
struct PortRow {
  std::array<double, 2> slave{};
  std::array<double, 2 * max_stencil> master{};
};

/// Displacement per force between two contacts: rows of the normal and the tangent of one, W, and
/// those of another.
struct ContactCompliance {
  double nn = 0.0;  ///< n_i W n_j
  double nt = 0.0;  ///< n_i W t_j
  double tn = 0.0;
  double tt = 0.0;
};

/// Kinematics of a contact (docs/theory.md, 2.2): position of the slave point over its master,
/// normal and tangent there, and gap, slip and forces at the ports of the bodies.
class SlidingPoint {
  friend struct LaneAccess;

 public:
  /// Watches the rows of the slave and of the first segment.
  /// @param surface, slave, master referenced from here on
  /// @param slave_port, master_port first of its ports on either body
  SlidingPoint(const ContactPoint& point, const MasterSurface& surface, Propagator& slave,
               Propagator& master, int slave_port, int master_port);

  // In all that follows `driven` is what drives have displaced the slave against the master in +x,
  // DrivenMotion::displacement(), m.

  /// Finds segment and projection with the displacements expected. Starts from the segment of the
  /// last step and never turns back: on a sagging polyline the projections on two neighbours can
  /// both point at each other.
  /// @return false where the slave has left the end of the surface
  bool find(double driven);
  /// The projection of the present motion on the present segment.
  void stand(double driven);

  /// Distance of the slave from its projection along the normal, with the displacements predicted,
  /// m.
  double predicted_gap(double driven) const;
  /// Distance along the tangent from the displacements expected to those predicted, m.
  double predicted_slip() const;
  /// The same two at t_{n+1} by Propagator::ahead(), with the rows of t_n.
  /// @param advance of that in the step, m
  double gap_ahead(double driven, double advance) const;
  double slip_ahead(double advance) const;
  /// Relative velocity along the tangent times the step, from the increments, m.
  double increment() const;
  /// Part along the tangent of a displacement or velocity in +x.
  double along_tangent(double in_x) const { return in_x * projection_.tangent.x(); }

  /// Place along the undeformed master, as far as slip is concerned, m: the projection itself;
  /// under Subs-a, whose projection is prescribed, that and the displacements along it.
  double place() const;
  /// Deformed length of the master along the tangent by undeformed length.
  double stretch() const;
  /// Height of the rough surface, m.
  double roughness() const { return surface_->roughness_at(segment_, projection_.weights); }
  /// Of the present motion.
  ContactPlace present_place(double driven) const;
  /// Of the last projection along the undeformed master, m.
  double position() const { return surface_->arc_at(segment_, projection_.weights); }

  /// W of this contact per force of another.
  ContactCompliance compliance(const SlidingPoint& other) const;
  /// The same at t_{n+1}, by Propagator::ahead_compliances().
  ContactCompliance compliance_ahead(const SlidingPoint& other) const;
  /// n_i W (n_j − κ t_j): displacement along this normal per normal force of another contact that
  /// slides with κ = χ μ. Cost: less than half of compliance().
  double sliding_compliance(const SlidingPoint& other, double friction) const;
  /// Writes λ_n and λ_t as forces on the ports of either body.
  void apply(double normal, double tangential, double* slave_forces, double* master_forces) const;

  /// Its blocks at the master and at the slave.
  std::array<PortBlock, 2> blocks() const;

  const ContactPoint& point() const { return point_; }
  const MasterSurface& surface() const { return *surface_; }
  int segment() const { return segment_; }
  const Projection& projection() const { return projection_; }
  /// Takes up a saved place.
  void restore(int segment, double xi, const Eigen::Vector2d& tangent);

 private:
  /// Slave and master as seen from the undeformed T1: far from the origin the gap would drown in
  /// the rounding of the positions.
  struct Place {
    Eigen::Vector2d slave;
    SurfacePiece master;
  };

  using Compliances = const double* (Propagator::*)() const;
  ContactCompliance compliance_by(const SlidingPoint& other, Compliances compliances) const;
  /// Calls visit(body, entries of this, entries of the other) for every body that both share.
  template <class Visit>
  void for_shared_bodies(const SlidingPoint& other, const Visit& visit) const;
  /// Takes up the undeformed segment.
  void enter(int segment);
  /// The same, and has the master follow its nodes.
  void watch(int segment);
  void set_place(const double* slave, const double* master, double driven, Place& place) const;
  Projection project_place(const Place& place, double driven) const;
  void set_rows();
  /// From the projection to the slave without displacements, along a direction.
  double undeformed_arm(const Eigen::Vector2d& direction, double driven) const;
  double relative(const PortRow& row, const double* slave, const double* master) const;

  ContactPoint point_;
  const MasterSurface* surface_;
  Propagator* slave_;
  Propagator* master_;
  int slave_port_;
  int master_port_;
  int last_segment_;

  int segment_ = -1;
  SurfacePiece undeformed_;
  Eigen::Vector2d slave_origin_ = Eigen::Vector2d::Zero();  ///< undeformed slave from T1, m
  Place place_;                                             ///< of the last find() or stand()
  Projection projection_;
  PortRow normal_;
  PortRow tangent_;
};

}  // namespace stridor
