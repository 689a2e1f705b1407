#include "solvers/eigenvalues/frequency_response.hpp"

#include <Eigen/LU>
#include <stdexcept>
#include <vector>

namespace stridor {
namespace {

using Complex = std::complex<double>;

/// Modes by whether they answer far from their own resonance, or are so close to it that dividing
/// by s² + c s + ω² would cost digits: these stay unknowns.
std::vector<Eigen::Index> modes_near(const Eigen::ArrayXcd& d, const Eigen::ArrayXd& omega,
                                     Complex s) {
  constexpr double near = 1e-3;
  std::vector<Eigen::Index> modes;
  for (Eigen::Index i = 0; i < d.size(); ++i)
    if (std::abs(d(i)) <= near * (std::norm(s) + omega(i) * omega(i))) modes.push_back(i);
  return modes;
}

}  // namespace

FrequencyResponse::FrequencyResponse(const Pencil& pencil, Eigen::MatrixXd loads,
                                     Eigen::MatrixXd sensors)
    : loads_(std::move(loads)), sensors_(std::move(sensors)) {
  check_pencil(pencil);
  if (loads_.cols() != pencil.num_modes() || sensors_.cols() != pencil.num_modes())
    throw std::invalid_argument("FrequencyResponse: the rows do not fit the modes");
  const Pencil sprung = with_springs(pencil);
  omega_ = sprung.omega.array();
  damping_ = sprung.damping.array();
  rows_ = modal_rows(sprung);
}

Eigen::MatrixXcd FrequencyResponse::at(Complex s) const {
  const Eigen::ArrayXcd d = s * s + s * damping_.cast<Complex>() + omega_.square().cast<Complex>();
  const std::vector<Eigen::Index> near = modes_near(d, omega_, s);
  Eigen::ArrayXcd far = d.inverse();
  for (const Eigen::Index i : near) far(i) = 0.0;

  const Eigen::Index k = rows_.num_constraints;
  const Eigen::Index r = rows_.rank;
  const auto num_near = static_cast<Eigen::Index>(near.size());
  const Eigen::Index size = k + r + num_near;
  // (b_E, p_G + s p_H), by which the unknowns (δλ, z) act on the modes.
  Eigen::MatrixXcd inputs = rows_.inputs.topRows(k + r).cast<Complex>();
  if (r > 0) inputs.bottomRows(r) += s * rows_.inputs.bottomRows(r);
  const Eigen::MatrixXcd far_outputs = rows_.outputs.cast<Complex>() * far.matrix().asDiagonal();
  const Eigen::MatrixXcd far_sensors = sensors_.cast<Complex>() * far.matrix().asDiagonal();
  const Eigen::MatrixXcd loads = loads_.transpose().cast<Complex>();

  Eigen::MatrixXcd matrix = Eigen::MatrixXcd::Zero(size, size);
  Eigen::MatrixXcd right = Eigen::MatrixXcd::Zero(size, loads.cols());
  Eigen::MatrixXcd seen(sensors_.rows(), size);  // by the sensors, of the unknowns
  matrix.topLeftCorner(k + r, k + r) = far_outputs * inputs.transpose();
  matrix.block(k, k, r, r).diagonal().array() += 1.0;
  right.topRows(k + r) = far_outputs * loads;
  seen.leftCols(k + r) = -far_sensors * inputs.transpose();
  for (Eigen::Index j = 0; j < num_near; ++j) {
    const Eigen::Index mode = near[static_cast<std::size_t>(j)];
    const Eigen::Index at = k + r + j;
    matrix.block(0, at, k + r, 1) = -rows_.outputs.col(mode).cast<Complex>();
    matrix.block(at, 0, 1, k + r) = inputs.col(mode).transpose();
    matrix(at, at) = d(mode);
    right.row(at) = loads.row(mode);
    seen.col(at) = sensors_.col(mode).cast<Complex>();
  }
  Eigen::MatrixXcd response = far_sensors * loads;
  if (size > 0) response += seen * Eigen::PartialPivLU<Eigen::MatrixXcd>(matrix).solve(right);
  return response;
}

Eigen::MatrixXd rows_on_modes(const System& system,
                              const std::vector<std::pair<int, int>>& displacements) {
  std::vector<Eigen::Index> first{0};
  for (const SystemBody& body : system.bodies) first.push_back(first.back() + body.modal.size());
  Eigen::MatrixXd rows =
      Eigen::MatrixXd::Zero(static_cast<Eigen::Index>(displacements.size()), first.back());
  for (std::size_t i = 0; i < displacements.size(); ++i) {
    const auto [body, row] = displacements[i];
    const Eigen::MatrixXd& of_body = system.bodies[static_cast<std::size_t>(body)].modal.rows;
    rows.block(static_cast<Eigen::Index>(i), first[static_cast<std::size_t>(body)], 1,
               of_body.cols()) = of_body.row(row);
  }
  return rows;
}

Pencil with_ports(const Pencil& pencil, const Eigen::MatrixXd& rows) {
  const Eigen::Index more = rows.rows();
  const Eigen::Index before = pencil.num_ports() - pencil.num_body_ports;
  const Eigen::Index behind = pencil.num_body_ports;
  const auto widened = [&](const Eigen::MatrixXd& matrix) {
    Eigen::MatrixXd wide = Eigen::MatrixXd::Zero(matrix.rows(), matrix.cols() + more);
    wide.leftCols(before) = matrix.leftCols(before);
    wide.rightCols(behind) = matrix.rightCols(behind);
    return wide;
  };
  const auto between_ports = [&](const Eigen::MatrixXd& matrix) -> Eigen::MatrixXd {
    if (matrix.size() == 0) return matrix;
    return widened(widened(matrix).transpose()).transpose();
  };
  Pencil wide = pencil;
  wide.ports = widened(pencil.ports.transpose()).transpose();
  wide.ports.middleRows(before, more) = rows;
  wide.compatibility = widened(pencil.compatibility);
  wide.equilibrium = widened(pencil.equilibrium);
  wide.port_stiffness = between_ports(pencil.port_stiffness);
  wide.port_damping = between_ports(pencil.port_damping);
  return wide;
}

Eigen::MatrixXd added_ports(const Pencil& pencil, Eigen::Index count) {
  return pencil.ports.middleRows(pencil.num_ports() - pencil.num_body_ports - count, count);
}

}  // namespace stridor
