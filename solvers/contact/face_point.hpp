// Kinematics of contacts with two tangents while the bodies move.
#pragma once

#include <array>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "coupling/kinematics/tangent_kinematics.hpp"
#include "coupling/system/system.hpp"
#include "solvers/contact/face_compliance.hpp"
#include "solvers/contact/node_ports.hpp"
#include "solvers/contact/port_block.hpp"

namespace stridor {

/// What a step is made with.
struct FaceInstant {
  double now = 0.0;     ///< t_n
  double sought = 0.0;  ///< when the conditions of contact are to hold
  double step = 0.0;    ///< h
  bool has_feedthrough = false;  ///< sought at t_n, where bodies respond at once
};

/// One slave point on its master (docs/theory.md, 10.2 and 2.7): gap, slip and directions of forces at the
/// ports of both bodies. Slips are those of the master against the slave, along both tangents, m.
/// Directions are those of the displacements expected.
class FacePoint {
 public:
  virtual ~FacePoint() = default;

  const ContactPoint& point() const { return point_; }
  int num_slave_ports() const { return num_slave_ports_; }
  int num_master_ports() const { return num_master_ports_; }

  /// Takes place and directions from the displacements expected at a time. @returns false where the slave
  /// has left its master
  virtual bool find(double sought) = 0;
  /// Takes the motion with which the bodies start. @returns v, m/s, or nothing where the slave is beside
  /// its master
  virtual std::optional<Eigen::Vector2d> stand(const System& system, const FaceInstant& at) = 0;

  /// Gap less the overlap of the contact with the displacements predicted, m; those expected are near.
  virtual double predicted_gap() const = 0;
  /// The same at t_{n+1} without forces from t_n on.
  virtual double gap_ahead(const FaceInstant& at) const = 0;
  /// Of the present motion.
  virtual double present_gap(double now) const = 0;
  /// Facet that it is on; 0 where there are none.
  virtual int facet() const { return 0; }
  /// Along the master, m: radius times angle on a face, along the first tangent in space.
  virtual double position() const = 0;

  /// Slip from the last instant known whole to the displacements predicted, and to those expected.
  virtual Eigen::Vector2d predicted_slip(const FaceInstant& at) const = 0;
  virtual Eigen::Vector2d expected_slip(const FaceInstant& at) const = 0;
  /// From the displacements expected to those at t_{n+1}.
  virtual Eigen::Vector2d slip_ahead(const FaceInstant& at) const = 0;
  /// Takes the motion once it is known whole at t_n. @returns the slip since the last such instant
  virtual Eigen::Vector2d follow(const FaceInstant& at) = 0;

  /// v by the spin or by drives alone, m/s.
  virtual Eigen::Vector2d drawn_velocity(double time) const = 0;
  /// What is done to the slip, and to the gap, in a step from an instant on by spin and drives, m.
  virtual Eigen::Vector2d drawn(double from, double step) const = 0;
  virtual double lifted(double from, double step) const = 0;

  /// @param step h, s: on a face slip in a step turns with the displacement, ½ h Ω r c
  virtual FaceDirections directions(double step) const = 0;
  /// Of undeformed bodies, or where that is not known of the present ones.
  virtual FaceDirections directions_at_rest(double step) const { return directions(step); }
  /// Directions at the master and at the slave.
  std::array<PortBlock, 2> blocks(const FaceDirections& directions) const;
  /// Adds its forces to those on the ports of either body.
  void apply(double normal, const Eigen::Vector2d& friction, double* slave_forces,
             double* master_forces) const;
  /// Ports of either body; those of the master may be shared with other contacts.
  std::span<const int> slave_ports() const { return ports_of(slave_ports_, num_slave_ports_); }
  std::span<const int> master_ports() const { return ports_of(master_ports_, num_master_ports_); }
  /// Rows of the master at its ports, the first num_master_ports() of them.
  std::array<int, max_facet_ports> master_rows() const;
  const TangentPorts& normal() const { return normal_; }
  const TangentPorts& along() const { return along_; }
  const TangentPorts& across() const { return across_; }

  /// Its state as numbers, and back.
  virtual std::vector<double> numbers() const = 0;
  virtual void restore(std::span<const double> numbers) = 0;

  /// "radius 0.1 m, angle 0.2 rad"
  virtual std::string where() const = 0;

 protected:
  /// Watches the slave; the ports of the master follow.
  FacePoint(const ContactPoint& point, Propagator& slave, Propagator& master, int slave_port,
            int num_master_ports);

  /// Ports of the master and of the slave in one vector.
  TangentPorts gathered(const double* slave, const double* master) const;
  Propagator& slave() const { return *slave_; }
  Propagator& master() const { return *master_; }

  // Directions of forces.
  TangentPorts normal_, along_, across_;
  std::array<int, max_facet_ports> master_ports_{};

 private:
  template <std::size_t most>
  static std::span<const int> ports_of(const std::array<int, most>& ports, int count) {
    return {ports.data(), static_cast<std::size_t>(count)};
  }

  ContactPoint point_;
  Propagator* slave_;
  Propagator* master_;
  int num_slave_ports_;
  int num_master_ports_;
  std::array<int, 3> slave_ports_{};
};

/// Of a contact on the face of a spinning body.
/// @param slave_port, master_port first ones of the contact, which others do not use
std::unique_ptr<FacePoint> make_spinning_point(const ContactPoint& point, Propagator& slave,
                                               Propagator& master, int slave_port, int master_port);
/// Of a contact on a rigid plane or on facets.
/// @param surface with the ports of its nodes, both referenced like the bodies; null on a plane
/// @param driven  of the slave against its master
std::unique_ptr<FacePoint> make_space_point(const ContactPoint& point, const FacetSurface* surface,
                                            NodePorts* nodes, const DrivenMotion& driven,
                                            Propagator& slave, Propagator& master, int slave_port);

}  // namespace stridor
