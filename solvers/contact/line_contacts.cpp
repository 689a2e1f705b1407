#include "solvers/contact/line_contacts.hpp"

namespace stridor {
namespace {

/// A contact is steady after this many steps without a change: by then the transient of the forces
/// after the change has decayed to a hundredth or less (docs/theory.md, 3.5).
constexpr int steady_line_after = 6;

}  // namespace

void RunningLine::stand(const StepClock& clock) {
  sliding.stand(driven_now(clock));
  anchor = sliding.place();
  update_slip_velocity(driven.velocity(clock.now()), clock.step);
}

RunningLine::Numbers RunningLine::numbers() const {
  const Projection& p = sliding.projection();
  return {static_cast<double>(sliding.segment()),
          p.xi,
          p.tangent.x(),
          p.tangent.y(),
          force,
          friction_force,
          static_cast<double>(state),
          slip_velocity,
          anchor,
          static_cast<double>(steady_steps),
          static_cast<double>(violations.negative_force),
          static_cast<double>(violations.reversed_sliding),
          static_cast<double>(violations.before_armed),
          violations.last_time};
}

void RunningLine::restore(const Numbers& numbers) {
  const auto count = [&](std::size_t k) { return static_cast<std::int64_t>(numbers[k]); };
  sliding.restore(static_cast<int>(numbers[0]), numbers[1], {numbers[2], numbers[3]});
  force = numbers[4];
  friction_force = numbers[5];
  state = static_cast<ContactState>(count(6));
  slip_velocity = numbers[7];
  anchor = numbers[8];
  steady_steps = static_cast<int>(numbers[9]);
  violations = {count(10), count(11), count(12), numbers[13]};
}

void RunningLines::pose_slip(RunningLine& line, LocalProblem& problem, const StepClock& clock,
                             double rise) {
  const SlidingPoint& sliding = line.sliding;
  problem.is_unilateral = clock.now() >= line.unilateral_from;
  line.predicts_ahead = false;
  line.stretch = sliding.stretch();
  problem.last_slip = line.slip_velocity;
  problem.step = clock.step;
  if (line.point().friction.is_regularised()) {
    problem.creep = &line.point().friction;
    problem.friction_factor = rise;
  }
  if (const auto& substrate = line.point().substrate) {
    problem.substrate = &*substrate;
    problem.indentation = -sliding.present_place(line.driven_now(clock)).gap;
  }
  if (line.driven.is_frozen() && clock.sought_index() > 0) {
    // Held in place, the material of the master slides away below.
    line.anchor -= sliding.along_tangent(line.drawn_in_step(clock, clock.sought_index() - 1));
  }
  problem.slip = (sliding.place() - line.anchor) * line.stretch;
  if (clock.has_feedthrough) problem.slip += sliding.predicted_slip();
  set_sticking_friction(line, problem, rise);
}

void RunningLines::set_sticking_friction(const RunningLine& line, LocalProblem& problem,
                                         double rise) {
  // A contact that stuck is held by the static limit; one whose sliding would turn round in this
  // step passes through rest on the way.
  const bool may_rest =
      line.state == ContactState::stick || problem.slip * problem.direction <= 0.0;
  // Never below the friction of sliding, or that would turn the sliding round and drive it.
  problem.sticking_friction = problem.sliding_friction;
  if (may_rest) {
    problem.sticking_friction =
        std::max(problem.sticking_friction, rise * line.point().friction.static_coefficient);
  }
}

void RunningLines::pose_ahead(std::size_t i, const StepClock& clock, double sought_time) {
  RunningLine& line = lines_[i];
  LocalProblem& problem = problems_[i];
  line.predicts_ahead = true;
  const SlidingPoint& sliding = line.sliding;
  // A sticking contact keeps its material point, another one that of t_n, where the step begins.
  if (line.state != ContactState::stick) line.anchor = sliding.place();
  const double drawn = line.drawn_in_step(clock, clock.index);
  problem.penetration =
      sliding.roughness() - sliding.gap_ahead(line.driven.displacement(sought_time),
                                              line.driven.is_frozen() ? 0.0 : drawn);
  problem.slip = (sliding.place() - line.anchor) * line.stretch + sliding.slip_ahead(drawn);
  set_sticking_friction(line, problem, line.rise_at(sought_time));
}

bool RunningLines::is_unsteady(std::size_t i) const {
  return problems_[i].is_unilateral && lines_[i].steady_steps < steady_line_after;
}

bool RunningLines::has_changed(std::size_t i) const {
  return problems_[i].state != lines_[i].state ||
         (problems_[i].state == ContactState::slip &&
          problems_[i].tangential * lines_[i].friction_force < 0.0);
}

void RunningLines::count_steady() {
  for (std::size_t i = 0; i < lines_.size(); ++i) {
    int& steady = lines_[i].steady_steps;
    if (problems_[i].state == ContactState::open || (lines_[i].predicts_ahead && has_changed(i))) {
      steady = 0;
    } else if (steady < steady_line_after) {
      ++steady;
    }
  }
}

void RunningLines::move_anchor(std::size_t i, ContactSolver& solver) {
  RunningLine& line = lines_[i];
  // Where the problem was that of t_{n+1} it stays that of t_n.
  if (line.state == ContactState::stick || line.predicts_ahead) return;
  double slip = problems_[i].slip;
  const auto row = static_cast<Eigen::Index>(2 * i + 1);
  for (std::size_t j = 0; j < lines_.size(); ++j) {
    const auto column = static_cast<Eigen::Index>(2 * j);
    slip -= solver.delassus()(row, column) * problems_[j].normal +
            solver.delassus()(row, column + 1) * problems_[j].tangential;
  }
  line.anchor += slip / line.stretch;
}

}  // namespace stridor
