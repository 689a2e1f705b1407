#include "coupling/system/system.hpp"

#include <algorithm>

namespace stridor {

const Drive& System::leading_drive() const {
  const auto is_followed = [&](std::size_t drive) {
    return std::any_of(bodies.begin(), bodies.end(), [&](const SystemBody& body) {
      return body.drive == static_cast<int>(drive);
    });
  };
  const Drive* leading = nullptr;
  for (std::size_t d = 0; d < drives.size(); ++d) {
    if (!is_followed(d)) continue;
    const TimeCurve& velocity = drives[d].velocity;
    if (velocity.value(velocity.constant_from()) != 0.0) return drives[d];
    if (leading == nullptr) leading = &drives[d];
  }
  return leading == nullptr ? drives.front() : *leading;
}

std::vector<int> System::master_rows(const ContactPoint& contact, int facet) const {
  if (contact.face) return {contact.face->rows.begin(), contact.face->rows.end()};
  const FacetSurface* const surface = facets_of(contact);
  std::vector<int> rows;
  if (surface == nullptr) return rows;
  const Facet& of = surface->facets[static_cast<std::size_t>(facet)];
  for (std::size_t k = 0; k < static_cast<std::size_t>(of.count); ++k) {
    const std::array<int, 3>& node = surface->rows[static_cast<std::size_t>(of.nodes[k])];
    rows.insert(rows.end(), node.begin(), node.end());
  }
  return rows;
}

int System::num_master_ports(const ContactPoint& contact) const {
  if (contact.face) return static_cast<int>(contact.face->rows.size());
  const FacetSurface* const surface = facets_of(contact);
  return surface == nullptr ? 0 : 3 * surface->max_nodes();
}

double System::path_share(int body) const {
  const Drive* const drive = drive_of(body);
  if (drive == nullptr) return 0.0;
  const Drive& leading = leading_drive();
  if (drive == &leading) return 1.0;
  const double of_leading = leading.velocity.value(leading.velocity.constant_from());
  // A leading drive at rest is displaced alone.
  return of_leading == 0.0 ? 0.0
                           : drive->velocity.value(drive->velocity.constant_from()) / of_leading;
}

}  // namespace stridor
