// What the forces of contacts with two tangents do to each other's gaps and slips.
#pragma once

#include <Eigen/Core>
#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "coupling/kinematics/tangent_kinematics.hpp"
#include "solvers/integrators/propagator.hpp"

namespace stridor {

/// Directions of a contact at each of its ports: normal, two tangents, and nothing.
struct FaceDirections {
  using Ports = std::array<std::array<double, 4>, max_tangent_ports>;
  Ports at_once{};  ///< sense of what is sought at once
  Ports ahead{};    ///< sense of what is sought at t_{n+1}
  Ports push{};     ///< force per unit of λ_n and of friction
  bool seeks_at_once = true;
  bool seeks_ahead = false;
};

/// Ports of a contact on one of its bodies.
struct FaceSide {
  std::size_t contact = 0;
  std::size_t first = 0;  ///< among the ports of the contact
  std::size_t port = 0;   ///< of the body
  std::size_t count = 0;
};

/// Blocks sᵀ W p of all pairs of contacts with two tangents (docs/theory.md, 10.6). Contacts are gathered by the
/// body that they touch: pairs without a common body are not visited.
class FaceCompliances {
 public:
  using Directions = Eigen::Matrix<double, Eigen::Dynamic, 3, 0, max_tangent_ports, 3>;

  /// Puts the next contact between two bodies.
  /// @param num_slave_ports 2 or 3
  void add(const Propagator& slave, const Propagator& master, int slave_port, int master_port,
           int num_slave_ports, int num_master_ports);

  /// Directions of a contact, and where its gap and its slip are sought: at once, or at t_{n+1}.
  /// @param sense gap, and slip with the opposite sign, per displacement of its ports
  /// @param push  force per unit of λ_n and of friction
  void direct(std::size_t contact, const Directions& sense, const Directions& push);
  void seek(std::size_t contact, bool gap_ahead, bool slip_ahead);

  /// Writes the blocks of all pairs, unless nothing has changed since they were written last.
  /// @param delassus a square of three rows for every contact, as this has left it
  /// @return whether they have been written
  bool fill(Eigen::Ref<Eigen::MatrixXd> delassus);

 private:
  struct Body {
    const Propagator* propagator;
    std::vector<FaceSide> sides;
    std::uint64_t version = 0;  ///< of its compliances, as of the last fill()
  };
  void add_side(const Propagator& body, const FaceSide& side);

  std::vector<FaceDirections> directions_;
  std::vector<Directions> sense_;
  std::vector<Body> bodies_;
  bool has_changed_ = true;  ///< directions, since the last fill()
};

}  // namespace stridor
