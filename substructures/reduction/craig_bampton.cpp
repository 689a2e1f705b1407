#include "substructures/reduction/craig_bampton.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>

#include "core/activity.hpp"
#include "core/stop_token.hpp"
#include "substructures/matrices/symmetric_eigenpairs.hpp"
#include "substructures/reduction/lowest_modes.hpp"

namespace stridor {
namespace {

void check_arguments(const BodyMatrices& body, std::span<const int> interface,
                     Eigen::Index num_modes, std::span<const int> watched) {
  std::vector<bool> is_interface(static_cast<std::size_t>(body.num_dofs()), false);
  for (const int dof : interface) {
    if (dof < 0 || dof >= body.num_dofs() || is_interface[static_cast<std::size_t>(dof)]) {
      throw std::invalid_argument(
          fmt::format("make_craig_bampton: interface DoF {} is out of range or doubled", dof));
    }
    is_interface[static_cast<std::size_t>(dof)] = true;
  }
  const Eigen::Index num_interior = body.num_dofs() - static_cast<Eigen::Index>(interface.size());
  if (num_modes < 0 || num_modes > num_interior) {
    throw std::invalid_argument(
        fmt::format("make_craig_bampton: {} fixed-interface modes asked, {} interior DoFs",
                    num_modes, num_interior));
  }
  for (const int dof : watched) {
    if (dof != BodyMatrices::held && (dof < 0 || dof >= body.num_dofs())) {
      throw std::invalid_argument(
          fmt::format("make_craig_bampton: watched DoF {} is out of range", dof));
    }
  }
}

/// Calls act(first, count) for neighbouring groups of columns: wide enough to make the most of each
/// pass over a sparse matrix, narrow enough that what is formed on the way needs little memory.
constexpr Eigen::Index group_width = 40;
template <typename Act>
void for_column_groups(Eigen::Index num_columns, Act&& act) {
  for (Eigen::Index first = 0; first < num_columns; first += group_width)
    act(first, std::min(group_width, num_columns - first));
}

/// The columns of T, with a row for each DoF in the order of the body.
struct Shapes {
  VectorBlock constraint;  ///< [I; Ψ], a column for each DoF of the interface
  Modes modes;             ///< [0; Φ]
  const Eigen::MatrixXd& phi() const { return modes.shapes; }
};

/// Φ from block Lanczos, then Ψ in groups of columns.
Shapes interior_shapes(const BodyMatrices& body, std::span<const int> interface,
                       Eigen::Index num_modes) {
  const SparseMatrix& K = body.stiffness;
  const SparseCholesky factor(K, "the stiffness of the interior", interface);
  Shapes shapes;
  shapes.modes = lowest_modes(factor, K, body.mass, num_modes);
  const auto nb = static_cast<Eigen::Index>(interface.size());
  shapes.constraint = VectorBlock::Zero(K.rows(), nb);
  for (Eigen::Index column = 0; column < nb; ++column) {
    const int dof = interface[static_cast<std::size_t>(column)];
    for (SparseMatrix::InnerIterator entry(K, dof); entry; ++entry)
      shapes.constraint(entry.row(), column) = -entry.value();
  }
  Activity solving(fmt::format("{} constraint modes of {} unknowns", nb, factor.num_factorised()));
  for_column_groups(nb, [&](Eigen::Index first, Eigen::Index count) {
    throw_if_stopped();
    solving.report(static_cast<double>(first) / static_cast<double>(nb));
    factor.solve_in_place(shapes.constraint.middleCols(first, count));
  });
  for (Eigen::Index column = 0; column < nb; ++column)
    shapes.constraint.row(interface[static_cast<std::size_t>(column)]) =
        Eigen::RowVectorXd::Unit(nb, column);
  return shapes;
}

/// K_bb + K_bi Ψ: the rows of the interface of K [I; Ψ].
Eigen::MatrixXd interface_stiffness(const SparseMatrix& stiffness, std::span<const int> interface,
                                    const VectorBlock& constraint) {
  Eigen::MatrixXd reduced = Eigen::MatrixXd::Zero(constraint.cols(), constraint.cols());
  for (Eigen::Index row = 0; row < reduced.rows(); ++row) {
    // K is symmetric.
    const int dof = interface[static_cast<std::size_t>(row)];
    for (SparseMatrix::InnerIterator entry(stiffness, dof); entry; ++entry)
      reduced.row(row) += entry.value() * constraint.row(entry.row());
  }
  return reduced;
}

/// Takes the error of Ψ out of the softest part of the reduced stiffness.
///
/// TᵀKT with the Ψ at hand has an error of the second order in that of Ψ; K_bb + K_bi Ψ has one of
/// the first, by Ψᵀ (K_ii Ψ + K_ib). Relative to the elements that is rounding, but a slender body
/// is softer than its elements by many orders in its few softest motions, which are corrected here.
///
/// @param reduced K_bb + K_bi Ψ
Eigen::MatrixXd with_softest_corrected(const SparseMatrix& stiffness,
                                       std::span<const int> interface,
                                       const VectorBlock& constraint,
                                       const Eigen::MatrixXd& reduced) {
  constexpr Eigen::Index most_motions = 20;
  const Eigen::Index num_motions = std::min(reduced.rows(), most_motions);
  if (num_motions == 0) return reduced;
  const Eigen::MatrixXd symmetric = 0.5 * (reduced + reduced.transpose());
  const Eigen::MatrixXd motions =
      lowest_eigenpairs(symmetric, num_motions, "softest motions of the interface").vectors;
  const VectorBlock displacement = constraint * motions;
  VectorBlock residual = stiffness * displacement;
  for (const int dof : interface) residual.row(dof).setZero();
  const Eigen::MatrixXd correction = displacement.transpose() * residual;
  return symmetric + 0.5 * motions * (correction + correction.transpose()) * motions.transpose();
}

/// Copies the lower triangle to the upper one.
void mirror(Eigen::MatrixXd& matrix) {
  matrix.triangularView<Eigen::StrictlyUpper>() = matrix.transpose();
}

/// The lower triangle of TᵀMT.
Eigen::MatrixXd reduced_mass(const SparseMatrix& mass, const Shapes& shapes) {
  const VectorBlock& constraint = shapes.constraint;
  const Eigen::Index nb = constraint.cols();
  const Eigen::Index num_modes = shapes.phi().cols();
  Eigen::MatrixXd reduced = Eigen::MatrixXd::Identity(nb + num_modes, nb + num_modes);
  Activity projecting("mass of the constraint modes");
  VectorBlock inertia_storage(constraint.rows(), std::min(group_width, nb));
  for_column_groups(nb, [&](Eigen::Index first, Eigen::Index count) {
    throw_if_stopped();
    projecting.report(static_cast<double>(first) / static_cast<double>(nb));
    const Eigen::Index num_rest = nb - first;  // from the diagonal on
    auto inertia = inertia_storage.leftCols(count);
    inertia.noalias() = mass * constraint.middleCols(first, count);
    reduced.block(first, first, num_rest, count) =
        constraint.rightCols(num_rest).transpose() * inertia;
    if (num_modes > 0)
      reduced.block(nb, first, num_modes, count) = shapes.phi().transpose() * inertia;
  });
  return reduced;
}

/// Rows of T.
Eigen::MatrixXd rows_of(std::span<const int> dofs, const Shapes& shapes) {
  const Eigen::Index n = shapes.constraint.cols() + shapes.phi().cols();
  Eigen::MatrixXd rows = Eigen::MatrixXd::Zero(static_cast<Eigen::Index>(dofs.size()), n);
  for (std::size_t r = 0; r < dofs.size(); ++r) {
    if (dofs[r] == BodyMatrices::held) continue;
    rows.row(static_cast<Eigen::Index>(r)) << shapes.constraint.row(dofs[r]),
        shapes.phi().row(dofs[r]);
  }
  return rows;
}

/// Terms beside mass and stiffness, by all of T.
void reduce_other_terms(const BodyMatrices& body, const Shapes& shapes, ReducedBody& reduced) {
  const bool spins = body.spin && body.spin->gyroscopic.size() > 0;
  if (body.velocity.size() == 0 && body.loss_stiffness.size() == 0 && !spins) return;
  Eigen::MatrixXd T(body.num_dofs(), reduced.size());
  T << shapes.constraint, shapes.phi();
  if (body.velocity.size() > 0)
    reduced.coupled = {T.transpose() * (body.velocity * T), T.transpose() * (body.circulatory * T)};
  if (body.loss_stiffness.size() > 0)
    reduced.loss_stiffness = T.transpose() * (body.loss_stiffness * T);
  if (spins) reduced.spin = reduce_spin(body, T);
}

/// Tᵀ of BodyMatrices::base_inertia.
Eigen::VectorXd reduced_base_inertia(const Eigen::VectorXd& whole, const Shapes& shapes) {
  const Eigen::Index nb = shapes.constraint.cols();
  const Eigen::Index num_modes = shapes.phi().cols();
  Eigen::VectorXd reduced(nb + num_modes);
  reduced.head(nb) = shapes.constraint.transpose() * whole;
  reduced.tail(num_modes) = shapes.phi().transpose() * whole;
  return reduced;
}

}  // namespace

ReducedBody make_craig_bampton(const BodyMatrices& body, std::span<const int> interface,
                               Eigen::Index num_modes, std::span<const int> watched) {
  check_arguments(body, interface, num_modes, watched);
  const auto nb = static_cast<Eigen::Index>(interface.size());
  const Shapes shapes = interior_shapes(body, interface, num_modes);

  ReducedBody reduced;
  reduced.damping = body.damping;
  reduced.num_interface = nb;
  const Eigen::Index n = nb + num_modes;
  reduced.stiffness = Eigen::MatrixXd::Zero(n, n);
  reduced.stiffness.topLeftCorner(nb, nb) =
      with_softest_corrected(body.stiffness, interface, shapes.constraint,
                             interface_stiffness(body.stiffness, interface, shapes.constraint));
  reduced.stiffness.diagonal().tail(num_modes) = shapes.modes.omega_squared;
  mirror(reduced.stiffness);
  reduced.mass = reduced_mass(body.mass, shapes);
  mirror(reduced.mass);
  if (nb > 0 && nb < body.num_dofs()) {
    double stiffest = 0.0;
    for (const int dof : interface) stiffest = std::max(stiffest, body.stiffness.coeff(dof, dof));
    constexpr double eps = std::numeric_limits<double>::epsilon();
    reduced.interface_rounding =
        16.0 * std::sqrt(static_cast<double>(body.num_dofs())) * eps * stiffest;
  }
  reduced.rows = rows_of(watched, shapes);
  reduce_other_terms(body, shapes, reduced);
  if (body.base_inertia.size() > 0)
    reduced.base_inertia = reduced_base_inertia(body.base_inertia, shapes);
  return reduced;
}

}  // namespace stridor
