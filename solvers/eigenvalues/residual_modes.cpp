#include "solvers/eigenvalues/residual_modes.hpp"

#include <fmt/format.h>

#include <Eigen/Eigenvalues>
#include <stdexcept>
#include <vector>

namespace stridor {
namespace {

/// Columns of `source` at `columns`.
Eigen::MatrixXd columns_of(const Eigen::MatrixXd& source,
                           const std::vector<Eigen::Index>& columns) {
  return source(Eigen::all, columns);
}

/// Residual modes of the dropped ones: frequency, damping and ports of each.
struct ResidualModes {
  Eigen::VectorXd omega;
  Eigen::VectorXd damping;
  Eigen::MatrixXd ports;
};

ResidualModes residual_modes(const Eigen::VectorXd& omega, const Eigen::VectorXd& damping,
                             const Eigen::MatrixXd& ports) {
  const Eigen::VectorXd flexibility = omega.array().square().inverse();
  const Eigen::MatrixXd R0 = ports * flexibility.asDiagonal() * ports.transpose();
  // R₀ = F Fᵀ with a column per direction in which the dropped modes move the ports at all.
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> directions(R0);
  const Eigen::VectorXd& stretches = directions.eigenvalues();
  const double rounding = 1e-13 * stretches.cwiseAbs().maxCoeff();
  const auto num_modes = static_cast<Eigen::Index>((stretches.array() > rounding).count());
  const Eigen::MatrixXd basis = directions.eigenvectors().rightCols(num_modes) *
                                stretches.tail(num_modes).cwiseSqrt().asDiagonal();
  const Eigen::MatrixXd to_basis =
      stretches.tail(num_modes).cwiseSqrt().cwiseInverse().asDiagonal() *
      directions.eigenvectors().rightCols(num_modes).transpose();

  const Eigen::MatrixXd reduced = to_basis * ports;
  const Eigen::VectorXd inertia = flexibility.array().square();
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> shapes(
      Eigen::MatrixXd(reduced * inertia.asDiagonal() * reduced.transpose()));
  const Eigen::MatrixXd seen = shapes.eigenvectors().transpose() * reduced;

  ResidualModes residual;
  residual.omega = shapes.eigenvalues().cwiseSqrt().cwiseInverse();
  residual.damping.resize(num_modes);
  for (Eigen::Index r = 0; r < num_modes; ++r) {
    const double R1 =
        (seen.row(r).transpose().array().square() * damping.array() * inertia.array()).sum();
    residual.damping(r) = residual.omega(r) * residual.omega(r) * R1;
  }
  residual.ports = basis * shapes.eigenvectors() * residual.omega.asDiagonal();
  return residual;
}

}  // namespace

Pencil with_residual_modes(const Pencil& pencil, double cutoff) {
  check_pencil(pencil);
  if (!(cutoff > 0.0)) {
    throw std::invalid_argument(
        fmt::format("pencil: the cut-off must be positive, is {:g} rad/s", cutoff));
  }
  std::vector<Eigen::Index> kept;
  std::vector<Eigen::Index> dropped;
  const auto is_coupled = [&](Eigen::Index i) {
    return !pencil.ports.col(i).tail(pencil.num_body_ports).isZero(0.0);
  };
  for (Eigen::Index i = 0; i < pencil.num_modes(); ++i) {
    (pencil.omega(i) > cutoff && !is_coupled(i) ? dropped : kept).push_back(i);
  }
  if (dropped.empty()) return pencil;
  const Eigen::Index num_contact_ports = pencil.num_ports() - pencil.num_body_ports;
  const ResidualModes residual =
      residual_modes(pencil.omega(dropped), pencil.damping(dropped),
                     columns_of(pencil.ports.topRows(num_contact_ports), dropped));
  const auto num_kept = static_cast<Eigen::Index>(kept.size());
  const Eigen::Index n = num_kept + residual.omega.size();
  Pencil reduced = pencil;
  reduced.omega.resize(n);
  reduced.damping.resize(n);
  reduced.ports.resize(pencil.num_ports(), n);
  reduced.omega << pencil.omega(kept), residual.omega;
  reduced.damping << pencil.damping(kept), residual.damping;
  reduced.ports.setZero();
  reduced.ports.leftCols(num_kept) = columns_of(pencil.ports, kept);
  reduced.ports.topRightCorner(num_contact_ports, residual.omega.size()) = residual.ports;
  check_pencil(reduced);
  return reduced;
}

}  // namespace stridor
