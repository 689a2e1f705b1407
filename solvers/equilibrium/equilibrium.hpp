// Static equilibrium of a sliding system.
#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

#include "coupling/kinematics/tangent_kinematics.hpp"
#include "coupling/system/system.hpp"
#include "solvers/equilibrium/contact_linearisation.hpp"

namespace stridor {

/// Geometry in which the contacts are evaluated.
enum class ContactGeometry {
  undeformed,  ///< every contact where the drive puts it on the undeformed master, as under Subs-a
  deformed,    ///< every contact by its assumption
};

/// Kinematics of a contact with two tangents in an equilibrium.
struct ContactEquilibrium;
/// @param geometry in the undeformed one directions do not depend on displacements
TangentKinematics tangent_kinematics(const System& system, const ContactPoint& point,
                                     const ContactEquilibrium& contact, ContactGeometry geometry,
                                     const LinearisationTerms& terms = {});

/// What one drive does in an equilibrium.
struct DriveState {
  double velocity = 0.0;  ///< of the bodies that follow it, in +x; gives χ and μ(v) only, m/s
  double load = 0.0;      ///< N
  double shift = 0.0;     ///< of the ground ends of springs, m
};

/// External loads and drives that hold the system in its equilibrium.
struct EquilibriumState {
  /// Of the bodies that follow the leading drive, in +x; the others by System::path_share(), m.
  double drive_displacement = 0.0;
  std::vector<DriveState> drives{};  ///< of System::drives; empty: all at rest without loads
  double friction_factor = 0.0;      ///< on every friction law, >= 0
  ContactGeometry geometry = ContactGeometry::deformed;
  /// What of `friction`, `friction_damping` and `geometric` acts where contacts have two tangents;
  /// in the undeformed geometry the first alone.
  LinearisationTerms terms{};
};

/// Loads and velocities of all drives at a time.
std::vector<DriveState> drive_states(const System& system, double time);

/// Loads, velocities and friction as they are once drives and friction no longer rise.
/// @param drive_displacement as of EquilibriumState, m
EquilibriumState sliding_state(const System& system, double drive_displacement,
                               ContactGeometry geometry = ContactGeometry::deformed);

/// Displacement of the leading drive that puts the undeformed slave point of a contact at a
/// position.
///
/// @param contact  index into System::contacts
/// @param position along the undeformed master from its first node, m; within its length, or
///                 anywhere where the master is endless
/// @return in +x, m
/// @throws std::invalid_argument if the position is off the master, or the drive cannot get there
///         because it moves slave and master alike or at right angles to the surface
double drive_displacement_at(const System& system, int contact, double position);

/// One contact in equilibrium.
struct ContactEquilibrium {
  bool is_closed = true;  ///< false: lifted off, without force
  int segment = 0;
  ContactPositions positions;  ///< without roughness; see set_roughness()
  Projection projection;
  double gap = 0.0;             ///< m; 0 but for rounding where it is closed; −y of a force law
  double position = 0.0;        ///< along the undeformed master from its first node, m
  double force = 0.0;           ///< λ_n, N
  double friction_force = 0.0;  ///< λ_t = χ μ λ_n, N
  double friction = 0.0;        ///< μ
  double direction = 1.0;       ///< χ
  double slip_velocity = 0.0;   ///< v_r, m/s; with two tangents |v|
  // With two tangents, where λ_t is friction along the first; `segment` is then a facet.
  TangentPorts ports;                                      ///< y; z of a slave that has none is 0
  Eigen::Vector2d place = Eigen::Vector2d::Constant(0.4);  ///< ξ and η on a facet
  double displaced = 0.0;  ///< of the slave against the master by drives, m
  double drawn = 0.0;      ///< the velocity of that, m/s
  Eigen::Vector2d velocity = Eigen::Vector2d::Zero();  ///< v, m/s
  double friction_across = 0.0;                        ///< friction along the second tangent, N
};

enum class EquilibriumStatus {
  converged,
  master_lost,    ///< a slave point is beyond the end of its master surface
  not_converged,  ///< the iteration was given up
};

struct Equilibrium {
  EquilibriumStatus status = EquilibriumStatus::not_converged;
  EquilibriumState state;                     ///< as asked for
  std::vector<Eigen::VectorXd> displacement;  ///< of every body, modal coordinates, m kg^½
  std::vector<ContactEquilibrium> contacts;
  double residual = 0.0;  ///< largest of displacement, gap and force, each relative to its scale
  int iterations = 0;     ///< Newton steps over all passes
  std::string failure;    ///< cause of the failure; empty where converged
};

struct EquilibriumParameters {
  double tolerance = 1e-12;  ///< largest residual of a converged equilibrium, > 0
  int max_iterations = 40;   ///< Newton steps in one pass
  int max_passes = 1000;     ///< passes with other segments or other open contacts
};

/// Static equilibrium of the sliding system (docs/theory.md, 6.1).
///
///   K q = f − B_E(q)ᵀ λ,   gap(q) = 0, or gap(q) = −y(λ) for a force law
///
/// for the contacts that slide bilaterally, y = λ/k of a penalty; 0 ≤ λ ⟂ gap ≥ 0 for those that
/// may lift off, at whatever time (ContactPoint::unilateral_from). χ and μ(v) are those of the
/// velocities of the drives. Elastic modes are eliminated; unknown are the displacements of the
/// contact ports, λ and the amplitudes of the rigid modes. Newton's method with the exact
/// derivative, halving the step until the residual falls. As in `Simulation`, a contact moves from
/// segment to segment without turning back; next to a node ξ may come out slightly beyond [0, 1].
///
/// Contacts with two tangents slide by spin and drives (linearise_face()); their gap is less
/// ContactPoint::overlap. Loads that bodies hold (SystemBody::held_load) act as well.
///
/// A body that nothing but the curvature of its master would hold counts as free.
/// A bilateral contact may come out pulling (λ < 0): then the equilibrium is none of real bodies.
/// @return with status and residual; contacts and displacements are those of the last iterate where
///         it has not converged
/// @throws NumericalError if the system is singular, naming the body that is free to move or the
///         contact whose force is undetermined, or if its numbers are not finite
/// @throws std::invalid_argument if the friction factor is negative, or the state is of another
/// number
///         of drives
/// Cost: a dense system of 7 unknowns per contact (11 on a smooth master) and one per rigid mode in
/// each Newton step.
Equilibrium find_equilibrium(const System& system, const EquilibriumState& state,
                             const EquilibriumParameters& parameters = {});

/// The same with the drive displaced such that a contact is at a given place of its deformed
/// master: friction and load bend the slave away from where the drive alone would put it.
///
/// The segment is that of the position, the one before it where that is a node.
/// @param contact  index into System::contacts
/// @param position along the undeformed master from its first node (ContactEquilibrium::position),
/// m
/// @param state    its drive displacement is not used
/// @return `state.drive_displacement` is the one found. Under Subs-a and in the undeformed geometry
///         it is drive_displacement_at()
/// @throws NumericalError as find_equilibrium()
/// @throws std::invalid_argument as drive_displacement_at() and find_equilibrium()
Equilibrium find_equilibrium_at(const System& system, int contact, double position,
                                const EquilibriumState& state,
                                const EquilibriumParameters& parameters = {});

/// Lets the bodies start in an equilibrium, without velocity relative to the drive.
///
/// @param system      its initial displacements and velocities are overwritten
/// @param equilibrium of this system with the drive at displacement 0, where a run starts
/// @throws std::invalid_argument if it has not converged or belongs to another place of the drive
void apply_initial_motion(System& system, const Equilibrium& equilibrium);

}  // namespace stridor
