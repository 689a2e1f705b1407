#include "models/mode_shape.hpp"

#include <fmt/format.h>

#include <stdexcept>


namespace stridor {
std::vector<BodyShape> mode_shape(const Model& model, const Equilibrium& equilibrium,
                                  const Eigen::VectorXcd& mode, BodyCache& cache) {
  Eigen::Index num_modes = 0;
  for (const SystemBody& body : model.system.bodies) num_modes += body.modal.size();
  if (mode.size() != num_modes) {
    throw std::invalid_argument(fmt::format(
        "mode_shape: the mode has {} entries, the bodies have {} modes", mode.size(), num_modes));
  }
  std::vector<BodyShape> shapes;
  Eigen::Index first = 0;
  for (std::size_t b = 0; b < model.system.bodies.size(); ++b) {
    const SystemBody& body = model.system.bodies[b];
    const Eigen::Index size = body.modal.size();
    const Eigen::VectorXcd part = mode.segment(first, size);
    first += size;
    const auto parameters = model.substructures.find(body.name);
    if (parameters == model.substructures.end()) continue;
    const BodyMatrices matrices = cache.matrices(*parameters->second);
    const Model::Placement& placement = model.placements[b];
    const Eigen::MatrixXd recovery = recovery_matrix(
        matrices, placement.interface, body.reduced.size() - body.reduced.num_interface);

    BodyShape shape;
    shape.name = body.name;
    shape.displacement = node_displacements(matrices, recovery * (body.modal.shapes * part));
    shape.nodes = matrices.nodes.leftCols<2>().rowwise() + placement.place.head<2>().transpose();
    if (body.follows_drive()) {
      shape.nodes.col(0).array() += model.system.path_share(static_cast<int>(b)) *
                                    equilibrium.state.drive_displacement;
    }
    if (equilibrium.state.geometry == ContactGeometry::deformed) {
      const Eigen::VectorXd static_part =
          recovery * (body.modal.shapes * equilibrium.displacement[b]);
      shape.nodes += node_displacements(matrices, static_part.cast<std::complex<double>>()).real();
    }
    if (placement.is_mirrored) {
      shape.nodes.col(1) *= -1.0;
      shape.displacement.col(1) *= -1.0;
    }
    for (const auto& [name, nodes] : matrices.surfaces) shape.outlines.push_back(nodes);
    for (const std::vector<int>& nodes : matrices.outlines) shape.outlines.push_back(nodes);
    shape.elements = parameters->second->elements();
    shapes.push_back(std::move(shape));
  }
  return shapes;
}

}  // namespace stridor
