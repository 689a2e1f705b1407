#include "substructures/reduction/craig_bampton.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <stdexcept>

#include "core/activity.hpp"
#include "core/stop_token.hpp"
#include "substructures/matrices/symmetric_eigenpairs.hpp"
#include "substructures/reduction/lowest_modes.hpp"

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
  SparseMatrix ii, ib;
  Eigen::MatrixXd bb;
};

Blocks split(const SparseMatrix& matrix, const Partition& partition,
             std::span<const int> interface) {
  const auto num_interface = static_cast<Eigen::Index>(interface.size());
  Blocks blocks{SparseMatrix(partition.num_interior, partition.num_interior),
                SparseMatrix(partition.num_interior, num_interface),
                Eigen::MatrixXd::Zero(num_interface, num_interface)};
  // Interior DoFs keep their order, so that every column arrives sorted.
  blocks.ii.reserve(matrix.nonZeros());
  for (Eigen::Index dof = 0; dof < matrix.cols(); ++dof) {
    if (partition.is_interface[static_cast<std::size_t>(dof)]) continue;
    const int column = partition.position[static_cast<std::size_t>(dof)];
    blocks.ii.startVec(column);
    for (SparseMatrix::InnerIterator entry(matrix, dof); entry; ++entry) {
      const auto row = static_cast<std::size_t>(entry.row());
      if (!partition.is_interface[row])
        blocks.ii.insertBack(partition.position[row], column) = entry.value();
    }
  }
  blocks.ii.finalize();
  for (Eigen::Index column = 0; column < num_interface; ++column) {
    blocks.ib.startVec(column);
    for (SparseMatrix::InnerIterator entry(matrix, interface[static_cast<std::size_t>(column)]);
         entry; ++entry) {
      const auto row = static_cast<std::size_t>(entry.row());
      if (partition.is_interface[row]) {
        blocks.bb(partition.position[row], column) = entry.value();
      } else {
        blocks.ib.insertBack(partition.position[row], column) = entry.value();
      }
    }
  }
  blocks.ib.finalize();
  return blocks;
}

/// Calls act(first, count) for neighbouring groups of columns: wide enough to make the most of each
/// pass over a sparse matrix, narrow enough that what is formed on the way needs little memory.
constexpr Eigen::Index group_width = 40;
template <typename Act>
void for_column_groups(Eigen::Index num_columns, Act&& act) {
  for (Eigen::Index first = 0; first < num_columns; first += group_width)
    act(first, std::min(group_width, num_columns - first));
}

/// Takes the error of Ψ out of the softest part of the reduced stiffness.
///
/// TᵀKT with the Ψ at hand has an error of the second order in that of Ψ; K_bb + K_bi Ψ has one of
/// the first, by Ψᵀ (K_ii Ψ + K_ib). Relative to the elements that is rounding, but a slender body
/// is softer than its elements by many orders in its few softest motions, which are corrected here.
void correct_softest(const Blocks& stiffness, const VectorBlock& psi, Eigen::MatrixXd& reduced) {
  constexpr Eigen::Index most_motions = 20;
  const Eigen::Index nb = psi.cols();
  const Eigen::Index num_motions = std::min(nb, most_motions);
  if (num_motions == 0) return;
  auto interface = reduced.topLeftCorner(nb, nb);
  const Eigen::MatrixXd symmetric = 0.5 * (interface + interface.transpose());
  const Eigen::MatrixXd motions =
      lowest_eigenpairs(symmetric, num_motions, "softest motions of the interface").vectors;
  const VectorBlock interior = psi * motions;
  VectorBlock residual = stiffness.ii * interior;
  residual += stiffness.ib * motions;
  const Eigen::MatrixXd correction = interior.transpose() * residual;
  interface =
      symmetric + 0.5 * motions * (correction + correction.transpose()) * motions.transpose();
}

/// Copies the lower triangle to the upper one.
void mirror(Eigen::MatrixXd& matrix) {
  matrix.triangularView<Eigen::StrictlyUpper>() = matrix.transpose();
}

void check_arguments(const BodyMatrices& body, const Partition& partition, Eigen::Index num_modes,
                     std::span<const int> watched) {
  if (num_modes < 0 || num_modes > partition.num_interior) {
    throw std::invalid_argument(
        fmt::format("make_craig_bampton: {} fixed-interface modes asked, {} interior DoFs",
                    num_modes, partition.num_interior));
  }
  for (const int dof : watched) {
    if (dof != BodyMatrices::held && (dof < 0 || dof >= body.num_dofs())) {
      throw std::invalid_argument(
          fmt::format("make_craig_bampton: watched DoF {} is out of range", dof));
    }
  }
}

/// The interior part of T: Ψ and Φ.
struct InteriorShapes {
  VectorBlock psi;
  Modes modes;
  const Eigen::MatrixXd& phi() const { return modes.shapes; }
};

/// Φ from block Lanczos, then Ψ in groups of columns.
InteriorShapes interior_shapes(const Blocks& stiffness, const SparseMatrix& mass,
                               Eigen::Index num_modes) {
  const SparseCholesky factor(stiffness.ii, "the stiffness of the interior");
  InteriorShapes shapes;
  shapes.modes = lowest_modes(factor, stiffness.ii, mass, num_modes);
  shapes.psi = -stiffness.ib;
  const Eigen::Index nb = stiffness.ib.cols();
  Activity solving(fmt::format("{} constraint modes of {} unknowns", nb, stiffness.ii.rows()));
  for_column_groups(nb, [&](Eigen::Index first, Eigen::Index count) {
    throw_if_stopped();
    solving.report(static_cast<double>(first) / static_cast<double>(nb));
    factor.solve_in_place(shapes.psi.middleCols(first, count));
  });
  return shapes;
}

/// Adds what the interior brings to the lower triangle of TᵀMT.
void add_interior_mass(const Blocks& mass, const InteriorShapes& shapes, Eigen::MatrixXd& reduced) {
  const VectorBlock& psi = shapes.psi;
  const Eigen::Index nb = psi.cols();
  const Eigen::Index num_modes = shapes.phi().cols();
  Activity projecting("mass of the constraint modes");
  VectorBlock inertia_storage(psi.rows(), std::min(group_width, nb));
  for_column_groups(nb, [&](Eigen::Index first, Eigen::Index count) {
    throw_if_stopped();
    projecting.report(static_cast<double>(first) / static_cast<double>(nb));
    const auto psi_group = psi.middleCols(first, count);
    const Eigen::Index num_rest = nb - first;  // from the diagonal on
    auto inertia = inertia_storage.leftCols(count);
    inertia.noalias() = mass.ii * psi_group;
    inertia += mass.ib.middleCols(first, count);
    reduced.block(first, first, num_rest, count) +=
        psi.rightCols(num_rest).transpose() * inertia +
        mass.ib.rightCols(num_rest).transpose() * psi_group;
    reduced.block(nb, first, num_modes, count) = shapes.phi().transpose() * inertia;
  });
}

/// Rows of T.
Eigen::MatrixXd rows_of(std::span<const int> dofs, const Partition& partition,
                        const InteriorShapes& shapes) {
  const Eigen::Index n = shapes.psi.cols() + shapes.phi().cols();
  Eigen::MatrixXd rows = Eigen::MatrixXd::Zero(static_cast<Eigen::Index>(dofs.size()), n);
  for (std::size_t r = 0; r < dofs.size(); ++r) {
    if (dofs[r] == BodyMatrices::held) continue;
    const auto dof = static_cast<std::size_t>(dofs[r]);
    auto row = rows.row(static_cast<Eigen::Index>(r));
    if (partition.is_interface[dof]) {
      row(partition.position[dof]) = 1.0;
    } else {
      row << shapes.psi.row(partition.position[dof]), shapes.phi().row(partition.position[dof]);
    }
  }
  return rows;
}

/// Terms beside mass and stiffness, by all of T.
void reduce_other_terms(const BodyMatrices& body, const Partition& partition,
                        const InteriorShapes& shapes, ReducedBody& reduced) {
  const bool spins = body.spin && body.spin->gyroscopic.size() > 0;
  if (body.velocity.size() == 0 && body.loss_stiffness.size() == 0 && !spins) return;
  std::vector<int> all(static_cast<std::size_t>(body.num_dofs()));
  std::iota(all.begin(), all.end(), 0);
  const Eigen::MatrixXd T = rows_of(all, partition, shapes);
  if (body.velocity.size() > 0)
    reduced.coupled = {T.transpose() * (body.velocity * T), T.transpose() * (body.circulatory * T)};
  if (body.loss_stiffness.size() > 0)
    reduced.loss_stiffness = T.transpose() * (body.loss_stiffness * T);
  if (spins) reduced.spin = reduce_spin(body, T);
}

/// Tᵀ of BodyMatrices::base_inertia.
Eigen::VectorXd reduced_base_inertia(const Eigen::VectorXd& whole, const Partition& partition,
                                     const InteriorShapes& shapes) {
  const Eigen::Index nb = shapes.psi.cols();
  const Eigen::Index num_modes = shapes.phi().cols();
  Eigen::VectorXd interior(partition.num_interior);
  Eigen::VectorXd reduced(nb + num_modes);
  for (Eigen::Index dof = 0; dof < whole.size(); ++dof) {
    const auto d = static_cast<std::size_t>(dof);
    (partition.is_interface[d] ? reduced : interior)(partition.position[d]) = whole(dof);
  }
  // BLAS takes no empty matrix.
  if (partition.num_interior > 0) {
    reduced.head(nb) += shapes.psi.transpose() * interior;
    reduced.tail(num_modes) = shapes.phi().transpose() * interior;
  }
  return reduced;
}

}  // namespace

ReducedBody make_craig_bampton(const BodyMatrices& body, std::span<const int> interface,
                               Eigen::Index num_modes, std::span<const int> watched) {
  const auto nb = static_cast<Eigen::Index>(interface.size());
  const Partition partition = partition_dofs(body.num_dofs(), interface);
  check_arguments(body, partition, num_modes, watched);
  const Blocks stiffness = split(body.stiffness, partition, interface);
  const Blocks mass = split(body.mass, partition, interface);
  const InteriorShapes shapes = interior_shapes(stiffness, mass.ii, num_modes);

  ReducedBody reduced;
  reduced.damping = body.damping;
  reduced.num_interface = nb;
  const Eigen::Index n = nb + num_modes;
  reduced.stiffness = Eigen::MatrixXd::Zero(n, n);
  reduced.stiffness.topLeftCorner(nb, nb) = stiffness.bb;
  reduced.stiffness.diagonal().tail(num_modes) = shapes.modes.omega_squared;
  reduced.stiffness.topLeftCorner(nb, nb) += stiffness.ib.transpose() * shapes.psi;
  correct_softest(stiffness, shapes.psi, reduced.stiffness);
  mirror(reduced.stiffness);
  reduced.mass = Eigen::MatrixXd::Identity(n, n);
  reduced.mass.topLeftCorner(nb, nb) = mass.bb;
  add_interior_mass(mass, shapes, reduced.mass);
  mirror(reduced.mass);
  if (partition.num_interior > 0 && nb > 0) {
    constexpr double eps = std::numeric_limits<double>::epsilon();
    reduced.interface_rounding = 16.0 * std::sqrt(static_cast<double>(body.num_dofs())) * eps *
                                 stiffness.bb.diagonal().maxCoeff();
  }
  reduced.rows = rows_of(watched, partition, shapes);
  reduce_other_terms(body, partition, shapes, reduced);
  if (body.base_inertia.size() > 0)
    reduced.base_inertia = reduced_base_inertia(body.base_inertia, partition, shapes);
  return reduced;
}

}  // namespace stridor
