// Contacts on the faces of spinning bodies while the bodies move.
#pragma once

#include <array>
#include <span>
#include <utility>
#include <vector>

#include "coupling/kinematics/face_kinematics.hpp"
#include "solvers/contact/contact_record.hpp"
#include "solvers/contact/face_compliance.hpp"
#include "solvers/contact/port_block.hpp"

namespace stridor {

/// One slave point on its face (docs/theory.md, 10.2): gap, slip and directions of forces at the ports
/// of both bodies. Directions are those of the displacements expected.
class FacePoint {
 public:
  /// Watches its rows.
  /// @param slave, master referenced from here on
  FacePoint(const ContactPoint& point, Propagator& slave, Propagator& master, int slave_port,
            int master_port);

  const ContactPoint& point() const { return point_; }
  const FaceKinematics& face() const { return face_; }
  int num_slave_ports() const { return num_slave_ports_; }

  /// Takes the directions n + A y and b + B y from the displacements expected.
  void find();
  /// Ports as of Propagator::expected() and so on.
  FacePorts expected() const { return ports(slave_->expected(), master_->expected()); }
  FacePorts predicted() const { return ports(slave_->predicted(), master_->predicted()); }
  FacePorts current() const { return ports(slave_->current(), master_->current()); }
  FacePorts increment() const { return ports(slave_->increments(), master_->increments()); }
  FacePorts ahead() const { return ports(slave_->ahead(), master_->ahead()); }

  /// Gap less the overlap of the contact with the displacements predicted, m; those expected are near.
  double predicted_gap() const;
  double gap_ahead() const;

  /// y of the last find() or restore().
  const FacePorts& directed_at() const { return directed_at_; }
  void direct(const FacePorts& ports);
  const FacePorts& normal() const { return normal_; }
  const FacePorts& along() const { return along_; }

  /// Gap, and slip with the opposite sign, per displacement of the ports; force per unit of λ_n and of
  /// friction.
  struct Directions {
    FaceCompliances::Directions sense, push;
  };
  /// @param step h, s: slip in a step turns with the displacement, ½ h Ω r c
  Directions directions(double step) const;
  /// The same at the master and at the slave.
  std::array<PortBlock, 2> blocks(double step) const;
  /// Writes its forces on the ports of either body.
  void apply(double normal, const Eigen::Vector2d& friction, double* slave_forces,
             double* master_forces) const;

 private:
  FacePorts ports(const double* slave, const double* master) const;

  ContactPoint point_;
  FaceKinematics face_;
  Propagator* slave_;
  Propagator* master_;
  int slave_port_;
  int master_port_;
  int num_slave_ports_;
  FacePorts directed_at_ = FacePorts::Zero();
  FacePorts normal_, along_;
};

/// A contact on a face while it runs.
struct RunningFace : ContactRecord {
  explicit RunningFace(FacePoint on_face) : kinematics(std::move(on_face)) {}

  FacePoint kinematics;

  // State.
  double friction_across = 0.0;  ///< friction along the radius
  ContactState last_state = ContactState::open;
  FacePorts reached = FacePorts::Zero();  ///< y at the last instant that is known whole
  /// Mean velocities of the last two steps, the latest first, m/s.
  std::array<Eigen::Vector2d, 2> velocities{Eigen::Vector2d::Zero(), Eigen::Vector2d::Zero()};
  /// Slip of a sticking contact since it has stuck, m: rounding and what forces still change.
  Eigen::Vector2d crept = Eigen::Vector2d::Zero();

  // Scratch of one step.
  bool seeks_gap_ahead = false;  ///< at t_{n+1}, besides the slip; only where predicts_ahead

  // Of bodies at rest and the step.
  bool is_soft = false;    ///< on a spring that a step resolves
  double mobility = 0.0;   ///< displacement along a tangent in the next step per force, m/N

  const ContactPoint& point() const { return kinematics.point(); }
  /// Friction as a vector, along the circumference and along the radius.
  Eigen::Vector2d whole_friction() const { return {friction_force, friction_across}; }
  double rise_at(double time) const {
    return time < constant_from ? point().friction_rise.value(time) : rise;
  }
  /// Whether its spring has let the slave through the middle of the plate, of which it says nothing.
  bool is_through() const {
    const double half_thickness = point().face->half_thickness;
    return half_thickness > 0.0 && force * point().compliance() > half_thickness;
  }
  /// Half of what the mean velocity has changed by from step to step: with it that of a step becomes
  /// that at its end. Where sliding ends or turns round, by more than half, it is left out.
  Eigen::Vector2d half_change() const;

  /// Its state as numbers.
  using Numbers = std::array<double, 2 * num_face_ports + 16>;
  Numbers numbers() const;
  void restore(const Numbers& numbers);
};

/// The contacts on faces of a simulation, with their problems (docs/theory.md, 10.6).
class RunningFaces {
 public:
  /// What a step is made with.
  struct Instant {
    double now = 0.0;     ///< t_n
    double sought = 0.0;  ///< when the conditions of contact are to hold
    double step = 0.0;    ///< h
    bool has_feedthrough = false;  ///< sought at t_n, where bodies respond at once
  };

  bool empty() const { return faces_.empty(); }
  std::size_t size() const { return faces_.size(); }
  RunningFace& operator[](std::size_t i) { return faces_[i]; }
  const RunningFace& operator[](std::size_t i) const { return faces_[i]; }
  std::vector<PlanarProblem>& problems() { return problems_; }

  void add(const ContactPoint& point, Propagator& slave, Propagator& master, int slave_port,
           int master_port);
  /// Takes the answers of the bodies to forces, once they are known.
  void find_answers(double step);
  /// At the start, from the initial motion of the bodies.
  /// @param at as of pose()
  void stand(const System& system, const Instant& at);
  /// Poses the problems for the forces at t_n.
  void pose(const Instant& at);
  /// Whether a contact is to be solved at t_{n+1}: as those with one tangent, where friction could
  /// change more than a quarter of the sliding velocity within a step, and where it sticks while springs
  /// hold the gaps. The gap of one on a spring that a step resolves stays that of t_n: so it rebounds as
  /// the spring does.
  bool is_unsteady(std::size_t i) const;
  bool has_changed(std::size_t i) const;
  /// Poses one anew, with gap and slip at t_{n+1} under forces that are constant from t_n on.
  void pose_ahead(std::size_t i, const Instant& at);
  /// Counts steps without a change, once the forces are known.
  void count_steady();
  /// Fills the rows and columns of the contacts on faces.
  /// @param lines       blocks of the contacts with one tangent, master and slave of each
  /// @param predicts_ahead of these contacts
  void fill(ContactSolver& solver, std::span<const std::array<PortBlock, 2>> lines,
            std::span<const char> predicts_ahead) const;
  /// Takes up the forces found.
  void take();
  /// Takes the motion once it is known whole up to an instant.
  void follow(double step);

 private:
  bool is_settling(std::size_t i) const;
  /// Rows and columns of a contact against those with one tangent.
  void fill_with_lines(std::size_t face, ContactSolver& solver,
                       std::span<const std::array<PortBlock, 2>> lines,
                       std::span<const char> predicts_ahead) const;
  void set_coefficients(RunningFace& face, PlanarProblem& problem, double rise) const;

  std::vector<RunningFace> faces_;
  std::vector<PlanarProblem> problems_;
  FaceCompliances compliances_;
  double step_ = 0.0;
};

}  // namespace stridor
