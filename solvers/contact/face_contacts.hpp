// Contacts with two tangents while the bodies move: on faces, rigid planes and facets.
#pragma once

#include <array>
#include <memory>
#include <optional>
#include <span>
#include <utility>
#include <vector>

#include "solvers/contact/contact_record.hpp"
#include "solvers/contact/face_compliance.hpp"
#include "solvers/contact/face_point.hpp"
#include "solvers/contact/port_block.hpp"

namespace stridor {

/// A contact with two tangents while it runs.
struct RunningFace : ContactRecord {
  explicit RunningFace(std::unique_ptr<FacePoint> on_face) : kinematics(std::move(on_face)) {}

  std::unique_ptr<FacePoint> kinematics;
  int master = 0;  ///< body that it touches

  // State.
  double friction_across = 0.0;  ///< friction along the second tangent
  ContactState last_state = ContactState::open;
  /// Mean velocities of the last two steps, the latest first, m/s.
  std::array<Eigen::Vector2d, 2> velocities{Eigen::Vector2d::Zero(), Eigen::Vector2d::Zero()};
  /// Slip of a sticking contact since it has stuck, m: rounding and what forces still change.
  Eigen::Vector2d crept = Eigen::Vector2d::Zero();

  // Scratch of one step.
  bool seeks_gap_ahead = false;  ///< at t_{n+1}, besides the slip; only where predicts_ahead

  // Of bodies at rest and the step.
  bool is_soft = false;    ///< on a spring that a step resolves
  double mobility = 0.0;   ///< displacement along a tangent in the next step per force, m/N
  int answers_on = 0;      ///< facet to which these belong

  const ContactPoint& point() const { return kinematics->point(); }
  /// Friction as a vector, along both tangents.
  Eigen::Vector2d whole_friction() const { return {friction_force, friction_across}; }
  double rise_at(double time) const {
    return time < constant_from ? point().friction_rise.value(time) : rise;
  }
  /// Whether its spring has let the slave through the middle of the plate, of which it says nothing.
  bool is_through() const {
    const double half_thickness = point().face ? point().face->half_thickness : 0.0;
    return half_thickness > 0.0 && force * point().compliance() > half_thickness;
  }
  /// Half of what the mean velocity has changed by from step to step: with it that of a step becomes
  /// that at its end. Where sliding ends or turns round, by more than half, it is left out.
  Eigen::Vector2d half_change() const;

  /// Its state as numbers, of which there are as many as before.
  std::vector<double> numbers() const;
  void restore(std::span<const double> numbers);
};

/// The contacts with two tangents of a simulation, with their problems (docs/theory.md, 10.6).
class RunningFaces {
 public:
  using Instant = FaceInstant;

  bool empty() const { return faces_.empty(); }
  std::size_t size() const { return faces_.size(); }
  RunningFace& operator[](std::size_t i) { return faces_[i]; }
  const RunningFace& operator[](std::size_t i) const { return faces_[i]; }
  std::vector<PlanarProblem>& problems() { return problems_; }

  /// Puts the next contact.
  void add(std::unique_ptr<FacePoint> point, Propagator& slave, Propagator& master);
  /// Takes the answers of the bodies to forces, once they are known.
  void find_answers(double step);
  /// The same of contacts that have come to another facet.
  void find_answers_on_new_facets(double step);
  /// At the start, from the initial motion of the bodies.
  /// @param at as of pose()
  /// @returns the contact whose slave is beside its master, if any
  std::optional<std::size_t> stand(const System& system, const Instant& at);
  /// Poses the problems for the forces at t_n. @returns the contact whose slave has left its master, if any
  std::optional<std::size_t> pose(const Instant& at);
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
            std::span<const char> predicts_ahead);
  /// Takes up the forces found.
  void take();
  /// Takes the motion once it is known whole at t_n.
  void follow(const Instant& at);

 private:
  void find_answers(RunningFace& face, double step) const;
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
