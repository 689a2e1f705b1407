#include "models/mode_shape.hpp"

#include <fmt/format.h>

#include <stdexcept>

#include "substructures/reduction/interface_modes.hpp"

namespace stridor {
namespace {

/// Into the frame of space: y of the frame of a body on the lower face of a plate points down.
template <class Vectors>
void mirror(bool is_mirrored, Vectors& vectors) {
  if (is_mirrored) vectors.col(1) *= -1.0;
}

/// From the unrolled frame of a plate into space.
void roll(const FaceSeat& seat, BodyShape& shape) {
  for (Eigen::Index node = 0; node < shape.nodes.rows(); ++node) {
    const Eigen::Vector3d unrolled = shape.nodes.row(node).transpose();
    const Eigen::Vector3cd displacement = shape.displacement.row(node).transpose();
    shape.displacement.row(node) =
        (seat.directions(unrolled).cast<std::complex<double>>() * displacement).transpose();
    shape.nodes.row(node) = seat.place(unrolled).transpose();
  }
}

}  // namespace

ShapeRecovery::ShapeRecovery(const Model& model, BodyCache& cache) : model_(&model) {
  for (std::size_t b = 0; b < model.system.bodies.size(); ++b) {
    const SystemBody& body = model.system.bodies[b];
    const auto parameters = model.substructures.find(body.name);
    if (parameters == model.substructures.end()) continue;
    Part& part = parts_.emplace_back();
    part.body = b;
    part.matrices = cache.matrices(*parameters->second);
    const Model::Placement& placement = model.placements[b];
    part.recovery = in_interface_modes(
        body.reduced, recovery_matrix(part.matrices, placement.interface,
                                      body.reduced.size() - body.reduced.num_interface));
    part.rest.name = body.name;
    part.rest.nodes = node_places(part.matrices);
    part.rest.nodes.leftCols(placement.place.size()).rowwise() += placement.place.transpose();
    for (const auto& [name, nodes] : part.matrices.surfaces) part.rest.outlines.push_back(nodes);
    for (const std::vector<int>& nodes : part.matrices.outlines)
      part.rest.outlines.push_back(nodes);
    part.rest.elements = parameters->second->elements();
  }
  std::vector<double> outer_radii(model.system.bodies.size(), 0.0);
  for (const Part& part : parts_) outer_radii[part.body] = outer_radius_of_faces(part.matrices);
  const std::vector<std::optional<FaceSeat>> seats = face_seats(model.system.contacts, outer_radii);
  for (Part& part : parts_) part.seat = seats[part.body];
}

std::vector<BodyShape> ShapeRecovery::shapes(const std::vector<double>& displaced,
                                             const std::vector<Eigen::VectorXd>& still,
                                             const std::vector<Eigen::VectorXcd>& moving) const {
  const std::size_t num_bodies = model_->system.bodies.size();
  if (displaced.size() != num_bodies || still.size() != num_bodies || moving.size() != num_bodies)
    throw std::invalid_argument("ShapeRecovery: not as many motions as bodies");
  std::vector<BodyShape> shapes;
  for (const Part& part : parts_) {
    BodyShape& shape = shapes.emplace_back(part.rest);
    shape.displacement =
        node_displacements(part.matrices, part.recovery * moving[part.body]);
    shape.nodes.col(0).array() += displaced[part.body];
    if (still[part.body].size() > 0) {
      const Eigen::VectorXd dofs = part.recovery * still[part.body];
      shape.nodes += node_displacements(part.matrices, dofs.cast<std::complex<double>>()).real();
    }
    const bool is_mirrored = model_->placements[part.body].is_mirrored;
    mirror(is_mirrored, shape.nodes);
    mirror(is_mirrored, shape.displacement);
    if (part.seat) roll(*part.seat, shape);
  }
  return shapes;
}

std::vector<BodyShape> ShapeRecovery::mode(const Equilibrium& equilibrium,
                                           const Eigen::VectorXcd& mode) const {
  const System& system = model_->system;
  Eigen::Index num_modes = 0;
  for (const SystemBody& body : system.bodies) num_modes += body.modal.size();
  if (mode.size() != num_modes) {
    throw std::invalid_argument(fmt::format(
        "mode_shape: the mode has {} entries, the bodies have {} modes", mode.size(), num_modes));
  }
  std::vector<double> displaced;
  std::vector<Eigen::VectorXd> still;
  std::vector<Eigen::VectorXcd> moving;
  Eigen::Index first = 0;
  const bool is_deformed = equilibrium.state.geometry == ContactGeometry::deformed;
  for (std::size_t b = 0; b < system.bodies.size(); ++b) {
    const SystemBody& body = system.bodies[b];
    const Eigen::Index size = body.modal.size();
    moving.emplace_back(body.modal.shapes * mode.segment(first, size));
    first += size;
    displaced.push_back(body.follows_drive() ? system.path_share(static_cast<int>(b)) *
                                                   equilibrium.state.drive_displacement
                                             : 0.0);
    still.emplace_back();
    if (is_deformed && size > 0) still.back() = body.modal.shapes * equilibrium.displacement[b];
  }
  return shapes(displaced, still, moving);
}

std::vector<BodyShape> mode_shape(const Model& model, const Equilibrium& equilibrium,
                                  const Eigen::VectorXcd& mode, BodyCache& cache) {
  return ShapeRecovery(model, cache).mode(equilibrium, mode);
}

}  // namespace stridor
