#include "substructures/reduction/recovery.hpp"

#include <algorithm>
#include <numeric>

#include "substructures/reduction/craig_bampton.hpp"

namespace stridor {

Eigen::MatrixXd recovery_matrix(const BodyMatrices& body, std::span<const int> interface,
                                Eigen::Index num_modes) {
  std::vector<int> all(static_cast<std::size_t>(body.num_dofs()));
  std::iota(all.begin(), all.end(), 0);
  return make_craig_bampton(body, interface, num_modes, all).rows;
}

Eigen::MatrixX3d node_places(const BodyMatrices& body) {
  Eigen::MatrixX3d places = Eigen::MatrixX3d::Zero(body.nodes.rows(), 3);
  places.leftCols(body.nodes.cols()) = body.nodes;
  return places;
}

Eigen::MatrixX3cd node_displacements(const BodyMatrices& body, const Eigen::VectorXcd& dofs) {
  Eigen::MatrixX3cd displacements = Eigen::MatrixX3cd::Zero(body.nodes.rows(), 3);
  for (Eigen::Index node = 0; node < displacements.rows(); ++node) {
    for (Eigen::Index direction = 0; direction < 3; ++direction) {
      for (const DofWeight& dof :
           body.displacement(static_cast<int>(node), static_cast<std::size_t>(direction)))
        displacements(node, direction) += dof.weight * dofs(dof.dof);
    }
  }
  return displacements;
}

bool is_spatial(std::span<const BodyShape> bodies) {
  return std::any_of(bodies.begin(), bodies.end(), [](const BodyShape& body) {
    return (!body.elements.empty() && facts_of(body.elements.front().shape).dimension == 3) ||
           (body.nodes.col(2).array() != 0.0).any() ||
           (body.displacement.col(2).array() != 0.0).any();
  });
}

}  // namespace stridor
