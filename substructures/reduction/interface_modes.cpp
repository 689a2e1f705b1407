#include "substructures/reduction/interface_modes.hpp"

#include <fmt/format.h>

#include <Eigen/Cholesky>
#include <Eigen/QR>
#include <stdexcept>

#include "core/activity.hpp"
#include "core/errors.hpp"
#include "substructures/matrices/symmetric_eigenpairs.hpp"

namespace stridor {
namespace {

/// X, the lowest modes of the interface, a column each.
///
/// They are the highest ones of L⁻¹ M_bb L⁻ᵀ, K_bb + σ M_bb = L Lᵀ, beside which rounding of the stiffest
/// motions of the interface is nothing; σ lets the body be free.
Eigen::MatrixXd lowest_interface_modes(const ReducedBody& body, Eigen::Index count) {
  const Eigen::Index nb = body.num_interface;
  const Eigen::MatrixXd mass = body.mass.topLeftCorner(nb, nb);
  const Eigen::MatrixXd stiffness = body.stiffness.topLeftCorner(nb, nb);
  constexpr double of_stiffest = 1e-9;
  const double shift =
      of_stiffest * (stiffness.diagonal().array() / mass.diagonal().array()).maxCoeff();
  const Eigen::LLT<Eigen::MatrixXd> factor(stiffness + shift * mass);
  const bool is_positive = (mass.diagonal().array() > 0.0).all();
  if (!is_positive || factor.info() != Eigen::Success)
    throw NumericalError(Refusal::singular,
                         "interface modes: the mass of the interface is not positive definite");
  Eigen::MatrixXd matrix = mass;
  factor.matrixL().solveInPlace(matrix);
  factor.matrixU().solveInPlace<Eigen::OnTheRight>(matrix);
  const Eigen::MatrixXd symmetric = 0.5 * (matrix + matrix.transpose());
  const SymmetricEigenpairs pairs = highest_eigenpairs(symmetric, count, "interface modes");
  if (count > 0 && !(pairs.values(0) > 0.0))
    throw NumericalError(Refusal::singular,
                         "interface modes: the mass of the interface is not positive definite");
  Eigen::MatrixXd modes =
      pairs.vectors.rowwise().reverse() *
      pairs.values.reverse().cwiseSqrt().cwiseInverse().asDiagonal();  // Xᵀ M X = 1
  factor.matrixU().solveInPlace(modes);
  return modes;
}

}  // namespace

ReducedBody with_interface_modes(const ReducedBody& body, Eigen::Index count) {
  const Eigen::Index nb = body.num_interface;
  if (count < 0 || count > nb) {
    throw std::invalid_argument(
        fmt::format("with_interface_modes: {} modes asked of {} DoFs", count, nb));
  }
  const Activity searching(fmt::format("{} modes of an interface of {} DoFs", count, nb));
  const Eigen::Index num_fixed = body.size() - nb;
  ReducedBody reduced = body;
  reduced.num_interface = count;
  reduced.interface_modes = lowest_interface_modes(body, count);
  Eigen::MatrixXd W = Eigen::MatrixXd::Zero(body.size(), count + num_fixed);
  W.topLeftCorner(nb, count) = reduced.interface_modes;
  W.bottomRightCorner(num_fixed, num_fixed).setIdentity();

  const auto project = [&](Eigen::MatrixXd& matrix) {
    if (matrix.size() > 0) matrix = W.transpose() * (matrix * W).eval();
  };
  project(reduced.mass);
  project(reduced.stiffness);
  project(reduced.loss_stiffness);
  if (!body.coupled.is_empty()) reduced.coupled = body.coupled.in(W);
  if (reduced.spin) {
    project(reduced.spin->gyroscopic);
    project(reduced.spin->position);
    project(reduced.spin->elastic);
    project(reduced.spin->viscous);
  }
  // What is diagonal is to be so to the last bit: its frequencies are read off.
  reduced.stiffness.topRightCorner(count, num_fixed).setZero();
  reduced.stiffness.bottomLeftCorner(num_fixed, count).setZero();
  reduced.rows = body.rows * W;
  if (body.base_inertia.size() > 0) reduced.base_inertia = W.transpose() * body.base_inertia;
  if (count > 0) {
    reduced.interface_rounding =
        body.interface_rounding * reduced.interface_modes.colwise().squaredNorm().maxCoeff();
  }
  return reduced;
}

Eigen::VectorXd interface_coordinates(const ReducedBody& body,
                                      const Eigen::VectorXd& displacements) {
  if (body.interface_modes.size() == 0) return displacements;
  return body.interface_modes.colPivHouseholderQr().solve(displacements);
}

Eigen::MatrixXd in_interface_modes(const ReducedBody& body, const Eigen::MatrixXd& columns) {
  if (body.interface_modes.size() == 0) return columns;
  const Eigen::Index nb = body.interface_modes.rows();
  const Eigen::Index num_fixed = columns.cols() - nb;
  Eigen::MatrixXd result(columns.rows(), body.num_interface + num_fixed);
  result << columns.leftCols(nb) * body.interface_modes, columns.rightCols(num_fixed);
  return result;
}

}  // namespace stridor
