// The beam-on-beam system of the main scene, built without a scene file.
#pragma once

#include "models/model.hpp"
#include "solvers/transient/simulation.hpp"
#include "tests/support/paper_beams.hpp"

namespace stridor::test {

inline constexpr double paper_load = 0.20;      ///< |F_y| of the paper, N
inline constexpr double paper_friction = 0.30;  ///< μ of the paper

inline ModelParameters paper_model(double angle = trailing_angle,
                                   ContactAssumption assumption = ContactAssumption::subs_b) {
  ModelParameters model;
  model.substructures["oblique"] = paper_oblique(angle);
  model.substructures["cantilever"] = paper_cantilever();
  ContactParameters contact;
  contact.slave = {"oblique.tip"};
  contact.master = "cantilever.top";
  contact.assumption = assumption;
  contact.start = 0.030;
  contact.friction.emplace().numbers["coefficient"] = paper_friction;
  model.contact = contact;
  model.drive.emplace().velocity = TimeCurve(0.030);
  model.drive->load = TimeCurve(-paper_load);
  model.drive->ramp = 0.1;
  return model;
}

inline const PointName free_end{"cantilever", "free_end"};

inline Model make_paper_model(const ModelParameters& parameters) {
  return make_model(parameters, {{free_end, "record.channels.0"}});
}

/// The system of the paper; built once for each angle.
inline System paper_system_at(double angle,
                              ContactAssumption assumption = ContactAssumption::subs_b) {
  static const System trailing = make_paper_model(paper_model(trailing_angle)).system;
  static const System leading = make_paper_model(paper_model(leading_angle)).system;
  System system = angle == trailing_angle ? trailing : leading;
  system.contacts[0].assumption = assumption;
  return system;
}

inline TimeParameters paper_time(double step = 2.0e-7,
                                 Coordinates coordinates = Coordinates::modal) {
  TimeParameters time;
  time.coordinates = coordinates;
  time.step = step;
  time.end = 2.25;
  return time;
}

}  // namespace stridor::test
