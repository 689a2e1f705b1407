#include "tests/support/disc_model.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <stdexcept>
#include <utility>

#include "core/errors.hpp"
#include "tests/support/sliding_state.hpp"

namespace stridor {
namespace {

/// A row of one body on the coordinates of the whole system.
/// @param first coordinate of the body
Eigen::VectorXd padded(const Eigen::VectorXd& row, Eigen::Index first, Eigen::Index size) {
  Eigen::VectorXd whole = Eigen::VectorXd::Zero(size);
  whole.segment(first, row.size()) = row;
  return whole;
}

/// A contact point of a pad, `offset` along φ from its centre, whose directions turn with it.
FaceContact make_contact(const AnnularPlate& plate, const PadPoint& point,
                         const DiscModelParameters& parameters, int side, Eigen::Index first_pad,
                         Eigen::Index size, double offset) {
  const PadsParameters& pads = parameters.pads;
  const double turned = offset / pads.radius;
  const double cosine = std::cos(turned);
  const double sine = std::sin(turned);
  FaceContact contact;
  contact.plate = plate.rows(pads.radius, pads.angle + turned);
  for (Eigen::VectorXd* row : {&contact.plate.w, &contact.plate.w_r, &contact.plate.w_phi,
                               &contact.plate.w_r_phi, &contact.plate.w_phi_phi})
    *row = padded(*row, 0, size);
  contact.pad_r = padded(cosine * point.radial + sine * point.circumferential, first_pad, size);
  contact.pad_phi = padded(cosine * point.circumferential - sine * point.radial, first_pad, size);
  contact.pad_z = padded(side * point.normal, first_pad, size);
  contact.radius = pads.radius;
  contact.half_thickness = 0.5 * parameters.disc.plate.thickness;
  contact.side = side;
  return contact;
}

/// Bodies without contact.
LinearSystem free_bodies(const AnnularPlate& plate, const PadBody& pad,
                         const DiscModelParameters& parameters, const DiscTerms& terms) {
  const Eigen::Index n = plate.size();
  const Eigen::Index size = n + 2 * pad.size();
  const double speed = parameters.disc.speed;
  const Eigen::MatrixXd spin = plate.spin();
  const Eigen::MatrixXd elastic = plate.omega().array().square().matrix().asDiagonal();
  LinearSystem system;
  system.mass = Eigen::MatrixXd::Identity(size, size);
  system.velocity = Eigen::MatrixXd::Zero(size, size);
  system.position = Eigen::MatrixXd::Zero(size, size);
  system.position.topLeftCorner(n, n) = elastic;
  if (terms.gyroscopic) {
    system.velocity.topLeftCorner(n, n) = 2.0 * speed * spin;
    system.position.topLeftCorner(n, n) -= speed * speed * spin.transpose() * spin;
  }
  if (terms.structural_damping) {
    const MaterialDamping& damping = parameters.disc.damping;
    const Eigen::MatrixXd C =
        damping.alpha * Eigen::MatrixXd::Identity(n, n) + damping.beta * elastic;
    system.velocity.topLeftCorner(n, n) += C;
    if (terms.gyroscopic) system.position.topLeftCorner(n, n) += speed * C * spin;
  }
  for (const Eigen::Index first : {n, n + pad.size()}) {
    system.mass.block(first, first, pad.size(), pad.size()) = pad.mass;
    system.position.block(first, first, pad.size(), pad.size()) = pad.stiffness;
    if (terms.structural_damping) {
      const MaterialDamping& damping = parameters.pads.damping;
      system.velocity.block(first, first, pad.size(), pad.size()) =
          damping.alpha * pad.mass + damping.beta * pad.stiffness;
    }
  }
  return system;
}

FaceContactLaw law_of(const DiscModelParameters& parameters, const DiscTerms& terms) {
  FaceContactLaw law;
  law.friction = terms.friction ? parameters.contact.friction.coefficient : 0.0;
  if (parameters.contact.formulation == ContactFormulation::penalty)
    law.penalty = parameters.contact.penalty;
  law.speed = parameters.disc.speed;
  law.friction_turns = terms.friction_damping;
  law.forces_bend = terms.geometric;
  return law;
}

/// Generalised forces of the pistons behind both pads.
Eigen::VectorXd piston_loads(const PistonParameters& piston, const PadBody& pad, Eigen::Index first,
                             Eigen::Index size) {
  const Eigen::VectorXd on_pad =
      piston.force ? *piston.force * pad.pushed : *piston.displacement * pad.advanced;
  return padded(on_pad, first, size) + padded(on_pad, first + pad.size(), size);
}

/// @throws NumericalError if there is none
FaceSlidingState sliding_state_of(const DiscModel& model, const Eigen::VectorXd& loads) {
  SlidingStateSolution found = solve_sliding_state(model.bodies, model.contacts, model.law, loads);
  if (!found.has_converged) {
    throw NumericalError(
        Refusal::diverged,
        "disc: found no state in which it slides steadily between the pads; friction may draw them "
        "in without bound, as where it times pads.stiffness.coupling exceeds "
        "pads.stiffness.circumferential");
  }
  return std::move(found.state);
}

void check(const DiscModelParameters& parameters, const DiscTerms& terms) {
  const AnnularPlateParameters& plate = parameters.disc.plate;
  const double radius = parameters.pads.radius;
  if (!(radius > plate.inner_radius && radius < plate.outer_radius)) {
    throw std::invalid_argument(
        fmt::format("disc: pads at a radius of {:g} m are off the disc", radius));
  }
  if (parameters.pads.mass.has_value() == parameters.pads.elastic.has_value())
    throw std::invalid_argument("disc: pads have either a mass or an elastic body");
  if (parameters.contact.preload.has_value() == parameters.pads.piston.has_value())
    throw std::invalid_argument("disc: contacts have either a preload or pads with a piston");
  if (parameters.contact.formulation == ContactFormulation::penalty && !parameters.contact.penalty)
    throw std::invalid_argument("disc: the penalty formulation needs a penalty");
  if (terms.friction_damping && !(parameters.disc.speed > 0.0))
    throw std::invalid_argument("disc: friction damping is infinite at no speed");
}

}  // namespace

PadBody make_pad(const PadsParameters& pads, const std::vector<double>& offsets) {
  return pads.elastic ? make_elastic_pad(*pads.elastic, pads.stiffness, offsets)
                      : make_rigid_pad(*pads.mass, pads.stiffness, offsets.size());
}

DiscModel make_disc_model(const DiscModelParameters& parameters) {
  const DiscTerms terms = disc_terms(parameters.terms);
  check(parameters, terms);
  const AnnularPlate plate(parameters.disc.plate,
                           parameters.disc.centrifugal ? parameters.disc.speed : 0.0);
  const std::vector<double> offsets = contact_offsets(parameters);
  const PadBody pad = make_pad(parameters.pads, offsets);
  DiscModel model;
  model.highest_frequency =
      std::min(plate.lowest_omitted(), 0.5 * pad.highest_kept) / (2.0 * std::numbers::pi);
  model.bodies = free_bodies(plate, pad, parameters, terms);
  model.law = law_of(parameters, terms);
  const Eigen::Index size = model.bodies.size();
  for (const int side : {1, -1}) {
    const Eigen::Index first = plate.size() + (side > 0 ? 0 : pad.size());
    for (std::size_t i = 0; i < offsets.size(); ++i) {
      model.contacts.push_back(
          make_contact(plate, pad.points[i], parameters, side, first, size, offsets[i]));
    }
  }
  const std::optional<double>& preload = parameters.contact.preload;
  model.state =
      preload
          ? prescribed_sliding_state(model.contacts, model.law,
                                     *preload / static_cast<double>(offsets.size()))
          : sliding_state_of(model, piston_loads(*parameters.pads.piston, pad, plate.size(), size));
  model.system = linearise(model.bodies, model.contacts, model.law, model.state);
  return model;
}

}  // namespace stridor
