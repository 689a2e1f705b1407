#include "solvers/eigenvalues/linear_pencil.hpp"

#include <fmt/format.h>

#include <Eigen/Cholesky>
#include <stdexcept>

#include "substructures/matrices/symmetric_eigenpairs.hpp"

namespace stridor {
namespace {

void check_matrix(const char* name, const Eigen::MatrixXd& matrix, Eigen::Index rows,
                  Eigen::Index columns) {
  if (matrix.rows() != rows || matrix.cols() != columns) {
    throw std::invalid_argument(fmt::format("linear system: {} is {} x {} instead of {} x {}", name,
                                            matrix.rows(), matrix.cols(), rows, columns));
  }
  if (!matrix.allFinite())
    throw std::invalid_argument(fmt::format("linear system: {} is not finite", name));
}

void check(const LinearSystem& system) {
  const Eigen::Index n = system.size();
  check_matrix("the mass matrix", system.mass, n, n);
  check_matrix("the velocity matrix", system.velocity, n, n);
  check_matrix("the position matrix", system.position, n, n);
  check_matrix("the matrix of gaps", system.gaps, system.gaps.rows(), n);
  check_matrix("the matrix of forces", system.forces, system.gaps.rows(), n);
  const double asymmetry = split(system.mass).skew.cwiseAbs().maxCoeff();
  const bool is_definite = Eigen::LLT<Eigen::MatrixXd>(system.mass).info() == Eigen::Success;
  if (asymmetry > 1e-12 * system.mass.cwiseAbs().maxCoeff() || !is_definite)
    throw std::invalid_argument(
        "linear system: the mass matrix is not symmetric positive definite");
}

}  // namespace

Pencil make_pencil(const LinearSystem& system) {
  check(system);
  const Eigen::Index n = system.size();
  const SymmetricEigenpairs modes =
      generalised_eigenpairs(split(system.position).symmetric, system.mass, "linear system");
  Pencil pencil;
  pencil.omega = modes.values.cwiseMax(0.0).cwiseSqrt();
  pencil.damping = Eigen::VectorXd::Zero(n);
  pencil.ports = modes.vectors;
  const Eigen::MatrixXd momenta = system.mass * pencil.ports;
  pencil.port_stiffness =
      system.position -
      momenta * pencil.omega.array().square().matrix().asDiagonal() * momenta.transpose();
  pencil.port_damping = system.velocity;
  pencil.compatibility = -system.gaps;
  pencil.equilibrium = -system.forces;
  return pencil;
}

}  // namespace stridor
