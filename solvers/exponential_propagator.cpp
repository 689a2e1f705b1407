#include "solvers/exponential_propagator.hpp"

#include <fmt/format.h>

#include <Eigen/LU>
#include <Eigen/QR>
#include <stdexcept>
#include <unsupported/Eigen/MatrixFunctions>

#include "core/errors.hpp"

namespace stridor {
namespace {

Eigen::MatrixXd null_space(const Eigen::MatrixXd& rows, const char* what) {
  const Eigen::Index n = rows.cols();
  if (rows.rows() == 0) return Eigen::MatrixXd::Identity(n, n);
  Eigen::ColPivHouseholderQR<Eigen::MatrixXd> qr(rows.transpose());
  qr.setThreshold(1e-12);
  if (qr.rank() < rows.rows()) {
    throw NumericalError(
        fmt::format("constraints: the {} rows of {} have rank {}", rows.rows(), what, qr.rank()));
  }
  const Eigen::MatrixXd Q = qr.householderQ() * Eigen::MatrixXd::Identity(n, n);
  return Q.rightCols(n - rows.rows());
}

void check(const LinearSystem& system, double step) {
  const Eigen::Index n = system.size();
  const auto reject = [](const std::string& message) {
    throw std::invalid_argument("exponential propagator: " + message);
  };
  if (!(step > 0.0)) reject(fmt::format("a step of {:g} s", step));
  for (const Eigen::MatrixXd* matrix : {&system.mass, &system.velocity, &system.position})
    if (matrix->rows() != n || matrix->cols() != n) reject("the matrices differ in size");
  if (system.gaps.rows() > 0) reject("constraints are to be eliminated first");
}

}  // namespace

EliminatedSystem eliminate_constraints(const LinearSystem& system) {
  const Eigen::MatrixXd Z = null_space(system.gaps, "gaps");
  const Eigen::MatrixXd Y = null_space(system.forces, "forces");
  EliminatedSystem eliminated;
  eliminated.motion = Z;
  eliminated.system.mass = Y.transpose() * system.mass * Z;
  eliminated.system.velocity = Y.transpose() * system.velocity * Z;
  eliminated.system.position = Y.transpose() * system.position * Z;
  eliminated.system.gaps = eliminated.system.forces = Eigen::MatrixXd(0, Z.cols());
  return eliminated;
}

ExponentialPropagator::ExponentialPropagator(const LinearSystem& system, double step)
    : size_(system.size()), step_(step) {
  check(system, step);
  const Eigen::Index n = size_;
  const Eigen::PartialPivLU<Eigen::MatrixXd> mass(system.mass);
  if (!(mass.rcond() > 1e-15))
    throw NumericalError("exponential propagator: the mass matrix is singular");
  // exp of [[A, B, 0], [0, 0, 1], [0, 0, 0]] h holds e^{Ah}, h φ₁ B and h φ₂ B side by side. The
  // velocities are scaled by h, so that displacements and velocities are of one size.
  Eigen::MatrixXd generator = Eigen::MatrixXd::Zero(4 * n, 4 * n);
  generator.block(0, n, n, n).setIdentity();
  generator.block(n, 0, n, n) = -step * step * mass.solve(system.position);
  generator.block(n, n, n, n) = -step * mass.solve(system.velocity);
  generator.block(n, 2 * n, n, n) = step * step * mass.inverse();
  generator.block(2 * n, 3 * n, n, n).setIdentity();
  const Eigen::MatrixXd exponential = generator.exp();
  Eigen::VectorXd scale = Eigen::VectorXd::Ones(2 * n);
  scale.tail(n).setConstant(1.0 / step);
  free_ = scale.asDiagonal() * exponential.topLeftCorner(2 * n, 2 * n) *
          scale.cwiseInverse().asDiagonal();
  by_constant_ = scale.asDiagonal() * exponential.block(0, 2 * n, 2 * n, n);
  by_slope_ = scale.asDiagonal() * exponential.block(0, 3 * n, 2 * n, n);
  state_.resize(2 * n);
  next_.resize(2 * n);
}

void ExponentialPropagator::advance(Eigen::VectorXd& q, Eigen::VectorXd& v) {
  state_.head(size_) = q;
  state_.tail(size_) = v;
  next_.noalias() = free_ * state_;
  q = next_.head(size_);
  v = next_.tail(size_);
}

void ExponentialPropagator::advance(Eigen::VectorXd& q, Eigen::VectorXd& v,
                                    const Eigen::VectorXd& before, const Eigen::VectorXd& after) {
  state_.head(size_) = q;
  state_.tail(size_) = v;
  next_.noalias() = free_ * state_;
  next_.noalias() += by_constant_ * before;
  next_.noalias() += by_slope_ * (after - before);
  q = next_.head(size_);
  v = next_.tail(size_);
}

}  // namespace stridor
