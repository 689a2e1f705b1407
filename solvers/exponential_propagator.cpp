#include "solvers/exponential_propagator.hpp"

#include <fmt/format.h>

#include <Eigen/LU>
#include <Eigen/QR>
#include <algorithm>
#include <stdexcept>
#include <unsupported/Eigen/MatrixFunctions>
#include <vector>

#include "core/errors.hpp"

namespace stridor {
namespace {

Eigen::MatrixXd null_space_of(const Eigen::MatrixXd& rows, const char* what) {
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

/// What exp(A h) and its integrals are for one group of coordinates.
struct GroupResponse {
  Eigen::MatrixXd free;         ///< e^{Ah}, 2m x 2m
  Eigen::MatrixXd by_constant;  ///< h φ₁(Ah) B, 2m x m
  Eigen::MatrixXd by_slope;     ///< h φ₂(Ah) B, 2m x m
};

GroupResponse response_of(const LinearSystem& system, const CoordinateGroup& group, double step) {
  const Eigen::Index m = group.size;
  const auto part = [&](const Eigen::MatrixXd& matrix) -> Eigen::MatrixXd {
    return matrix.block(group.first, group.first, m, m);
  };
  const Eigen::PartialPivLU<Eigen::MatrixXd> mass(part(system.mass));
  if (!(mass.rcond() > 1e-15))
    throw NumericalError("exponential propagator: the mass matrix is singular");
  // exp of [[A, B, 0], [0, 0, 1], [0, 0, 0]] h holds e^{Ah}, h φ₁ B and h φ₂ B side by side. The
  // velocities are scaled by h, so that displacements and velocities are of one size.
  Eigen::MatrixXd generator = Eigen::MatrixXd::Zero(4 * m, 4 * m);
  generator.block(0, m, m, m).setIdentity();
  generator.block(m, 0, m, m) = -step * step * mass.solve(part(system.position));
  generator.block(m, m, m, m) = -step * mass.solve(part(system.velocity));
  generator.block(m, 2 * m, m, m) = step * step * mass.inverse();
  generator.block(2 * m, 3 * m, m, m).setIdentity();
  const Eigen::MatrixXd exponential = generator.exp();
  Eigen::VectorXd scale = Eigen::VectorXd::Ones(2 * m);
  scale.tail(m).setConstant(1.0 / step);
  GroupResponse response;
  response.free = scale.asDiagonal() * exponential.topLeftCorner(2 * m, 2 * m) *
                  scale.cwiseInverse().asDiagonal();
  response.by_constant = scale.asDiagonal() * exponential.block(0, 2 * m, 2 * m, m);
  response.by_slope = scale.asDiagonal() * exponential.block(0, 3 * m, 2 * m, m);
  return response;
}

}  // namespace

EliminatedSystem eliminate_constraints(const LinearSystem& system) {
  const Eigen::MatrixXd Z = null_space_of(system.gaps, "gaps");
  const Eigen::MatrixXd Y = null_space_of(system.forces, "forces");
  EliminatedSystem eliminated;
  eliminated.motion = Z;
  eliminated.system.mass = Y.transpose() * system.mass * Z;
  eliminated.system.velocity = Y.transpose() * system.velocity * Z;
  eliminated.system.position = Y.transpose() * system.position * Z;
  eliminated.system.gaps = eliminated.system.forces = Eigen::MatrixXd(0, Z.cols());
  return eliminated;
}

ExponentialPropagator::ExponentialPropagator(const LinearSystem& system, double step)
    : step_(step) {
  check(system, step);
  apart_ = decouple(system);
  const Eigen::Index n = system.size();
  Eigen::MatrixXd free = Eigen::MatrixXd::Zero(2 * n, 2 * n);
  Eigen::MatrixXd constant = Eigen::MatrixXd::Zero(2 * n, n);
  Eigen::MatrixXd slope = constant;
  for (const auto& [first, m] : apart_.groups) {
    const GroupResponse response = response_of(apart_.system, {first, m}, step);
    for (const Eigen::Index row : {Eigen::Index{0}, Eigen::Index{1}}) {
      for (const Eigen::Index col : {Eigen::Index{0}, Eigen::Index{1}})
        free.block(row * n + first, col * n + first, m, m) =
            response.free.block(row * m, col * m, m, m);
      constant.block(row * n + first, first, m, m) = response.by_constant.middleRows(row * m, m);
      slope.block(row * n + first, first, m, m) = response.by_slope.middleRows(row * m, m);
    }
  }
  z_by_z_ = GroupDiagonal(free.topLeftCorner(n, n), apart_.groups);
  z_by_v_ = GroupDiagonal(free.topRightCorner(n, n), apart_.groups);
  v_by_z_ = GroupDiagonal(free.bottomLeftCorner(n, n), apart_.groups);
  v_by_v_ = GroupDiagonal(free.bottomRightCorner(n, n), apart_.groups);
  const Eigen::MatrixXd& T = apart_.motion;
  const auto of_system = [&](const Eigen::MatrixXd& response) {
    Eigen::MatrixXd moved(2 * n, n);
    moved.topRows(n) = T * response.topRows(n) * T.transpose();
    moved.bottomRows(n) = T * response.bottomRows(n) * T.transpose();
    return moved;
  };
  by_constant_ = of_system(constant);
  by_slope_ = of_system(slope);
}

Eigen::MatrixXd ExponentialPropagator::free_response() const {
  const Eigen::Index n = size();
  const auto of_system = [&](const GroupDiagonal& block) -> Eigen::MatrixXd {
    return apart_.motion * block.dense() * apart_.inverse;
  };
  Eigen::MatrixXd response(2 * n, 2 * n);
  response << of_system(z_by_z_), of_system(z_by_v_), of_system(v_by_z_), of_system(v_by_v_);
  return response;
}

void ExponentialPropagator::advance(const double* z, const double* v, double* next_z,
                                    double* next_v) const {
  const std::size_t padded = padded_size(size());
  std::fill_n(next_z, padded, 0.0);
  std::fill_n(next_v, padded, 0.0);
  z_by_z_.add_product(z, next_z);
  z_by_v_.add_product(v, next_z);
  v_by_z_.add_product(z, next_v);
  v_by_v_.add_product(v, next_v);
}

void ExponentialPropagator::advance(Eigen::VectorXd& q, Eigen::VectorXd& v) const {
  const Eigen::VectorXd z = apart_.inverse * q;
  const Eigen::VectorXd rate = apart_.inverse * v;
  const auto padded = static_cast<Eigen::Index>(padded_size(size()));
  Eigen::VectorXd next_z(padded), next_rate(padded);
  advance(z.data(), rate.data(), next_z.data(), next_rate.data());
  q = apart_.motion * next_z.head(size());
  v = apart_.motion * next_rate.head(size());
}

void ExponentialPropagator::advance(Eigen::VectorXd& q, Eigen::VectorXd& v,
                                    const Eigen::VectorXd& before,
                                    const Eigen::VectorXd& after) const {
  advance(q, v);
  const Eigen::VectorXd moved = by_constant_ * before + by_slope_ * (after - before);
  q += moved.head(size());
  v += moved.tail(size());
}

}  // namespace stridor
