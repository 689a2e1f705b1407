// A contact at the ports of one body.
#pragma once

#include <Eigen/Core>
#include <array>

#include "coupling/kinematics/tangent_kinematics.hpp"
#include "coupling/kinematics/surface.hpp"
#include "solvers/integrators/propagator.hpp"

namespace stridor {

/// What a contact sees of the displacements of a body, and how its forces act. Columns: the normal, then
/// the tangents; rows: its ports.
struct PortBlock {
  static constexpr int most_ports = max_facet_ports;
  using Columns = Eigen::Matrix<double, most_ports, 3>;

  const Propagator* body = nullptr;
  std::array<int, most_ports> ports{};  ///< of the body, the first `count` of them
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
  const auto port = [](const PortBlock& of, int k) {
    return static_cast<std::size_t>(of.ports[static_cast<std::size_t>(k)]);
  };
  PortBlock::Columns moved;
  for (int c = 0; c < from.width; ++c) {
    for (int i = 0; i < to.count; ++i) {
      double sum = 0.0;
      for (int j = 0; j < from.count; ++j)
        sum += W[port(from, j) * stride + port(to, i)] * from.push(j, c);
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
