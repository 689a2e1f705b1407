#include "substructures/bodies/free_motions.hpp"

#include <Eigen/Eigenvalues>
#include <Eigen/SparseCholesky>
#include <algorithm>

#include "substructures/elements/assembly.hpp"
#include "substructures/elements/mesh_surfaces.hpp"

namespace stridor {
namespace {

/// Rigid motions R that are displacements A q: those without a rest of least squares,
/// R − A (AᵀA)⁻¹ Aᵀ R.
Eigen::MatrixXd free_motions(const Mesh& mesh, const SparseMatrix& choice) {
  Eigen::MatrixXd motions = rigid_motions(mesh);
  motions.rightCols(motions.cols() - mesh.dimension()) /= extent_of(mesh);
  const SparseMatrix transposed = choice.transpose();
  const Eigen::SimplicialLDLT<SparseMatrix::Base> factor(SparseMatrix(transposed * choice));
  const Eigen::MatrixXd rest =
      motions - choice * factor.solve(Eigen::MatrixXd(transposed * motions));
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> pairs(rest.transpose() * rest);
  // One held displacement among all nodes stands out of the rounding of the sum.
  constexpr double rounding = 1e-12;
  const auto num_free =
      (pairs.eigenvalues().array() < rounding * static_cast<double>(motions.rows())).count();
  return motions * pairs.eigenvectors().leftCols(num_free);
}

}  // namespace

std::vector<int> determinate_dofs(const Mesh& mesh, const MeshConstraints& constraints) {
  Eigen::MatrixXd free = free_motions(mesh, constraints.matrix());
  std::vector<int> dofs;
  constexpr double least = 1e-6;  // below it nothing is free but rounding
  const auto hold = [&](Eigen::Index row) {
    const Eigen::RowVectorXd direction = free.row(row).normalized();
    free -= (free * direction.transpose()).eval() * direction;
  };
  // A reduction keeps the displacement on which the load of a drive acts in any case.
  if (constraints.load_dof != BodyMatrices::held) {
    const auto guided = std::find_if(
        constraints.rows.begin(), constraints.rows.end(), [&](const DofSum& row) {
          return row.size() == 1 && row.front().dof == constraints.load_dof;
        });
    const Eigen::Index row = guided - constraints.rows.begin();
    if (guided != constraints.rows.end() && free.row(row).norm() > least) hold(row);
  }
  for (Eigen::Index motion = 0; motion < free.cols(); ++motion) {
    // Pivoting: the displacement with the largest part that the ones before leave free.
    Eigen::Index best = -1;
    double largest = least;
    for (Eigen::Index row = 0; row < free.rows(); ++row) {
      const DofSum& dof = constraints.rows[static_cast<std::size_t>(row)];
      if (dof.size() != 1 || dof.front().weight != 1.0) continue;
      const double size = free.row(row).norm();
      // Of equal ones the first, whatever their rounding.
      if (size <= (1.0 + 1e-9) * largest) continue;
      best = row;
      largest = size;
    }
    if (best < 0) break;
    dofs.push_back(constraints.rows[static_cast<std::size_t>(best)].front().dof);
    hold(best);
  }
  std::sort(dofs.begin(), dofs.end());
  dofs.erase(std::unique(dofs.begin(), dofs.end()), dofs.end());
  return dofs;
}

}  // namespace stridor
