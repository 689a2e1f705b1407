// Sources and sinks of the energy of a run.
#pragma once

#include <cmath>
#include <cstdint>
#include <limits>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "core/state.hpp"
#include "coupling/kinematics/face_kinematics.hpp"
#include "coupling/system/system.hpp"
#include "solvers/algebra/aligned_array.hpp"
#include "solvers/contact/contact_solver.hpp"
#include "solvers/integrators/time_parameters.hpp"

namespace stridor {

/// A sum to which many small terms can be added without losing their digits (Neumaier 1974).
class CompensatedSum {
 public:
  void add(double term) {
    const double sum = sum_ + term;
    const bool is_larger = std::abs(sum_) >= std::abs(term);
    carry_ += is_larger ? (sum_ - sum) + term : (term - sum) + sum_;
    sum_ = sum;
  }
  double value() const { return sum_ + carry_; }

  void save(State& state, const std::string& name) const;
  /// @throws std::invalid_argument if there is no such sum
  void load(const State& state, const std::string& name);

 private:
  double sum_ = 0.0;
  double carry_ = 0.0;
};

/// Action of a contact on its bodies from t_n to t_{n+1}.
struct ContactAction {
  int segment = 0;              ///< of its master surface
  Projection projection;        ///< where and in which directions its forces act
  double force = 0.0;           ///< λ_n, N, compression positive
  double friction_force = 0.0;  ///< λ_t, N, positive against sliding of the slave along +t
  ContactState state = ContactState::open;
  double roughness = 0.0;  ///< height of the rough surface at t_{n+1}, m
  // With two tangents, where friction_force is that along the first.
  double friction_across = 0.0;                       ///< along the second, N
  Eigen::Vector2d sliding = Eigen::Vector2d::Zero();  ///< v at t_{n+1}, m/s
  int num_master_rows = 0;
  std::array<int, max_facet_ports> master_rows{};  ///< of the master's body, at its ports
  TangentPorts normal{}, along{}, across{};        ///< directions of its forces
  Eigen::Vector2d drawn = Eigen::Vector2d::Zero();  ///< slip in the step by spin and drives, m
  double lifted = 0.0;                              ///< opening of the gap in the step by drives, m
};

/// The entries of the ledger, J (docs/theory.md, 3.4). Losses and works are sums since the start.
struct EnergyBalance {
  double kinetic = 0.0;        ///< of the motion relative to the drive
  double strain = 0.0;         ///< of all bodies
  double damping_loss = 0.0;   ///< taken out by the damping of the bodies
  double friction_loss = 0.0;  ///< taken out by λ_t along the sliding
  double contact_work = 0.0;   ///< done by λ_n along the opening of the gap; negative: a loss
  double drive_work = 0.0;     ///< done by the motion of drives
  double load_work = 0.0;      ///< done by loads and by springs whose ground ends are displaced
  /// kinetic + strain − initial + damping_loss + friction_loss − contact_work − drive_work −
  /// load_work
  double balance_error = 0.0;
};

/// Friction that has fed energy: steps in which λ_t of a sliding contact had the direction of the
/// corrected sliding velocity.
struct FrictionGain {
  std::int64_t steps = 0;
  double largest_power = 0.0;  ///< W
  double last_time = 0.0;      ///< of the latest such step, s
};

/// Contacts that have given energy to the bodies. A normal force does no work on a gap that it
/// holds closed, and only takes energy in an impact. A rough surface moved by the drive has an
/// account of its own, and the spring of a penalty gives back what it has stored, ½ λ_n²/k. The
/// remaining contact work may therefore not rise.
struct ContactGain {
  double energy = 0.0;     ///< largest rise of it over any stretch of time, J
  double last_time = 0.0;  ///< at the end of that stretch, s
};

/// The energy of a system in motion, entry by entry, each from its own definition and none as the
/// remainder of the others (docs/theory.md, 3.4).
///
/// With d_n = q_n − q_{n−1} and the mean increment d̄_n = (d_n + d_{n+1})/2, which is the motion
/// that a force at t_n does its work along, a step adds
///
///   kinetic        ½ d_{n+1}ᵀ M d_{n+1}/h²          at t_{n+1/2}
///   strain         ½ q_nᵀ K q_{n+1}                 at t_{n+1/2}
///   damping loss   d̄_nᵀ C(t_n) d_n/h
///   load work      F(t_n) d̄_n of every load, k d(t_n) d̄_n of springs displaced by d
///   friction loss  λ_t t·(d̄_r + δ x̂)
///   contact work   λ_n n·(d̄_r + δ x̂)
///   drive work     −a_A(t_n) (M r)ᵀ d̄_n − δ x̂·(λ_n n − λ_t t)
///
/// where d̄_r is the mean increment of the slave relative to the master and δ = h v_x(t_n) what
/// drives add to it. With these the central difference with backward-difference damping balances
/// exactly, whatever the contact forces: the balance error is rounding. Where sliding is frozen,
/// the master is imagined to slide along t: contact work lacks δ, and the drive feeds friction
/// alone. With two tangents the directions N and F of force and friction τ do
///
///   contact work   λ_n (N·ȳ + ν),    friction loss   τ·(σ − Fᵀȳ),    drive work   τ·σ − λ_n ν
///
/// with the mean increments ȳ of the ports, the slip σ by spin and drives, h Ω r (1, −c·y) on a face
/// that spins, and the opening ν of the gap by drives. Loads that bodies hold are part of the load work.
///
/// Everything is evaluated from the system and its motion; no coefficient of a propagator enters.
class EnergyLedger {
 public:
  /// Begins at the initial motion of the bodies.
  /// @param system its needed parts are copied; not referenced afterwards
  /// @param time   step, and the coordinates in which positions and increments will come
  EnergyLedger(const System& system, const TimeParameters& time);

  /// Destination of q_n and d_{n+1} of a body before `add`, in its coordinates.
  std::span<double> position(int body);
  std::span<double> increment(int body);

  /// Enters the step from t_n to t_{n+1}. Steps must come one after the other from the start on.
  /// @param time            t_n, s
  /// @param contacts        of the system, in its order
  /// @param slip_velocities corrected, at t_{n+1}, m/s
  /// Cost: about that of the step in modal coordinates, four dense products of a body in others. No
  /// allocation.
  void add(double time, std::span<const ContactAction> contacts,
           std::span<const double> slip_velocities);

  const EnergyBalance& balance() const { return balance_; }
  /// kinetic + strain at the start, J.
  double initial() const { return initial_; }
  /// Largest |balance_error| of all steps, J.
  double largest_error() const { return largest_error_; }
  /// Exchanged energy: largest stored energy so far and the losses, |damping_loss| +
  /// |friction_loss| + |contact_work|, J.
  double turned_over() const;
  /// largest_error() / turned_over(); 0 where nothing has moved.
  double relative_error() const;
  const FrictionGain& friction_gain() const { return friction_gain_; }
  const ContactGain& contact_gain() const { return contact_gain_; }
  /// Whether the contacts have given more work than the rotation of the normal within a step
  /// explains: a hundredth of the energy exchanged (docs/theory.md, 3.4).
  bool contacts_feed() const { return contact_gain_.energy > 0.01 * turned_over(); }

  void save(State& state, const std::string& prefix) const;
  /// @throws std::invalid_argument if the state is of another system; the ledger must not be used
  ///         then
  void load(const State& state, const std::string& prefix);

 private:
  struct Body {
    int drive = -1;
    std::vector<BodyLoad> loads;
    RayleighDamping damping;
    std::size_t size = 0;
    std::size_t padded_size = 0;
    AlignedArray rows;          ///< padded, one after the other
    AlignedArray base_inertia;  ///< padded; empty where the body does not follow the drive
    AlignedArray held_load;     ///< padded; empty where there is none
    AlignedArray square_omega;  ///< ω², padded; empty in reduced coordinates
    Eigen::MatrixXd mass;       ///< empty in modal coordinates, like the next
    Eigen::MatrixXd stiffness;
    AlignedArray position;        ///< q_n, padded like the next three
    AlignedArray increment;       ///< d_{n+1}
    AlignedArray last_increment;  ///< d_n
    AlignedArray mean_increment;  ///< d̄_n
    Eigen::VectorXd product;      ///< scratch
  };
  /// Quadratic forms of one step of a body, before time step and damping: d_{n+1}ᵀ M d_{n+1},
  /// q_nᵀ K q_{n+1}, d̄_nᵀ M d_n, d̄_nᵀ K d_n.
  struct Forms {
    double kinetic, strain, mass_damping, stiffness_damping;
  };
  struct Contact {
    int slave_body;
    int master_body;
    PointRows slave_rows;
    std::vector<PointRows> master_rows;
    SurfaceKind surface_kind;
    DrivenMotion driven;  ///< of the slave against the master
    double compliance;  ///< of its spring, 1/k, m/N; 0 where it is rigid
    /// Of the last two steps, t_{n−1} and t_n, N.
    double force_before_last = std::numeric_limits<double>::quiet_NaN();
    double last_force = std::numeric_limits<double>::quiet_NaN();
    /// Of the last two steps, t_{n−1} and t_n, m.
    double roughness_before_last = std::numeric_limits<double>::quiet_NaN();
    double last_roughness = std::numeric_limits<double>::quiet_NaN();
    bool has_two_tangents = false;
  };

  static Body make_body(const SystemBody& body, const TimeParameters& time);
  static Forms forms_of_step(Body& body);
  double acceleration_of(const Body& body, double time) const;
  double mean_increment(const Body& body, int row) const;
  Eigen::Vector2d mean_increment(const Contact& contact, const ContactAction& action) const;
  double enter_face(const Contact& contact, const ContactAction& action);
  double enter_contact(const Contact& contact, const ContactAction& action, double driven);
  static double roughness_increment(Contact& contact, double roughness);
  static double stored_increment(Contact& contact, double force);
  void enter_gain(double given, double time);
  void enter_stored(double kinetic, double strain);

  double step_;
  std::vector<Drive> drives_;
  std::vector<Body> bodies_;
  std::vector<Contact> contacts_;

  double initial_ = 0.0;
  CompensatedSum damping_loss_;
  CompensatedSum friction_loss_;
  CompensatedSum contact_work_;
  CompensatedSum drive_work_;
  CompensatedSum load_work_;
  EnergyBalance balance_;
  double largest_stored_ = 0.0;
  double largest_error_ = 0.0;
  FrictionGain friction_gain_;
  CompensatedSum given_;  ///< by the contacts, without the work of roughness
  double least_given_ = 0.0;
  ContactGain contact_gain_;
};

}  // namespace stridor
