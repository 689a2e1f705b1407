#include "models/initial_motion.hpp"

#include <fmt/format.h>

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <limits>

#include "core/errors.hpp"
#include "substructures/reduction/interface_modes.hpp"

namespace stridor {
namespace {

/// The shortest of the vectors that come closest to A x = b.
/// @param A symmetric
Eigen::VectorXd smallest_solution(const Eigen::MatrixXd& A, const Eigen::VectorXd& b) {
  if (A.rows() == 0) return b;
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> pairs(A);
  const Eigen::ArrayXd values = pairs.eigenvalues().array();
  const double least = static_cast<double>(A.rows()) * std::numeric_limits<double>::epsilon() *
                       values.abs().maxCoeff();
  const Eigen::VectorXd inverse = (values.abs() > least).select(values.inverse(), 0.0);
  const Eigen::VectorXd parts = pairs.eigenvectors().transpose() * b;
  return pairs.eigenvectors() * inverse.cwiseProduct(parts);
}

/// Whether a DoF is the displacement of nodes in a direction.
bool is_dof_of(const BodyMatrices& body, int dof, std::size_t direction) {
  if (direction == 2)
    return std::find(body.across.begin(), body.across.end(), dof) != body.across.end();
  return std::any_of(body.node_dofs.begin(), body.node_dofs.end(),
                     [&](const auto& dofs) { return dofs[direction] == dof; });
}

/// Constraint modes carry a body along with its interface; that is a translation where no support
/// resists it.
Eigen::VectorXd translation(const std::string& key, const Eigen::Vector3d& value,
                            const ModelBody& built, const SystemBody& finished) {
  Eigen::VectorXd motion = Eigen::VectorXd::Zero(finished.reduced.size());
  const Eigen::MatrixXd& stiffness = finished.reduced.stiffness;
  for (Eigen::Index direction = 0; direction < 3; ++direction) {
    if (value(direction) == 0.0) continue;
    Eigen::VectorXd interface =
        Eigen::VectorXd::Zero(static_cast<Eigen::Index>(built.interface.size()));
    for (std::size_t k = 0; k < built.interface.size(); ++k) {
      if (is_dof_of(built.matrices, built.interface[k], static_cast<std::size_t>(direction)))
        interface(static_cast<Eigen::Index>(k)) = 1.0;
    }
    Eigen::VectorXd unit = Eigen::VectorXd::Zero(finished.reduced.size());
    unit.head(finished.reduced.num_interface) = interface_coordinates(finished.reduced, interface);
    const double energy = unit.dot(stiffness * unit);
    const double scale = unit.dot(stiffness.cwiseAbs() * unit);
    // A body without interface DoFs in this direction is held by its supports alone.
    if (unit.isZero() || !(energy <= 1e-9 * scale)) {
      throw ConfigError(Refusal::motion_is_held, key + ".at",
                        fmt::format("the supports of '{}' do not let all of it move alike; name "
                                    "a point of it",
                                    built.name));
    }
    motion += value(direction) * unit;
  }
  return motion;
}

}  // namespace

void InitialMotion::add(const std::string& key, const std::string& at, const Eigen::Vector3d& value,
                        std::vector<ModelBody>& bodies) {
  Entry entry{key, 0, std::nullopt, value};
  const bool is_point = at.find('.') != std::string::npos;
  const auto [b, point] = split_name(is_point ? at : at + ".all", bodies, key + ".at");
  entry.body = b;
  ModelBody& body = bodies[static_cast<std::size_t>(b)];
  if (is_point) entry.rows = body.rows_of(node_at(body, point, key + ".at"));
  entries_.push_back(std::move(entry));
}

Eigen::VectorXd InitialMotion::of(int body, const ModelBody& built,
                                  const SystemBody& finished) const {
  Eigen::VectorXd motion;
  std::vector<PrescribedRow> prescribed;
  std::string key;
  const auto add = [&](const Eigen::VectorXd& part) {
    motion = motion.size() == 0 ? part : Eigen::VectorXd(motion + part);
  };
  for (const Entry& entry : entries_) {
    if (entry.body != body) continue;
    if (entry.rows) {
      key = entry.key;
      if (entry.value.x() != 0.0) prescribed.push_back({entry.rows->x, entry.value.x()});
      if (entry.value.y() != 0.0) prescribed.push_back({entry.rows->y, entry.value.y()});
      if (entry.value.z() != 0.0 && entry.rows->z < 0) {
        throw ConfigError(Refusal::motion_is_held, entry.key + ".at",
                          fmt::format("'{}' does not move along z", built.name));
      }
      if (entry.value.z() != 0.0) prescribed.push_back({entry.rows->z, entry.value.z()});
    } else {
      add(translation(entry.key, entry.value, built, finished));
    }
  }
  if (!prescribed.empty()) {
    try {
      add(static_shape(finished.modal, prescribed));
    } catch (const NumericalError& error) {
      throw ConfigError(Refusal::wrong_value, key + ".at", error.what());
    }
  }
  return motion;
}


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
  const Eigen::VectorXd solution = smallest_solution(system, right_side);

  Eigen::VectorXd modal(body.size());
  modal.head(num_rigid) = solution.tail(num_rigid);
  modal.tail(num_elastic) =
      flexibility.asDiagonal() * (elastic.transpose() * solution.head(num_rows)) / unit;
  if (num_elastic == 0 || !(unit > 0.0)) modal.tail(num_elastic).setZero();
  if (!((rows * modal - values).norm() <= 1e-6 * values.norm()))
    throw NumericalError(
        Refusal::motion_is_held,
        "the body cannot take this motion: a support holds it, or values contradict");
  return body.shapes * modal;
}

}  // namespace stridor
