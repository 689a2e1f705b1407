#include "solvers/transient/step_outcome.hpp"

#include <fmt/format.h>

#include <cmath>

#include "solvers/contact/face_contacts.hpp"
#include "solvers/contact/line_contacts.hpp"

namespace stridor {
namespace {

constexpr const char* persistent_sliding_remedy =
    "the assumption of persistent sliding no longer holds from here on; let the contact stick and "
    "lift off (contact.assumption: film, or contact.on_violation: unilateral), lower the friction "
    "coefficient, or raise contact.armed_from if this is start-up";

/// The failure of a contact in words, and a remedy.
struct Diagnosis {
  std::string what;
  std::string remedy;
};

/// Of a contact of any kinematics.
Diagnosis diagnosis_of(const ContactRecord& contact, StepOutcome outcome) {
  switch (outcome) {
    case StepOutcome::pulling:
      return {fmt::format("the contact force is {:.6g} N: a bilateral contact pulls where real "
                          "bodies would part",
                          contact.force),
              persistent_sliding_remedy};
    case StepOutcome::sliding_reversed:
      return {fmt::format(
                  "the sliding velocity is {:.6g} m/s, against the drive: real bodies would stick",
                  contact.slip_velocity),
              persistent_sliding_remedy};
    case StepOutcome::jammed:
      return {fmt::format(
                  "no contact force closes the gap (friction coefficient {:.4g}): the contact jams",
                  contact.friction),
              "lower the friction coefficient or change the angle of the bodies"};
    case StepOutcome::not_converged:
      return {
          fmt::format("the contact forces have not settled in the sweeps allowed (force {:.6g} N)",
                      contact.force),
          "take a smaller time.step, or let time.contact_sweeps be larger"};
    case StepOutcome::diverged:
      return {
          fmt::format("the contact force is {:.3g} N: the computation has diverged", contact.force),
          "take a smaller time.step"};
    case StepOutcome::master_lost:
    case StepOutcome::sunk:
    case StepOutcome::overshot:
    case StepOutcome::done:
      break;
  }
  return {};
}

Diagnosis diagnosis_of(const RunningLine& contact, StepOutcome outcome, double step) {
  switch (outcome) {
    case StepOutcome::master_lost: {
      const MasterSurface& surface = contact.sliding.surface();
      Diagnosis lost{
          fmt::format("the slave point has left the end of the surface {} ({:.6g} m long)",
                      surface.name, surface.arc_length.back()),
          "end the run earlier (time.end), start elsewhere (contact.start) or slide more slowly "
          "(drive.velocity)"};
      if (contact.violations.before_armed > 0) {
        lost.remedy += fmt::format(
            "; if it was thrown there, mind the {} steps without persistent sliding that were let "
            "pass before contact.armed_from: arm earlier, or take contact.assumption: film",
            contact.violations.before_armed);
      }
      return lost;
    }
    case StepOutcome::sunk:
      return {
          fmt::format(
              "it has sunk {:.4g} m into the substrate, more than its radius of {:.4g} m, where "
              "no contact law holds",
              contact.indentation, contact.point().substrate->indentation_unit),
          "take a smaller load (drive.load), a larger contact.normal.modulus or radius, or, if "
          "it did not sink under its load but came to swing so far, a smaller time.step"};
    case StepOutcome::overshot:
      return {
          fmt::format(
              "the substrate is too stiff for the step: at an indentation of {:.4g} m its force "
              "undoes {:.3g} times a change of indentation in one step, and more than 4 times "
              "makes it grow",
              contact.indentation, contact.stiffness_in_step),
          fmt::format("take a smaller time.step; about {:.1g} s resolves this contact",
                      step / std::sqrt(contact.stiffness_in_step))};
    default:
      return diagnosis_of(contact, outcome);
  }
}

Diagnosis diagnosis_of(const RunningFace& face, StepOutcome outcome) {
  if (outcome == StepOutcome::sunk) {
    return {fmt::format("it has gone {:.4g} m into {}, more than half its thickness",
                        face.force * face.point().compliance(), face.point().face->name),
            "take a smaller initial amplitude, a larger normal.stiffness or a smaller time.step"};
  }
  if (outcome == StepOutcome::master_lost) {
    return {"the slave point has left the edge of the surface",
            "end the run earlier (time.end), start elsewhere, name a larger surface as master, or "
            "slide more slowly (drive.velocity)"};
  }
  return diagnosis_of(static_cast<const ContactRecord&>(face), outcome);
}

StepFailure failure_at(const std::string& contact, const std::string& where,
                       const Diagnosis& diagnosis, StepOutcome outcome, const StepClock& clock) {
  return {fmt::format("{} at t = {:.9g} s (step {}), {}: {}. Remedy: {}.", contact, clock.now(),
                      clock.index, where, diagnosis.what, diagnosis.remedy),
          refusal_of(outcome)};
}

}  // namespace

Refusal refusal_of(StepOutcome outcome) {
  switch (outcome) {
    case StepOutcome::master_lost:
      return Refusal::left_the_surface;
    case StepOutcome::pulling:
      return Refusal::contact_pulls;
    case StepOutcome::sliding_reversed:
      return Refusal::sliding_turns;
    case StepOutcome::jammed:
      return Refusal::contact_jams;
    case StepOutcome::not_converged:
      return Refusal::no_convergence;
    case StepOutcome::sunk:
      return Refusal::indentation_too_deep;
    case StepOutcome::overshot:
      return Refusal::substrate_too_stiff;
    case StepOutcome::diverged:
    case StepOutcome::done:
      break;
  }
  return Refusal::diverged;
}

StepFailure failure_of(const RunningLine& contact, StepOutcome outcome, const StepClock& clock) {
  return failure_at(contact.point().name,
                    fmt::format("position {:.6g} m", contact.sliding.position()),
                    diagnosis_of(contact, outcome, clock.step), outcome, clock);
}

StepFailure failure_of(const RunningFace& face, StepOutcome outcome, const StepClock& clock) {
  return failure_at(face.point().name, face.kinematics->where(), diagnosis_of(face, outcome),
                    outcome, clock);
}

StepFailure divergence_of(const std::string& body, double size, const StepClock& clock) {
  return {
      fmt::format("{} at t = {:.9g} s (step {}): the sum of the squares of its displacements and "
                  "velocities is {:.3g}: the computation has diverged. Remedy: take a smaller "
                  "time.step, or check material, damping and initial state of this body.",
                  body, clock.now(), clock.index, size),
      refusal_of(StepOutcome::diverged)};
}

}  // namespace stridor
