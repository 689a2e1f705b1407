// A disc between pads as an ordinary system: bodies and contacts on faces.
#pragma once

#include <fmt/format.h>

#include <vector>

#include "coupling/kinematics/face_kinematics.hpp"
#include "coupling/system/system.hpp"
#include "solvers/equilibrium/equilibrium.hpp"
#include "tests/support/disc_model.hpp"

namespace stridor::test {

inline SystemBody face_body(const char* name, ReducedBody reduced) {
  SystemBody body;
  body.name = name;
  body.modal = make_modal(reduced);
  body.reduced = std::move(reduced);
  return body;
}

/// The plate in space, with five rows for every place.
inline SystemBody spinning_plate(const DiscModelParameters& parameters,
                                 const std::vector<double>& angles) {
  const DiscTerms terms = disc_terms(parameters.terms);
  const double speed = parameters.disc.speed;
  const AnnularPlate plate(parameters.disc.plate, parameters.disc.centrifugal ? speed : 0.0);
  const Eigen::Index n = plate.size();
  const Eigen::MatrixXd spin = plate.spin();
  const Eigen::MatrixXd elastic = plate.omega().array().square().matrix().asDiagonal();
  ReducedBody body;
  body.mass = Eigen::MatrixXd::Identity(n, n);
  body.stiffness = elastic;
  if (terms.gyroscopic) {
    body.stiffness -= speed * speed * spin.transpose() * spin;
    body.coupled = {2.0 * speed * spin, Eigen::MatrixXd::Zero(n, n)};
  }
  if (terms.structural_damping) {
    const MaterialDamping& damping = parameters.disc.damping;
    body.damping.alpha = damping.alpha;
    body.damping.beta = damping.beta;
    if (terms.gyroscopic) {
      const Eigen::MatrixXd C =
          damping.alpha * Eigen::MatrixXd::Identity(n, n) + damping.beta * elastic;
      body.coupled.velocity += damping.beta * (elastic - body.stiffness);
      body.coupled.position += speed * C * spin;
    }
  }
  body.rows.resize(num_face_rows * static_cast<Eigen::Index>(angles.size()), n);
  Eigen::Index row = 0;
  for (const double angle : angles) {
    const PlateRows rows = plate.rows(parameters.pads.radius, angle);
    body.rows.middleRows<num_face_rows>(row) << rows.w.transpose(), rows.w_r.transpose(),
        rows.w_phi.transpose(), rows.w_r_phi.transpose(), rows.w_phi_phi.transpose();
    row += num_face_rows;
  }
  return face_body("disc", body);
}

inline SystemBody pad_of(const DiscModelParameters& parameters, const PadBody& pad,
                         const char* name) {
  ReducedBody body;
  body.mass = pad.mass;
  body.stiffness = pad.stiffness;
  if (disc_terms(parameters.terms).structural_damping) {
    body.damping.alpha = parameters.pads.damping.alpha;
    body.damping.beta = parameters.pads.damping.beta;
  }
  body.rows.resize(3 * static_cast<Eigen::Index>(pad.points.size()), pad.size());
  Eigen::Index row = 0;
  for (const PadPoint& point : pad.points) {
    body.rows.middleRows<3>(row) << point.circumferential.transpose(), point.normal.transpose(),
        point.radial.transpose();
    row += 3;
  }
  SystemBody made = face_body(name, body);
  if (const auto& piston = parameters.pads.piston) {
    made.held_load =
        piston->force ? *piston->force * pad.pushed : *piston->displacement * pad.advanced;
  }
  return made;
}

/// Adds to what bodies hold the negative of the forces of a contact in steady sliding about
/// undeformed bodies.
inline void hold_preload(System& system, const ContactPoint& contact, double force, double friction) {
  const FaceKinematics face = make_face_kinematics(*contact.face);
  const FacePorts unit = face.normal + friction * face.along;
  const auto add = [&](int index, int row, double value) {
    SystemBody& body = system.bodies[static_cast<std::size_t>(index)];
    if (body.held_load.size() == 0) body.held_load = Eigen::VectorXd::Zero(body.reduced.size());
    body.held_load -= value * body.reduced.rows.row(row).transpose();
  };
  for (int k = 0; k < num_face_rows; ++k)
    add(contact.face->body, contact.face->rows[static_cast<std::size_t>(k)], force * unit(k));
  add(contact.slave_body, contact.slave_rows.x, force * unit(num_face_rows));
  add(contact.slave_body, contact.slave_rows.y, force * unit(num_face_rows + 1));
  add(contact.slave_body, contact.slave_rows.z, force * unit(num_face_rows + 2));
}

/// The disc of a scene with its pads: contacts that stick, slip and lift off, or slide for good.
inline System disc_system(const DiscModelParameters& parameters,
                          ContactAssumption assumption = ContactAssumption::film) {
  const std::vector<double> offsets = contact_offsets(parameters);
  const PadBody pad = make_pad(parameters.pads, offsets);
  System system;
  std::vector<double> angles;
  for (const double offset : offsets)
    angles.push_back(parameters.pads.angle + offset / parameters.pads.radius);
  system.bodies = {spinning_plate(parameters, angles), pad_of(parameters, pad, "upper"),
                   pad_of(parameters, pad, "lower")};
  for (const int side : {1, -1}) {
    for (std::size_t i = 0; i < offsets.size(); ++i) {
      const int row = static_cast<int>(i);
      ContactPoint contact;
      contact.name = fmt::format("{}[{}]", side > 0 ? "upper" : "lower", i);
      contact.slave_body = side > 0 ? 1 : 2;
      contact.slave_rows = {3 * row, 3 * row + 1, 3 * row + 2};
      contact.slave_position.setZero();
      contact.assumption = assumption;
      contact.friction = constant_friction(parameters.contact.friction.coefficient);
      if (parameters.contact.formulation == ContactFormulation::penalty)
        contact.penalty = parameters.contact.penalty;
      FacePlace& face = contact.face.emplace();
      face.name = "disc.face";
      for (int k = 0; k < num_face_rows; ++k)
        face.rows[static_cast<std::size_t>(k)] = num_face_rows * row + k;
      face.radius = parameters.pads.radius;
      face.angle = angles[i];
      face.half_thickness = 0.5 * parameters.disc.plate.thickness;
      face.side = side;
      face.spin = parameters.disc.speed;
      face.turned = offsets[i] / parameters.pads.radius;
      if (parameters.contact.preload) {
        const double force = *parameters.contact.preload / static_cast<double>(offsets.size());
        const bool has_friction = disc_terms(parameters.terms).friction;
        hold_preload(system, contact, force,
                     has_friction ? contact.friction.dynamic_coefficient : 0.0);
        contact.overlap = force * contact.compliance();
      }
      system.contacts.push_back(contact);
    }
  }
  return system;
}

/// What of a scene's terms is the contacts'.
inline LinearisationTerms face_terms(const DiscModelParameters& parameters) {
  const DiscTerms of = disc_terms(parameters.terms);
  LinearisationTerms terms;
  terms.friction = of.friction;
  terms.friction_damping = of.friction_damping;
  terms.geometric = of.geometric;
  return terms;
}

inline Equilibrium face_equilibrium(const System& system, const LinearisationTerms& terms = {}) {
  EquilibriumState state = sliding_state(system, 0.0);
  state.terms = terms;
  return find_equilibrium(system, state);
}

}  // namespace stridor::test
