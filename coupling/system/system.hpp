// The coupled system: bodies, the surfaces and points where they may touch, and the drives.
#pragma once

#include <algorithm>
#include <array>
#include <limits>
#include <optional>
#include <string>
#include <vector>

#include "core/time_curve.hpp"
#include "coupling/kinematics/contact.hpp"
#include "coupling/kinematics/face_place.hpp"
#include "coupling/kinematics/roughness.hpp"
#include "coupling/kinematics/space_contact.hpp"
#include "coupling/kinematics/surface.hpp"
#include "coupling/laws/friction_law.hpp"
#include "coupling/laws/substrate_contact.hpp"
#include "coupling/system/drive.hpp"
#include "substructures/reduction/modal_body.hpp"

namespace stridor {

/// Rows of ReducedBody::rows that carry the displacement of one point.
struct PointRows {
  int x = 0;
  int y = 0;
  int z = -1;  ///< −1: the body does not move along z

  /// Row of a direction: x (0), y (1) or z (2).
  int row(int direction) const { return direction == 0 ? x : direction == 1 ? y : z; }
};

/// One component and its position.
struct SystemBody {
  std::string name;
  ReducedBody reduced;
  ModalBody modal;  ///< the same body in its modes
  int drive = -1;  ///< index into System::drives of the one that its supports follow; −1 where none
  std::vector<BodyLoad> loads;  ///< of drives
  /// Motion at t = 0 in reduced coordinates, m and m/s; empty for a body at rest.
  Eigen::VectorXd initial_displacement;
  Eigen::VectorXd initial_velocity;
  Eigen::VectorXd held_load;  ///< constant generalised load in reduced coordinates, N; empty where there is none

  /// Lowest ω among modes that the body never had, rad/s (BodyMatrices::lowest_omitted).
  double lowest_omitted = std::numeric_limits<double>::infinity();

  bool follows_drive() const { return drive >= 0; }
  /// Whether a drive moves or loads it.
  bool feels_drive() const { return follows_drive() || !loads.empty(); }
};

/// A master surface: nodes in order, the body on their right-hand side.
struct MasterSurface {
  std::string name;  ///< "<body>.<surface>", or "rigid"
  int body = 0;
  std::vector<PointRows> rows;
  std::vector<Eigen::Vector2d> positions;  ///< undeformed, global, m
  std::vector<double> arc_length;          ///< along the undeformed surface from its first node, m
  bool is_endless = false;                 ///< the first and last segment go on for ever
  SurfaceKind kind = SurfaceKind::polyline;
  Roughness roughness;  ///< over the arc length

  int num_segments() const { return static_cast<int>(positions.size()) - 1; }
  /// Ends of a segment, m.
  Segment undeformed_segment(int segment) const {
    const auto s = static_cast<std::size_t>(segment);
    return {positions[s], positions[s + 1]};
  }
  int stencil_size() const { return stridor::stencil_size(kind, num_segments() + 1); }
  Stencil stencil(int segment) const { return make_stencil(kind, num_segments() + 1, segment); }
  /// A segment with its nodes as seen from T1, m.
  SurfacePiece undeformed_piece(int segment) const {
    SurfacePiece piece{stencil(segment), {}};
    const Eigen::Vector2d& origin = positions[static_cast<std::size_t>(segment)];
    for (int k = 0; k < piece.stencil.count; ++k) {
      piece.nodes[static_cast<std::size_t>(k)] =
          positions[static_cast<std::size_t>(piece.stencil.first + k)] - origin;
    }
    return piece;
  }
  /// Projection of a point on the undeformed surface within one segment; ξ outside [0, 1] where the
  /// point is beside it.
  /// @param point global, m
  Projection project_undeformed(int segment, const Eigen::Vector2d& point) const {
    if (stencil_size() == 2) return project(undeformed_segment(segment), point);
    constexpr double guess = 0.5;
    return project(undeformed_piece(segment), point - positions[static_cast<std::size_t>(segment)],
                   guess);
  }
  /// Arc length of the undeformed surface that belongs to a place of a segment, Σ w_k s_k, m.
  double arc_at(int segment, const std::array<double, max_stencil>& weights) const {
    const double origin = arc_length[static_cast<std::size_t>(segment)];
    return origin + combine_arcs(segment, weights, origin);
  }
  /// Height of the rough surface above the smooth one at a place, m.
  double roughness_at(int segment, const std::array<double, max_stencil>& weights) const {
    return roughness.is_smooth() ? 0.0 : roughness.at(arc_at(segment, weights)).value;
  }
  /// Derivative of arc_at() by ξ, m.
  /// @param slopes of the weights
  double arc_slope(int segment, const std::array<double, max_stencil>& slopes) const {
    return combine_arcs(segment, slopes, arc_length[static_cast<std::size_t>(segment)]);
  }
  /// Σ of weights with the arc lengths of the stencil, counted from an origin.
  double combine_arcs(int segment, const std::array<double, max_stencil>& weights,
                      double origin) const {
    const Stencil nodes = stencil(segment);
    double sum = 0.0;
    for (int k = 0; k < nodes.count; ++k) {
      sum += weights[static_cast<std::size_t>(k)] *
             (arc_length[static_cast<std::size_t>(nodes.first + k)] - origin);
    }
    return sum;
  }
};

/// Treatment of a contact that violates the assumption of persistent sliding once it is armed.
enum class OnViolation {
  stop,        ///< the run ends
  unilateral,  ///< it sticks, slips and lifts off
};

/// One slave point on one master surface, on one place of the face of a spinning body, or in space.
struct ContactPoint {
  std::string name;  ///< of the pair it belongs to, with "[k]" where the pair has several points
  /// Name of its pair, the points of which are <pair>[0], <pair>[1], ...; `name` where it has one.
  std::string pair() const { return name.substr(0, name.find('[')); }
  int slave_body = 0;
  PointRows slave_rows;
  Eigen::Vector2d slave_position;  ///< undeformed, global, at the start of the drive, m
  int surface = 0;                 ///< index into System::surfaces
  int first_segment = 0;           ///< of the surface, under the undeformed slave point
  ContactAssumption assumption = ContactAssumption::subs_b;
  FrictionLaw friction;
  TimeCurve friction_rise{1.0};  ///< factor on the law over time
  /// Stiffness of a spring in the place of gap = 0, N/m, > 0: λ_n = −k gap.
  std::optional<double> penalty;
  /// A force law in the place of gap = 0 and of the friction law, which then are not used. It acts
  /// with all of its friction from the start.
  std::optional<SubstrateContact> substrate;
  OnViolation on_violation = OnViolation::stop;
  /// Violations of persistent sliding before this time are only counted, s.
  double armed_from = 0.0;
  /// In the place of `surface` and `first_segment`: contact on a face, with two tangents. The frame of
  /// the slave is then x along the circumference, y along the axis away from the face, z along the
  /// radius.
  std::optional<FacePlace> face;
  /// Likewise: contact on a rigid plane or on facets, with two tangents; the frame of the slave is that
  /// of space.
  std::optional<SpacePlace> space;
  /// What the gap of a contact with two tangents is counted from, m: on a face the indentation of
  /// undeformed bodies, preload/penalty, 0 for multipliers; in space the gap at the start where that is
  /// taken as closed.
  double overlap = 0.0;

  bool has_two_tangents() const { return face.has_value() || space.has_value(); }
  int num_slave_ports() const { return has_two_tangents() && slave_rows.z >= 0 ? 3 : 2; }

  /// Gap per force of compression, 1/k, m/N; 0 of a contact that a multiplier closes.
  double compliance() const { return penalty ? 1.0 / *penalty : 0.0; }
  /// From this time on the contact sticks, slips and lifts off; before it slides bilaterally.
  double unilateral_from() const {
    if (assumption == ContactAssumption::film) return -std::numeric_limits<double>::infinity();
    return on_violation == OnViolation::unilateral ? armed_from
                                                   : std::numeric_limits<double>::infinity();
  }
};

struct System {
  std::vector<SystemBody> bodies;
  std::vector<MasterSurface> surfaces;
  std::vector<FacetSurface> facet_surfaces;
  std::vector<ContactPoint> contacts;
  std::vector<Drive> drives{Drive()};  ///< one at least

  const MasterSurface& surface_of(const ContactPoint& contact) const {
    return surfaces[static_cast<std::size_t>(contact.surface)];
  }
  /// "<body>.<surface>" or "<body>.<face>" that a contact touches.
  const std::string& master_name(const ContactPoint& contact) const {
    return contact.face    ? contact.face->name
           : contact.space ? contact.space->name
                           : surface_of(contact).name;
  }
  /// The body that a contact touches with its slave point.
  int master_of(const ContactPoint& contact) const {
    return contact.face    ? contact.face->body
           : contact.space ? contact.space->body
                           : surface_of(contact).body;
  }
  /// The facets that a contact in space touches; null on a rigid plane and for other contacts.
  const FacetSurface* facets_of(const ContactPoint& contact) const {
    if (!contact.space || contact.space->surface < 0) return nullptr;
    return &facet_surfaces[static_cast<std::size_t>(contact.space->surface)];
  }
  /// Rows of the master that a contact with two tangents watches.
  /// @param facet of a contact on facets
  std::vector<int> master_rows(const ContactPoint& contact, int facet) const;
  /// Most of these.
  int num_master_ports(const ContactPoint& contact) const;
  /// The drive that a body follows; null where there is none.
  const Drive* drive_of(int body) const {
    const int drive = bodies[static_cast<std::size_t>(body)].drive;
    return drive < 0 ? nullptr : &drives[static_cast<std::size_t>(drive)];
  }
  /// Motion of the slave of a contact against its master by the drives.
  DrivenMotion driven_motion(const ContactPoint& contact) const {
    return {drive_of(contact.slave_body), drive_of(master_of(contact))};
  }
  /// From this time on nothing changes of any drive.
  double drives_constant_from() const {
    double time = 0.0;
    for (const Drive& drive : drives) time = std::max(time, drive.constant_from());
    return time;
  }
  /// The drive by whose displacement places on the way of the system are counted: the first one
  /// that some body follows and that moves in the end, else the first that some body follows.
  const Drive& leading_drive() const;
  /// Displacement in +x of a body per displacement of the leading drive: 1 of what follows that,
  /// the ratio of the velocities in the end of what follows another, 0 of what follows none.
  double path_share(int body) const;
  /// Of the slave of a contact against its master.
  double path_share(const ContactPoint& contact) const {
    return path_share(contact.slave_body) - path_share(master_of(contact));
  }
  bool has_faces() const {
    return std::any_of(contacts.begin(), contacts.end(),
                       [](const ContactPoint& contact) { return contact.has_two_tangents(); });
  }
  /// Displacements of the bodies at a contact: x and y of the slave and of every node of the
  /// stencil; with two tangents, those of the master and those of the slave, x, y and z.
  int num_contact_ports(const ContactPoint& contact) const {
    if (contact.has_two_tangents()) return num_master_ports(contact) + contact.num_slave_ports();
    return 2 + 2 * surface_of(contact).stencil_size();
  }
};

}  // namespace stridor
