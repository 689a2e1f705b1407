// The part of a step that contacts take which do not slide for good: stick and lift-off, force laws,
// two tangents, and the look ahead of unsteady ones.
#include <algorithm>

#include "solvers/transient/simulation_implementation.hpp"

namespace stridor {

StepOutcome Simulation::Implementation::follow_slip(RunningLine& contact, std::size_t i) {
  const LocalProblem& problem = lines.problems()[i];
  const bool has_law = problem.substrate != nullptr;
  const StepOutcome outcome = has_law ? check_penetration(contact, i) : StepOutcome::done;
  if (outcome == StepOutcome::done) lines.move_anchor(i, solver);
  if (problem.is_unilateral) note_unilateral(contact);
  return outcome;
}

StepOutcome Simulation::Implementation::check_penetration(RunningLine& contact, std::size_t i) {
  const LocalProblem& problem = lines.problems()[i];
  const auto row = static_cast<Eigen::Index>(2 * i);
  const double compliance = solver.delassus()(row, row);
  contact.indentation = problem.indentation;
  contact.stiffness_in_step = problem.stiffness * compliance;
  if (problem.substrate->is_sunk(problem.indentation)) return fail(contact, StepOutcome::sunk);
  if (overshoots(problem.stiffness, compliance)) return fail(contact, StepOutcome::overshot);
  return StepOutcome::done;
}

StepOutcome Simulation::Implementation::pose_faces(double sought_time) {
  if (clock.is_fed_through()) find_answers_of_faces();
  const auto lost = faces.pose(clock.instant(sought_time));
  fit_forces();
  return lost ? fail(faces[*lost], StepOutcome::master_lost) : StepOutcome::done;
}

void Simulation::Implementation::find_answers_of_faces() {
  bool has_any_changed = false;
  for (const auto& body : bodies) has_any_changed |= body->find_ahead_compliances();
  if (has_any_changed) {
    faces.find_answers(clock.step);
  } else {
    faces.find_answers_on_new_facets(clock.step);
  }
}

void Simulation::Implementation::clear_forces() {
  for (std::vector<double>& of_body : forces) std::fill(of_body.begin(), of_body.end(), 0.0);
}

StepOutcome Simulation::Implementation::take_faces() {
  StepOutcome outcome = StepOutcome::done;
  faces.take();
  for (std::size_t i = 0; i < faces.size(); ++i) {
    RunningFace& face = faces[i];
    if (!(std::abs(face.force) < absurd_force)) return fail(face, StepOutcome::diverged);
    if (face.is_through()) return fail(face, StepOutcome::sunk);
    const bool is_unilateral = faces.problems()[i].is_unilateral;
    if (is_unilateral) note_unilateral(face);
    if (face.force < 0.0 && !is_unilateral && !tolerate(face, face.violations.negative_force))
      outcome = fail(face, StepOutcome::pulling);
    face.kinematics->apply(face.force, face.whole_friction(),
                           forces_on(face.point().slave_body).data(),
                           forces_on(face.master).data());
  }
  return outcome;
}

bool Simulation::Implementation::follow_faces(double now) {
  bool is_allowed = true;
  faces.follow({now, now, clock.step, clock.is_fed_through()});
  for (std::size_t i = 0; i < faces.size(); ++i) {
    RunningFace& face = faces[i];
    if (face.velocities[0].dot(face.kinematics->drawn_velocity(now)) >= 0.0 ||
        clock.now() >= face.unilateral_from || tolerate(face, face.violations.reversed_sliding))
      continue;
    fail(face, StepOutcome::sliding_reversed);
    is_allowed = false;
  }
  return is_allowed;
}

ContactAnswer Simulation::Implementation::solve_with_faces() {
  line_blocks.clear();
  line_looks_ahead.clear();
  for (const RunningLine& contact : lines) {
    line_blocks.push_back(contact.sliding.blocks());
    line_looks_ahead.push_back(contact.predicts_ahead ? 1 : 0);
  }
  faces.fill(solver, line_blocks, line_looks_ahead);
  return solver.solve(lines.problems(), faces.problems());
}

ContactAnswer Simulation::Implementation::solve_unsteady_contacts(double sought_time) {
  bool is_ahead = false;
  const auto look_ahead_with_bodies = [&] {
    if (!is_ahead) {
      for (const auto& body : bodies) body->predict_ahead();
    }
    is_ahead = true;
  };
  const auto look_ahead_on_line = [&](std::size_t i) {
    look_ahead_with_bodies();
    lines.pose_ahead(i, clock, sought_time);
  };
  const auto look_ahead_on_face = [&](std::size_t i) {
    look_ahead_with_bodies();
    faces.pose_ahead(i, clock.instant(sought_time));
  };
  for (std::size_t i = 0; i < lines.size(); ++i) {
    if (lines.is_unsteady(i)) look_ahead_on_line(i);
  }
  for (std::size_t i = 0; i < faces.size(); ++i) {
    if (faces.is_unsteady(i)) look_ahead_on_face(i);
  }
  ContactAnswer answer = solve_posed();
  bool has_any_changed = false;
  for (std::size_t i = 0; i < faces.size(); ++i) {
    if (!faces.problems()[i].is_unilateral || faces[i].predicts_ahead || !faces.has_changed(i))
      continue;
    faces[i].steady_steps = 0;
    look_ahead_on_face(i);
    has_any_changed = true;
  }
  for (std::size_t i = 0; i < lines.size(); ++i) {
    if (!lines.problems()[i].is_unilateral || lines[i].predicts_ahead || !lines.has_changed(i))
      continue;
    lines[i].steady_steps = 0;
    look_ahead_on_line(i);
    has_any_changed = true;
  }
  if (has_any_changed) answer = solve_posed();
  faces.count_steady();
  lines.count_steady();
  return answer;
}

StepOutcome Simulation::Implementation::fail_unsolved(const ContactAnswer& answer) {
  const StepOutcome outcome =
      answer.status == ContactStatus::jammed ? StepOutcome::jammed : StepOutcome::not_converged;
  const auto fail_with = [&](auto& contact, const auto& problem) {
    contact.force = problem.normal;
    if (std::isfinite(problem.penetration)) return fail(contact, outcome);
    contact.force = problem.penetration;
    return fail(contact, StepOutcome::diverged);
  };
  const auto i = static_cast<std::size_t>(answer.contact);
  if (i >= lines.size())
    return fail_with(faces[i - lines.size()], faces.problems()[i - lines.size()]);
  lines[i].friction = lines.problems()[i].sliding_friction;
  return fail_with(lines[i], lines.problems()[i]);
}

}  // namespace stridor
