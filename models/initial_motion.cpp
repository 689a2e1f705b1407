#include "models/initial_motion.hpp"

#include <Eigen/QR>

#include "core/errors.hpp"

namespace stridor {

Eigen::VectorXd static_shape(const ModalBody& body, std::span<const PrescribedRow> prescribed) {
  const auto num_rows = static_cast<Eigen::Index>(prescribed.size());
  const auto num_rigid = (body.omega.array() == 0.0).count();
  const Eigen::Index num_elastic = body.size() - num_rigid;
  Eigen::MatrixXd rows(num_rows, body.size());
  Eigen::VectorXd values(num_rows);
  for (Eigen::Index i = 0; i < num_rows; ++i) {
    rows.row(i) = body.rows.row(prescribed[static_cast<std::size_t>(i)].row);
    values(i) = prescribed[static_cast<std::size_t>(i)].value;
  }
  // Forces μ on the rows and rigid amplitudes a (the lowest modes):
  //   F μ + R_r a = values,  R_rᵀ μ = 0,  F = R_e diag(1/ω²) R_eᵀ.
  const Eigen::VectorXd flexibility = body.omega.tail(num_elastic).array().square().inverse();
  const Eigen::MatrixXd elastic = rows.rightCols(num_elastic);
  const Eigen::MatrixXd rigid = rows.leftCols(num_rigid);
  Eigen::MatrixXd system = Eigen::MatrixXd::Zero(num_rows + num_rigid, num_rows + num_rigid);
  system.topLeftCorner(num_rows, num_rows) =
      elastic * flexibility.asDiagonal() * elastic.transpose();
  // Forces are counted in units that make both blocks of like size.
  const double unit = system.cwiseAbs().maxCoeff();
  if (unit > 0.0) system /= unit;
  system.topRightCorner(num_rows, num_rigid) = rigid;
  system.bottomLeftCorner(num_rigid, num_rows) = rigid.transpose();
  Eigen::VectorXd right_side = Eigen::VectorXd::Zero(num_rows + num_rigid);
  right_side.head(num_rows) = values;
  const Eigen::VectorXd solution = system.completeOrthogonalDecomposition().solve(right_side);

  Eigen::VectorXd modal(body.size());
  modal.head(num_rigid) = solution.tail(num_rigid);
  modal.tail(num_elastic) =
      flexibility.asDiagonal() * (elastic.transpose() * solution.head(num_rows)) / unit;
  if (num_elastic == 0 || !(unit > 0.0)) modal.tail(num_elastic).setZero();
  if (!((rows * modal - values).norm() <= 1e-6 * values.norm()))
    throw NumericalError(
        "the body cannot take this motion: a support holds it, or values contradict");
  return body.shapes * modal;
}

}  // namespace stridor
