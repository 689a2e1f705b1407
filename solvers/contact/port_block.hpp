// A contact at the ports of one body.
#pragma once

#include <Eigen/Core>

#include "coupling/kinematics/face_kinematics.hpp"
#include "coupling/kinematics/surface.hpp"
#include "solvers/integrators/propagator.hpp"

namespace stridor {

/// What a contact sees of the displacements of a body, and how its forces act. Columns: the normal, then
/// the tangents; rows: the ports of the body from `port` on.
struct PortBlock {
  static constexpr int most_ports = 2 * max_stencil;
  using Columns = Eigen::Matrix<double, most_ports, 3>;

  const Propagator* body = nullptr;
  int port = 0;
  int count = 0;
  int width = 2;  ///< 1 + d
  Columns sense;  ///< gap, and slip with the opposite sign, per displacement
  Columns push;   ///< force per unit of λ_n and of friction
};

/// Adds sᵀ W p of two contacts, if both are on the same body: penetration and slip of the one that are
/// undone per force of the other.
/// @param ahead at t_{n+1}, by Propagator::ahead_compliances()
inline void add_compliance(const PortBlock& to, const PortBlock& from, bool ahead,
                           Eigen::Ref<Eigen::MatrixXd> block) {
  if (to.body != from.body) return;
  const auto stride = static_cast<std::size_t>(to.body->num_ports());
  const double* const W = ahead ? to.body->ahead_compliances() : to.body->compliances();
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
