// Contacts with one tangent while the bodies move.
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <utility>
#include <vector>

#include "solvers/contact/contact_record.hpp"
#include "solvers/contact/sliding_point.hpp"
#include "solvers/contact/step_clock.hpp"

namespace stridor {

/// A contact with one tangent while it runs.
struct RunningLine : ContactRecord {
  explicit RunningLine(SlidingPoint point) : sliding(std::move(point)) {}

  SlidingPoint sliding;
  DrivenMotion driven;       ///< of the slave against the master
  bool tracks_slip = false;  ///< it is unilateral or may become so, or its friction is a function
                             ///< of the slip in the step

  // State.
  /// Place on the master, along its undeformed surface, that the slave was over at the end of the
  /// last step; the material point that a sticking contact keeps.
  double anchor = 0.0;

  // Scratch of one step.
  double indentation = 0.0;        ///< in a substrate, likewise, m
  double stiffness_in_step = 0.0;  ///< k W of a substrate, likewise
  double stretch = 1.0;            ///< SlidingPoint::stretch()

  const ContactPoint& point() const { return sliding.point(); }
  double rise_at(double time) const {
    return time < constant_from ? point().friction_rise.value(time) : rise;
  }
  /// Displacement in +x of the slave against its master by drives at t_n, m.
  double driven_now(const StepClock& clock) const { return driven.displacement(clock.now()); }
  /// Sliding distance by drives in the step from an instant on, m, frozen or not.
  double drawn_in_step(const StepClock& clock, std::int64_t from) const {
    return 0.5 * clock.step *
           (driven.velocity(clock.time(from)) + driven.velocity(clock.time(from + 1)));
  }

  /// t·(v_C − v_M) from the increments of the last step. @returns the drives' part of it
  double update_slip_velocity(double driven_velocity, double step) {
    const double drawn = sliding.along_tangent(driven_velocity);
    slip_velocity = sliding.increment() / step + drawn;
    return drawn;
  }
  /// Takes projection, material point and slip velocity from the motion at the present time.
  void stand(const StepClock& clock);

  /// Its state as numbers.
  using Numbers = std::array<double, 14>;
  Numbers numbers() const;
  void restore(const Numbers& numbers);
};

/// The contacts with one tangent of a simulation, with their problems (docs/theory.md, 2.4
/// and 3.5).
class RunningLines {
 public:
  bool empty() const { return lines_.empty(); }
  std::size_t size() const { return lines_.size(); }
  RunningLine& operator[](std::size_t i) { return lines_[i]; }
  const RunningLine& operator[](std::size_t i) const { return lines_[i]; }
  RunningLine& front() { return lines_.front(); }
  const RunningLine& front() const { return lines_.front(); }
  auto begin() { return lines_.begin(); }
  auto end() { return lines_.end(); }
  auto begin() const { return lines_.begin(); }
  auto end() const { return lines_.end(); }
  std::vector<LocalProblem>& problems() { return problems_; }

  /// Puts the next contact.
  void add(RunningLine line) {
    lines_.push_back(std::move(line));
    problems_.emplace_back();
  }

  /// Poses the problem of one contact for its forces at t_n. @returns false where it has left its
  /// master
  [[gnu::always_inline]] bool pose(std::size_t i, const StepClock& clock, double sought_time) {
    RunningLine& line = lines_[i];
    LocalProblem& problem = problems_[i];
    const double rise = line.rise_at(sought_time);
    SlidingPoint& sliding = line.sliding;
    const double driven_to = line.driven.displacement(sought_time);
    if (!sliding.find(driven_to)) return false;
    // Gap and slip are those without the contact forces; the instantaneous response to these is
    // part of the Delassus operator.
    problem.penetration = sliding.roughness() - sliding.predicted_gap(driven_to);
    problem.sliding_friction = rise * sliding_friction(line.point().friction, line.slip_velocity);
    problem.direction = line.slip_velocity < 0.0 ? -1.0 : 1.0;
    if (line.tracks_slip) pose_slip(line, problem, clock, rise);
    return true;
  }
  /// Poses one anew, with gap and slip at t_{n+1} under forces that are constant from t_n on.
  void pose_ahead(std::size_t i, const StepClock& clock, double sought_time);

  /// Whether a contact with direct feedthrough is solved at t_{n+1} (docs/theory.md, 3.5): where it
  /// is open, or has recently closed or changed between stick and slip.
  bool is_unsteady(std::size_t i) const;
  /// Whether stick, slip or the direction of the slip are others than in the step before.
  bool has_changed(std::size_t i) const;
  /// Counts steps without a change, once the forces are known.
  void count_steady();

  /// Fills the rows and columns of the contacts where none ever sticks or lifts off: the column of
  /// λ_n holds what its friction does as well.
  void fill_sliding(ContactSolver& solver) const {
    for (std::size_t i = 0; i < lines_.size(); ++i) {
      for (std::size_t j = 0; j < lines_.size(); ++j) {
        const double own = i == j ? lines_[i].compliance : 0.0;
        solver.delassus()(static_cast<Eigen::Index>(2 * i), static_cast<Eigen::Index>(2 * j)) =
            own + lines_[i].sliding.sliding_compliance(
                      lines_[j].sliding, problems_[j].direction * problems_[j].sliding_friction);
      }
    }
  }
  /// Fills them where contacts stick, lift off or have force laws.
  void fill(ContactSolver& solver) const {
    for (std::size_t i = 0; i < lines_.size(); ++i) {
      for (std::size_t j = 0; j < lines_.size(); ++j) fill(solver, i, j);
    }
  }

  /// The material point of a contact that does not stick moves with its corrected slip.
  void move_anchor(std::size_t i, ContactSolver& solver);

 private:
  /// Additional data for stick, lift-off and force laws.
  static void pose_slip(RunningLine& line, LocalProblem& problem, const StepClock& clock,
                        double rise);
  static void set_sticking_friction(const RunningLine& line, LocalProblem& problem, double rise);

  /// Rows n and t of contact i against columns n and t of contact j, with the compliance of its own
  /// spring. Forces are λ_n along the normal and λ_t against the tangent of the slave.
  void fill(ContactSolver& solver, std::size_t i, std::size_t j) const {
    const auto row = static_cast<Eigen::Index>(2 * i);
    const auto column = static_cast<Eigen::Index>(2 * j);
    Eigen::MatrixXd& delassus = solver.delassus();
    const double own = i == j ? lines_[i].compliance : 0.0;
    const SlidingPoint& sliding = lines_[i].sliding;
    const ContactCompliance w = lines_[i].predicts_ahead
                                    ? sliding.compliance_ahead(lines_[j].sliding)
                                    : sliding.compliance(lines_[j].sliding);
    delassus(row, column) = own + w.nn;
    delassus(row, column + 1) = -w.nt;
    delassus(row + 1, column) = -w.tn;
    delassus(row + 1, column + 1) = w.tt;
  }

  std::vector<RunningLine> lines_;
  std::vector<LocalProblem> problems_;
};

}  // namespace stridor
