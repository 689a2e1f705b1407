// What the forces of contacts with two tangents do to each other's gaps and slips.
#pragma once

#include <Eigen/Core>
#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "coupling/kinematics/tangent_kinematics.hpp"
#include "solvers/integrators/propagator.hpp"

namespace stridor {

/// Directions of a contact at each of its ports: normal, two tangents, and nothing.
struct FaceDirections {
  using Row = std::array<double, 4>;
  using Ports = std::array<Row, max_tangent_ports>;
  std::size_t count = 0;  ///< of ports, those of the master first
  Ports sense{};          ///< gap, and slip with the opposite sign, per displacement
  Ports push{};           ///< force per unit of λ_n and of friction
};

/// Ports of a contact on one of its bodies.
struct FaceSide {
  std::size_t contact = 0;
  std::size_t first = 0;  ///< among the ports of the contact
  std::size_t count = 0;
  std::array<std::size_t, max_facet_ports> ports{};  ///< of the body
};

/// Blocks sᵀ W p of all pairs of contacts with two tangents (docs/theory.md, 10.6). Contacts are gathered by the
/// body that they touch: pairs without a common body are not visited.
class FaceCompliances {
 public:
  /// Puts the next contact between two bodies.
  /// @param slave_ports, master_ports of these; those of the master may change from step to step
  void add(const Propagator& slave, const Propagator& master, std::span<const int> slave_ports,
           std::span<const int> master_ports);

  /// Directions of a contact, whose gap and slip are sought at once until seek() tells otherwise.
  /// @param master_ports as many as in add()
  void direct(std::size_t contact, const FaceDirections& directions,
              std::span<const int> master_ports);
  /// Where gap and slip are sought: at once, or at t_{n+1}.
  void seek(std::size_t contact, bool gap_ahead, bool slip_ahead);

  /// Writes the blocks of all pairs, unless nothing has changed since they were written last.
  /// @param delassus a square of three rows for every contact, as this has left it
  /// @return whether they have been written
  /// Cost: per body with p ports and c contacts of k ports there, 3 k (p + c) c.
  bool fill(Eigen::Ref<Eigen::MatrixXd> delassus);

  /// A contact with its directions.
  struct Contact {
    FaceDirections directions;
    bool seeks_gap_ahead = false;
    bool seeks_slip_ahead = false;
  };

 private:
  struct Body {
    const Propagator* propagator;
    std::vector<FaceSide> sides;
    std::uint64_t version = 0;  ///< of its compliances, as of the last fill()
  };
  struct Place {
    std::size_t body, side;
  };
  Place add_side(const Propagator& body, const FaceSide& side);

  std::vector<Contact> contacts_;
  std::vector<Place> masters_;  ///< of the contacts, where they have ports of a master
  std::vector<Body> bodies_;
  std::vector<double> moved_;  ///< scratch
  bool has_changed_ = true;    ///< directions, since the last fill()
};

}  // namespace stridor
