// Motion of bodies that rub on the faces of a spinning plate, with lift-off and stick.
#pragma once

#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "core/state.hpp"
#include "coupling/face_contact.hpp"
#include "solvers/contact_solver.hpp"
#include "solvers/face_contact_ports.hpp"

namespace stridor {

/// A contact at one instant.
struct FaceContactState {
  double gap = 0.0;  ///< m; of a contact with a penalty negative where it is pressed
  /// λ, N, >= 0; of a rigid contact the impulse of a step over the step
  double force = 0.0;
  double friction_force = 0.0;  ///< along the sliding direction, on the pad, N
  double across_force = 0.0;    ///< across it, N
  double slip_velocity = 0.0;   ///< of the face against the pad, magnitude, m/s
  ContactState state = ContactState::slip;
};

/// Marches M ẍ + P ẋ + Q x = the deviation of contact forces from those of a sliding state, x = q −
/// q₀ (docs/theory.md, 10.6). The laws of the contacts are those of FaceContactSolver, with the gap
/// g of FaceContact and v = (Ω r − b q̇, −a q̇ − Ω r c q) the velocity of the face against the pad.
/// Forces act along n + A q, b + B q and a.
class FaceContactMotion {
 public:
  virtual ~FaceContactMotion() = default;

  /// At t = 0, from the sliding state.
  virtual void start(const Eigen::VectorXd& displacement, const Eigen::VectorXd& velocity) = 0;
  /// One step. @return whether the contact forces have converged and the motion is finite
  virtual bool step() = 0;

  /// x, from the sliding state.
  virtual Eigen::VectorXd displacement() const = 0;
  virtual Eigen::VectorXd velocity() const = 0;
  virtual int num_contacts() const = 0;
  virtual FaceContactState contact(int index) const = 0;
  /// A displacement at a contact, from the sliding state, m.
  virtual double moved(int contact, FacePort port) const = 0;

  virtual void save(State& state, const std::string& prefix) const = 0;
  /// @throws std::invalid_argument if the state is of another system
  virtual void load(const State& state, const std::string& prefix) = 0;
};

/// Of springs where the law has a penalty (SpringContactMotion), else of rigid contacts
/// (RigidContactMotion).
/// @throws std::invalid_argument as they do
std::unique_ptr<FaceContactMotion> make_face_contact_motion(
    const LinearSystem& bodies, const std::vector<FaceContact>& contacts, const FaceContactLaw& law,
    const FaceSlidingState& state, double step);

/// @param seen   gap, and velocities of the face against the pad
/// @param forces of the contact
FaceContactState face_contact_state(const FaceContactLaw& law, const FaceContact& contact,
                                    const Eigen::Vector3d& seen, const Eigen::Vector3d& forces);

/// sin(x)/x, and its lowest value from where that is first reached.
double least_sine_ratio(double x);

/// Σ φ φᵀ answer(ω) of the modes of a system, damping and skew parts left aside, at the normals of
/// the closed contacts: k x k.
/// @param answer of a mode of unit mass with ω, rad/s
Eigen::MatrixXd normal_answer(const LinearSystem& system, const FaceSlidingState& state,
                              const std::function<double(double)>& answer);

/// Of the symmetric part; true of a matrix without rows.
bool is_positive_definite(const Eigen::MatrixXd& matrix);

}  // namespace stridor
