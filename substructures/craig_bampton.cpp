#include "substructures/craig_bampton.hpp"

#include <fmt/format.h>

#include <stdexcept>

#include "substructures/lowest_modes.hpp"

namespace stridor {
namespace {

/// Where a full DoF went: interface position, or interior position.
struct Partition {
  std::vector<int> position;
  std::vector<bool> is_interface;
  int num_interior = 0;
};

Partition partition_dofs(Eigen::Index num_dofs, std::span<const int> interface) {
  Partition partition;
  partition.position.assign(static_cast<std::size_t>(num_dofs), 0);
  partition.is_interface.assign(static_cast<std::size_t>(num_dofs), false);
  int next = 0;
  for (const int dof : interface) {
    if (dof < 0 || dof >= num_dofs || partition.is_interface[static_cast<std::size_t>(dof)]) {
      throw std::invalid_argument(
          fmt::format("make_craig_bampton: interface DoF {} is out of range or doubled", dof));
    }
    partition.is_interface[static_cast<std::size_t>(dof)] = true;
    partition.position[static_cast<std::size_t>(dof)] = next++;
  }
  for (std::size_t dof = 0; dof < partition.position.size(); ++dof) {
    if (!partition.is_interface[dof]) partition.position[dof] = partition.num_interior++;
  }
  return partition;
}

struct Blocks {
  SparseMatrix ii, ib, bb;
};

Blocks split(const SparseMatrix& matrix, const Partition& partition, Eigen::Index num_interface) {
  using Triplets = std::vector<Eigen::Triplet<double>>;
  Triplets ii;
  Triplets ib;
  Triplets bb;
  ii.reserve(static_cast<std::size_t>(matrix.nonZeros()));
  for (Eigen::Index column = 0; column < matrix.outerSize(); ++column) {
    for (SparseMatrix::InnerIterator entry(matrix, column); entry; ++entry) {
      const auto row = static_cast<std::size_t>(entry.row());
      const auto col = static_cast<std::size_t>(entry.col());
      if (partition.is_interface[row] && !partition.is_interface[col]) continue;
      Triplets& target = !partition.is_interface[col] ? ii : partition.is_interface[row] ? bb : ib;
      target.emplace_back(partition.position[row], partition.position[col], entry.value());
    }
  }
  Blocks blocks;
  blocks.ii.resize(partition.num_interior, partition.num_interior);
  blocks.ib.resize(partition.num_interior, num_interface);
  blocks.bb.resize(num_interface, num_interface);
  blocks.ii.setFromTriplets(ii.begin(), ii.end());
  blocks.ib.setFromTriplets(ib.begin(), ib.end());
  blocks.bb.setFromTriplets(bb.begin(), bb.end());
  return blocks;
}

void make_symmetric(Eigen::MatrixXd& matrix) {
  matrix = (0.5 * (matrix + matrix.transpose())).eval();
}

}  // namespace

ReducedBody make_craig_bampton(const BodyMatrices& body, std::span<const int> interface,
                               Eigen::Index num_modes, std::span<const int> watched) {
  const auto nb = static_cast<Eigen::Index>(interface.size());
  const Partition partition = partition_dofs(body.num_dofs(), interface);
  if (num_modes < 0 || num_modes > partition.num_interior) {
    throw std::invalid_argument(
        fmt::format("make_craig_bampton: {} fixed-interface modes asked, {} interior DoFs",
                    num_modes, partition.num_interior));
  }
  const Blocks stiffness = split(body.stiffness, partition, nb);
  const Blocks mass = split(body.mass, partition, nb);

  const SparseCholesky factor(stiffness.ii, "the stiffness of the interior");
  const Eigen::MatrixXd psi = -factor.solve(Eigen::MatrixXd(stiffness.ib));
  const Modes modes = lowest_modes(factor, stiffness.ii, mass.ii, num_modes);
  const Eigen::MatrixXd& phi = modes.shapes;

  ReducedBody reduced;
  reduced.damping = body.damping;
  reduced.num_interface = nb;
  const Eigen::Index n = nb + num_modes;

  // K_bi Φ + Ψᵀ K_ii Φ vanishes by the definition of Ψ, and so does K_ii Ψ + K_ib.
  reduced.stiffness = Eigen::MatrixXd::Zero(n, n);
  reduced.stiffness.topLeftCorner(nb, nb) =
      Eigen::MatrixXd(stiffness.bb) + stiffness.ib.transpose() * psi;
  reduced.stiffness.diagonal().tail(num_modes) = modes.omega_squared;
  make_symmetric(reduced.stiffness);

  const Eigen::MatrixXd mass_psi = mass.ii * psi + Eigen::MatrixXd(mass.ib);
  reduced.mass.resize(n, n);
  reduced.mass.topLeftCorner(nb, nb) =
      Eigen::MatrixXd(mass.bb) + mass.ib.transpose() * psi + psi.transpose() * mass_psi;
  reduced.mass.bottomLeftCorner(num_modes, nb) = phi.transpose() * mass_psi;
  reduced.mass.topRightCorner(nb, num_modes) =
      reduced.mass.bottomLeftCorner(num_modes, nb).transpose();
  reduced.mass.bottomRightCorner(num_modes, num_modes) =
      Eigen::MatrixXd::Identity(num_modes, num_modes);
  make_symmetric(reduced.mass);

  reduced.rows = Eigen::MatrixXd::Zero(static_cast<Eigen::Index>(watched.size()), n);
  for (std::size_t r = 0; r < watched.size(); ++r) {
    if (watched[r] == BodyMatrices::held) continue;
    if (watched[r] < 0 || watched[r] >= body.num_dofs()) {
      throw std::invalid_argument(
          fmt::format("make_craig_bampton: watched DoF {} is out of range", watched[r]));
    }
    const auto dof = static_cast<std::size_t>(watched[r]);
    auto row = reduced.rows.row(static_cast<Eigen::Index>(r));
    if (partition.is_interface[dof]) {
      row(partition.position[dof]) = 1.0;
    } else {
      row << psi.row(partition.position[dof]), phi.row(partition.position[dof]);
    }
  }

  if (body.base_inertia.size() > 0) {
    Eigen::VectorXd interior(partition.num_interior);
    reduced.base_inertia.resize(n);
    for (Eigen::Index dof = 0; dof < body.num_dofs(); ++dof) {
      const auto d = static_cast<std::size_t>(dof);
      (partition.is_interface[d] ? reduced.base_inertia : interior)(partition.position[d]) =
          body.base_inertia(dof);
    }
    reduced.base_inertia.head(nb) += psi.transpose() * interior;
    reduced.base_inertia.tail(num_modes) = phi.transpose() * interior;
  }
  return reduced;
}

}  // namespace stridor
