#include "solvers/contact/face_contacts.hpp"

#include <algorithm>

namespace stridor {

Eigen::Vector2d RunningFace::half_change() const {
  constexpr double steady = 0.5;
  const Eigen::Vector2d change = velocities[0] - velocities[1];
  if (!(change.norm() <= steady * velocities[0].norm())) return Eigen::Vector2d::Zero();
  return 0.5 * change;
}

std::vector<double> RunningFace::numbers() const {
  std::vector<double> numbers{force,
                              friction_force,
                              friction_across,
                              static_cast<double>(state),
                              static_cast<double>(last_state),
                              static_cast<double>(steady_steps),
                              velocities[0].x(),
                              velocities[0].y(),
                              velocities[1].x(),
                              velocities[1].y(),
                              crept.x(),
                              crept.y(),
                              static_cast<double>(violations.negative_force),
                              static_cast<double>(violations.reversed_sliding),
                              static_cast<double>(violations.before_armed),
                              violations.last_time};
  const std::vector<double> places = kinematics->numbers();
  numbers.insert(numbers.end(), places.begin(), places.end());
  return numbers;
}

void RunningFace::restore(std::span<const double> numbers) {
  const auto count = [&](std::size_t k) { return static_cast<std::int64_t>(numbers[k]); };
  force = numbers[0];
  friction_force = numbers[1];
  friction_across = numbers[2];
  state = static_cast<ContactState>(count(3));
  last_state = static_cast<ContactState>(count(4));
  steady_steps = static_cast<int>(count(5));
  velocities = {Eigen::Vector2d(numbers[6], numbers[7]), Eigen::Vector2d(numbers[8], numbers[9])};
  slip_velocity = numbers[6];
  crept = {numbers[10], numbers[11]};
  violations = {count(12), count(13), count(14), numbers[15]};
  kinematics->restore(numbers.subspan(16));
}

void RunningFaces::add(std::unique_ptr<FacePoint> point, Propagator& slave, Propagator& master) {
  compliances_.add(slave, master, point->slave_ports(), point->master_ports());
  RunningFace face(std::move(point));
  face.begin(face.point());
  faces_.push_back(std::move(face));
  problems_.emplace_back();
}

std::optional<std::size_t> RunningFaces::stand(const System& system, const Instant& at) {
  for (std::size_t i = 0; i < faces_.size(); ++i) {
    RunningFace& face = faces_[i];
    face.forget();
    face.last_state = ContactState::open;
    face.crept.setZero();
    const std::optional<Eigen::Vector2d> velocity = face.kinematics->stand(system, at);
    if (!velocity) return i;
    face.velocities.fill(*velocity);
    face.slip_velocity = velocity->x();
  }
  return std::nullopt;
}

void RunningFaces::find_answers(double step) {
  for (RunningFace& face : faces_) find_answers(face, step);
}

void RunningFaces::find_answers_on_new_facets(double step) {
  for (RunningFace& face : faces_) {
    if (face.kinematics->facet() != face.answers_on) find_answers(face, step);
  }
}

void RunningFaces::find_answers(RunningFace& face, double step) const {
  // Where a spring and what answers at once give way to a force by less than the next step moves, an
  // impact would give back more than 4/3, or less than 3/4, of its energy (docs/theory.md, 10.6).
  constexpr double resolved = 1.0;
  const FacePoint& kinematics = *face.kinematics;
  const std::array<PortBlock, 2> blocks = kinematics.blocks(kinematics.directions_at_rest(step));
  Eigen::Matrix3d at_once = Eigen::Matrix3d::Zero();
  Eigen::Matrix3d next = Eigen::Matrix3d::Zero();
  for (const PortBlock& a : blocks) {
    for (const PortBlock& b : blocks) {
      add_compliance(a, b, false, at_once);
      add_compliance(a, b, true, next);
    }
  }
  next -= at_once;
  face.answers_on = kinematics.facet();
  face.mobility = std::max(next(1, 1), next(2, 2));
  face.is_soft = face.compliance > 0.0 &&
                 next(0, 0) <= resolved * (at_once(0, 0) + face.compliance);
}

void RunningFaces::set_coefficients(RunningFace& face, PlanarProblem& problem,
                                    double rise) const {
  const FrictionLaw& law = face.point().friction;
  problem.sliding_friction = rise * sliding_friction(law, face.velocities[0].norm());
  face.friction = problem.sliding_friction;
  problem.creep = law.is_regularised() ? &law : nullptr;
  problem.friction_factor = rise;
  problem.step = step_;
  // As with one tangent: a contact that stuck is held by the static limit, and one that passes
  // through rest; never below the friction of sliding.
  const bool may_rest =
      face.state == ContactState::stick || problem.slip.dot(face.velocities[0]) <= 0.0;
  problem.sticking_friction = problem.sliding_friction;
  if (may_rest) {
    problem.sticking_friction =
        std::max(problem.sticking_friction, rise * law.static_coefficient);
  }
}

std::optional<std::size_t> RunningFaces::pose(const Instant& at) {
  step_ = at.step;
  for (std::size_t i = 0; i < faces_.size(); ++i) {
    RunningFace& face = faces_[i];
    PlanarProblem& problem = problems_[i];
    FacePoint& kinematics = *face.kinematics;
    if (!kinematics.find(at.sought)) return i;
    face.predicts_ahead = face.seeks_gap_ahead = false;
    problem.is_unilateral = at.now >= face.unilateral_from;
    problem.penetration = -kinematics.predicted_gap();
    problem.slip = kinematics.predicted_slip(at);
    // The velocity at t_n from the mean one of the step that ends, or begins, there.
    const Eigen::Vector2d to_end = (at.has_feedthrough ? step_ : -step_) * face.half_change();
    if (face.state == ContactState::stick) problem.slip += face.crept;
    if (face.state == ContactState::slip) problem.slip += to_end;
    if (!problem.is_unilateral) {
      const Eigen::Vector2d velocity =
          at.has_feedthrough
              ? Eigen::Vector2d(kinematics.expected_slip(at) + to_end)
              : Eigen::Vector2d(face.velocities[0] + face.half_change());
      problem.direction = velocity.isZero(0.0) ? Eigen::Vector2d(1.0, 0.0) : velocity.normalized();
    }
    set_coefficients(face, problem, face.rise_at(at.sought));
    compliances_.direct(i, kinematics.directions(step_), kinematics.master_ports());
  }
  return std::nullopt;
}

bool RunningFaces::is_settling(std::size_t i) const {
  constexpr int steady_after = 6;
  return faces_[i].steady_steps < steady_after;
}

bool RunningFaces::is_unsteady(std::size_t i) const {
  const RunningFace& face = faces_[i];
  const PlanarProblem& problem = problems_[i];
  if (!problem.is_unilateral) return false;
  if (is_settling(i)) return true;
  // What answers at once need not hold tangents where springs hold the gaps (added_feedthrough()).
  if (face.state == ContactState::stick) return face.compliance > 0.0;
  if (face.state != ContactState::slip) return false;
  constexpr double share = 0.25;
  const double speed = face.velocities[0].norm();
  const double limit = problem.sticking_friction * face.force;
  return face.mobility * limit > share * speed * step_;
}

bool RunningFaces::has_changed(std::size_t i) const {
  const ContactState now = problems_[i].state;
  const ContactState before = faces_[i].state;
  if (faces_[i].is_soft) return (now == ContactState::stick) != (before == ContactState::stick);
  return now != before;
}

void RunningFaces::pose_ahead(std::size_t i, const Instant& at) {
  RunningFace& face = faces_[i];
  PlanarProblem& problem = problems_[i];
  const FacePoint& kinematics = *face.kinematics;
  face.predicts_ahead = true;
  const bool just_sticks = face.state == ContactState::stick && !is_settling(i);
  face.seeks_gap_ahead = !face.is_soft && !just_sticks;
  compliances_.seek(i, face.seeks_gap_ahead, true);
  if (face.seeks_gap_ahead) problem.penetration = -kinematics.gap_ahead(at);
  problem.slip = kinematics.slip_ahead(at);
  if (face.state == ContactState::stick)
    problem.slip += face.crept + kinematics.expected_slip(at);
  if (face.state == ContactState::slip) problem.slip -= step_ * face.half_change();
  set_coefficients(face, problem, face.rise_at(at.sought));
}

void RunningFaces::count_steady() {
  constexpr int steady_after = 6;
  for (std::size_t i = 0; i < faces_.size(); ++i) {
    RunningFace& face = faces_[i];
    const bool is_open = problems_[i].state == ContactState::open && !face.is_soft;
    if (is_open || (face.predicts_ahead && has_changed(i))) {
      face.steady_steps = 0;
    } else if (face.steady_steps < steady_after) {
      ++face.steady_steps;
    }
  }
}

void RunningFaces::fill(ContactSolver& solver, std::span<const std::array<PortBlock, 2>> lines,
                        std::span<const char> predicts_ahead) {
  const Eigen::Index first = solver.first_planar(0);
  const Eigen::Index size = solver.delassus().rows() - first;
  const bool is_new = compliances_.fill(solver.delassus().bottomRightCorner(size, size));
  for (std::size_t i = 0; i < faces_.size(); ++i) {
    const Eigen::Index row = solver.first_planar(static_cast<int>(i));
    if (is_new) solver.delassus()(row, row) += faces_[i].compliance;
    if (!lines.empty()) fill_with_lines(i, solver, lines, predicts_ahead);
  }
}

void RunningFaces::fill_with_lines(std::size_t face, ContactSolver& solver,
                                   std::span<const std::array<PortBlock, 2>> lines,
                                   std::span<const char> predicts_ahead) const {
  const RunningFace& of = faces_[face];
  const std::array<PortBlock, 2> own = of.kinematics->blocks(of.kinematics->directions(step_));
  const Eigen::Index row = solver.first_planar(static_cast<int>(face));
  const auto put = [&](const std::array<PortBlock, 2>& to, const std::array<PortBlock, 2>& from,
                       bool ahead, auto block) {
    Eigen::MatrixXd sum = Eigen::MatrixXd::Zero(to[0].width, from[0].width);
    for (const PortBlock& a : to)
      for (const PortBlock& b : from) add_compliance(a, b, ahead, sum);
    block = sum.topRows(block.rows());
  };
  for (std::size_t j = 0; j < lines.size(); ++j) {
    const Eigen::Index column = 2 * static_cast<Eigen::Index>(j);
    Eigen::MatrixXd& delassus = solver.delassus();
    put(own, lines[j], of.predicts_ahead, delassus.block(row, column, 3, 2));
    if (of.predicts_ahead && !of.seeks_gap_ahead)
      put(own, lines[j], false, delassus.block(row, column, 1, 2));
    put(lines[j], own, predicts_ahead[j] != 0, delassus.block(column, row, 2, 3));
  }
}

void RunningFaces::take() {
  for (std::size_t i = 0; i < faces_.size(); ++i) {
    RunningFace& face = faces_[i];
    face.last_state = std::exchange(face.state, problems_[i].state);
    face.force = problems_[i].normal;
    face.friction_force = problems_[i].tangential.x();
    face.friction_across = problems_[i].tangential.y();
    face.count();
  }
}

void RunningFaces::follow(const Instant& at) {
  for (RunningFace& face : faces_) {
    const Eigen::Vector2d slip = face.kinematics->follow(at);
    const bool has_stuck =
        face.state == ContactState::stick && face.last_state == ContactState::stick;
    face.crept = has_stuck ? Eigen::Vector2d(face.crept + slip) : Eigen::Vector2d::Zero();
    face.velocities = {slip / at.step, face.velocities[0]};
    face.slip_velocity = face.velocities[0].x();
  }
}

}  // namespace stridor
