#include "solvers/contact/node_ports.hpp"

#include <algorithm>
#include <stdexcept>

namespace stridor {
namespace {

std::size_t at(int index) {
  return static_cast<std::size_t>(index);
}

/// The facet, and those up to two edges away.
std::vector<int> facets_around(const FacetSurface& surface, int facet) {
  std::vector<int> around{facet};
  std::size_t first = 0;
  for (int ring = 0; ring < 2; ++ring) {
    const std::size_t last = around.size();
    for (; first < last; ++first) {
      const int from = around[first];
      for (int k = 0; k < surface.facets[at(from)].count; ++k) {
        const int next = surface.neighbours[at(from)][at(k)];
        if (next >= 0 && std::find(around.begin(), around.end(), next) == around.end())
          around.push_back(next);
      }
    }
  }
  return around;
}

}  // namespace

int NodePorts::join(const FacetSurface& surface) {
  contacts_.push_back({&surface, -1});
  return static_cast<int>(contacts_.size()) - 1;
}

std::array<int, 4> NodePorts::put(int contact, int facet) {
  Contact& of = contacts_[at(contact)];
  of.facet = facet;
  std::array<int, 4> ports{};
  const Facet& on = of.surface->facets[at(facet)];
  for (int k = 0; k < on.count; ++k)
    ports[at(k)] = port_of(slot_of(of.surface->rows[at(on.nodes[at(k)])]));
  return ports;
}

std::size_t NodePorts::slot_of(const Rows& rows) {
  const auto found = slot_at_.find(rows);
  if (found != slot_at_.end()) return found->second;
  const std::size_t slot = free_slot();
  slots_[slot] = rows;
  slot_at_.emplace(rows, slot);
  for (int i = 0; i < ports_per_node; ++i) body_->watch(port_of(slot) + i, rows[at(i)]);
  return slot;
}

std::size_t NodePorts::free_slot() {
  std::vector<char> is_near(slots_.size(), 0);
  for (const Contact& contact : contacts_) mark_near(contact, is_near);
  const auto free = std::find(is_near.begin(), is_near.end(), char{0});
  const auto slot = static_cast<std::size_t>(free - is_near.begin());
  if (free != is_near.end()) {
    slot_at_.erase(slots_[slot]);
    return slot;
  }
  slots_.emplace_back();
  body_->set_num_ports(port_of(slots_.size()));
  return slot;
}

void NodePorts::mark_near(const Contact& contact, std::vector<char>& is_near) const {
  if (contact.facet < 0) return;
  for (const int facet : facets_around(*contact.surface, contact.facet)) {
    const Facet& of = contact.surface->facets[at(facet)];
    for (int k = 0; k < of.count; ++k) {
      const auto found = slot_at_.find(contact.surface->rows[at(of.nodes[at(k)])]);
      if (found != slot_at_.end()) is_near[found->second] = 1;
    }
  }
}

void NodePorts::restore(std::span<const double> rows) {
  const std::size_t others = at(first_);
  if (rows.size() < others || (rows.size() - others) % ports_per_node != 0)
    throw std::invalid_argument("NodePorts::restore: the state is of another body");
  slots_.clear();
  slot_at_.clear();
  for (std::size_t port = others; port < rows.size(); port += ports_per_node) {
    Rows node;
    for (std::size_t i = 0; i < node.size(); ++i) node[i] = static_cast<int>(rows[port + i]);
    if (!slot_at_.emplace(node, slots_.size()).second)
      throw std::invalid_argument("NodePorts::restore: the state has a node twice");
    slots_.push_back(node);
  }
  body_->set_num_ports(port_of(slots_.size()));
}

}  // namespace stridor
