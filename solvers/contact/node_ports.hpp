// Ports of a body at the nodes of its facets, shared by the contacts on them.
#pragma once

#include <array>
#include <map>
#include <span>
#include <vector>

#include "coupling/kinematics/facet_surface.hpp"
#include "solvers/integrators/propagator.hpp"

namespace stridor {

/// Three ports, x, y and z, for every node that some contact on the facets of a body needs: nodes that
/// several facets share are watched once, and those far from all contacts not at all.
///
/// A node keeps its ports while it is within two facets of a contact, so that a contact that moves to and
/// fro across an edge changes nothing; after that they serve the next node that a contact comes to. The body
/// gets more ports where none is free. They are its last ones.
class NodePorts {
 public:
  static constexpr int ports_per_node = 3;

  /// @param body referenced from here on; its other ports are all there
  explicit NodePorts(Propagator& body) : body_(&body), first_(body.num_ports()) {}

  /// Takes up a contact. @returns its number here
  /// @param surface referenced from here on
  int join(const FacetSurface& surface);
  /// Puts a contact on a facet. @returns the first port of each of its nodes
  std::array<int, 4> put(int contact, int facet);

  /// The first port of the first node.
  int first() const { return first_; }
  /// Takes up the ports of a saved state.
  /// @param rows all rows that the body watched
  /// @throws std::invalid_argument where these are not rows of nodes behind the other ports
  void restore(std::span<const double> rows);

 private:
  using Rows = std::array<int, ports_per_node>;  ///< of x, y and z of a node
  struct Contact {
    const FacetSurface* surface;
    int facet = 0;
  };

  int port_of(std::size_t slot) const { return first_ + ports_per_node * static_cast<int>(slot); }
  std::size_t slot_of(const Rows& rows);
  std::size_t free_slot();
  void mark_near(const Contact& contact, std::vector<char>& is_near) const;

  Propagator* body_;
  int first_;
  std::vector<Contact> contacts_;
  std::vector<Rows> slots_;
  std::map<Rows, std::size_t> slot_at_;
};

}  // namespace stridor
