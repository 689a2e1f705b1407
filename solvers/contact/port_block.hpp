// A contact at the ports of one body.
#pragma once

#include <Eigen/Core>

#include "coupling/kinematics/tangent_kinematics.hpp"
#include "coupling/kinematics/surface.hpp"
#include "solvers/integrators/propagator.hpp"

namespace stridor {

/// What a contact sees of the displacements of a body, and how its forces act. Columns: the normal, then
/// the tangents; rows: the ports of the body from `port` on.
struct PortBlock {
  static constexpr int most_ports = max_facet_ports;
  using Columns = Eigen::Matrix<double, most_ports, 3>;

  const Propagator* body = nullptr;
  int port = 0;
  int count = 0;
  int width = 2;  ///< 1 + d
  Columns sense;  ///< gap, and slip with the opposite sign, per displacement
  Columns push;   ///< force per unit of λ_n and of friction
};

/// add_compliance() of contacts with two tangents and so many ports, of which a step has many.
/// @param W of the ports of `from` (columns) and `to` (rows)
template <int num_to, int num_from>
void add_compliance_of(const PortBlock& to, const PortBlock& from, const double* W,
                       std::size_t stride, Eigen::Ref<Eigen::MatrixXd>& block) {
  using Part = Eigen::Matrix<double, num_to, num_from>;
  const Eigen::Map<const Part, 0, Eigen::OuterStride<>> part(
      W, Eigen::OuterStride<>(static_cast<Eigen::Index>(stride)));
  const Eigen::Matrix<double, num_to, 3> moved =
      part.lazyProduct(from.push.template topRows<num_from>());
  const Eigen::Matrix3d added = to.sense.template topRows<num_to>().transpose().lazyProduct(moved);
  block.topLeftCorner<3, 3>() += added;
}

/// Adds sᵀ W p of two contacts, if both are on the same body: penetration and slip of the one that are
/// undone per force of the other.
/// @param ahead at t_{n+1}, by Propagator::ahead_compliances()
inline void add_compliance(const PortBlock& to, const PortBlock& from, bool ahead,
                           Eigen::Ref<Eigen::MatrixXd> block) {
  if (to.body != from.body) return;
  const auto stride = static_cast<std::size_t>(to.body->num_ports());
  const double* const W = ahead ? to.body->ahead_compliances() : to.body->compliances();
  if (to.width == 3 && from.width == 3 && to.count == from.count) {
    const double* const part = W + static_cast<std::size_t>(from.port) * stride + to.port;
    if (to.count == num_face_rows) {
      return add_compliance_of<num_face_rows, num_face_rows>(to, from, part, stride, block);
    }
    if (to.count == 3) return add_compliance_of<3, 3>(to, from, part, stride, block);
  }
  PortBlock::Columns moved;
  for (int c = 0; c < from.width; ++c) {
    for (int i = 0; i < to.count; ++i) {
      double sum = 0.0;
      for (int j = 0; j < from.count; ++j) {
        sum += W[static_cast<std::size_t>(from.port + j) * stride +
                 static_cast<std::size_t>(to.port + i)] *
               from.push(j, c);
      }
      moved(i, c) = sum;
    }
  }
  for (int c = 0; c < from.width; ++c) {
    for (int r = 0; r < to.width; ++r) {
      double sum = 0.0;
      for (int i = 0; i < to.count; ++i) sum += to.sense(i, r) * moved(i, c);
      block(r, c) += sum;
    }
  }
}

}  // namespace stridor
