#include "solvers/contact/starting_gap.hpp"

#include "coupling/kinematics/face_kinematics.hpp"

namespace stridor {
namespace {

const SystemBody& body_at(const System& system, int index) {
  return system.bodies[static_cast<std::size_t>(index)];
}

/// Initial displacement of a point of a body, m.
Eigen::Vector2d displaced(const SystemBody& body, const PointRows& rows) {
  if (body.initial_displacement.size() == 0) return Eigen::Vector2d::Zero();
  return {body.reduced.rows.row(rows.x).dot(body.initial_displacement),
          body.reduced.rows.row(rows.y).dot(body.initial_displacement)};
}

/// Slave and master of one contact as seen from the undeformed T1 of a segment.
struct Setting {
  SurfacePiece undeformed;
  SurfacePiece deformed;
  Eigen::Vector2d slave;       ///< undeformed, moved by drives
  Eigen::Vector2d slave_moved; ///< by its initial displacement too
};

Setting setting_of(const System& system, const ContactPoint& contact, int segment) {
  const MasterSurface& surface = system.surface_of(contact);
  const SystemBody& master = body_at(system, surface.body);
  Setting setting;
  setting.undeformed = surface.undeformed_piece(segment);
  setting.deformed = setting.undeformed;
  for (int k = 0; k < setting.deformed.stencil.count; ++k) {
    const auto node = static_cast<std::size_t>(setting.deformed.stencil.first + k);
    setting.deformed.nodes[static_cast<std::size_t>(k)] += displaced(master, surface.rows[node]);
  }
  setting.slave = contact.slave_position -
                  surface.positions[static_cast<std::size_t>(segment)] +
                  Eigen::Vector2d(system.driven_motion(contact).displacement(0.0), 0.0);
  setting.slave_moved =
      setting.slave + displaced(body_at(system, contact.slave_body), contact.slave_rows);
  return setting;
}

Projection projection_in(const Setting& setting, ContactAssumption assumption) {
  constexpr double guess = 0.5;
  switch (assumption) {
    case ContactAssumption::subs_b:
    case ContactAssumption::film:
      return project(setting.deformed, setting.slave_moved, guess);
    case ContactAssumption::subs_c:
      return project_along(setting.deformed, setting.slave_moved, setting.undeformed, guess);
    case ContactAssumption::subs_a:
      break;
  }
  return project(setting.undeformed, setting.slave, guess);
}

/// On a face, less the overlap of the contact.
double gap_on_face(const System& system, const ContactPoint& contact) {
  const auto displaced_row = [&](int body, int row) {
    const SystemBody& of = body_at(system, body);
    return row < 0 || of.initial_displacement.size() == 0
               ? 0.0
               : of.reduced.rows.row(row).dot(of.initial_displacement);
  };
  FacePorts ports;
  for (int k = 0; k < num_face_rows; ++k)
    ports[k] = displaced_row(contact.face->body, contact.face->rows[static_cast<std::size_t>(k)]);
  ports.tail<3>() << displaced_row(contact.slave_body, contact.slave_rows.x),
      displaced_row(contact.slave_body, contact.slave_rows.y),
      displaced_row(contact.slave_body, contact.slave_rows.z);
  return make_face_kinematics(*contact.face).gap(ports) - contact.overlap;
}

/// In space, likewise.
StartingGap gap_in_space(const System& system, int index) {
  const ContactPoint& contact = system.contacts[static_cast<std::size_t>(index)];
  const SpacePlace& space = *contact.space;
  const FacetSurface* const surface = system.facets_of(contact);
  FacetPlace place{space.first_facet, 0.4, 0.4};
  FacetSearch search;
  while (true) {
    TangentPorts ports = TangentPorts::Zero(system.num_master_ports(contact) + 3);
    const auto put = [&](Eigen::Index port, int of, int row) {
      const SystemBody& body = body_at(system, of);
      if (row >= 0 && body.initial_displacement.size() > 0)
        ports[port] = body.reduced.rows.row(row).dot(body.initial_displacement);
    };
    Eigen::Index port = 0;
    for (const int row : system.master_rows(contact, place.facet)) put(port++, space.body, row);
    for (int i = 0; i < 3; ++i)
      put(system.num_master_ports(contact) + i, contact.slave_body, contact.slave_rows.row(i));
    const SpaceInstant instant = space_instant(
        space, surface, place.facet, system.driven_motion(contact).displacement(0.0), ports);
    if (surface != nullptr) {
      const Eigen::Vector2d found =
          closest_on(instant.deformed, instant.slave, {place.xi, place.eta});
      place.xi = found.x();
      place.eta = found.y();
      if (search.look(*surface, place) == FacetSearch::Step::moved) continue;
    }
    const SpaceGeometry geometry = space_geometry(instant, {place.xi, place.eta});
    return {index, geometry.gap - contact.overlap, geometry.frame.normal};
  }
}

StartingGap starting_gap(const System& system, int index) {
  const ContactPoint& contact = system.contacts[static_cast<std::size_t>(index)];
  if (contact.face) return {index, gap_on_face(system, contact), Eigen::Vector3d::UnitY()};
  if (contact.space) return gap_in_space(system, index);
  const MasterSurface& surface = system.surface_of(contact);
  int segment = contact.first_segment;
  int heading = 0;
  while (true) {
    const Setting setting = setting_of(system, contact, segment);
    const Projection projection = projection_in(setting, contact.assumption);
    // Towards the segment under the slave, never turning back.
    const int wanted = projection.xi > 1.0 ? 1 : projection.xi < 0.0 ? -1 : 0;
    const int next = segment + wanted;
    if (wanted == 0 || wanted == -heading || next < 0 || next >= surface.num_segments()) {
      const Eigen::Vector2d arm =
          setting.slave_moved - setting.deformed.combine(projection.weights);
      return {index,
              projection.normal.dot(arm) - surface.roughness_at(segment, projection.weights),
              Eigen::Vector3d(projection.normal.x(), projection.normal.y(), 0.0)};
    }
    segment = next;
    heading = wanted;
  }
}

}  // namespace

std::vector<StartingGap> starting_gaps(const System& system) {
  std::vector<StartingGap> gaps;
  gaps.reserve(system.contacts.size());
  for (std::size_t i = 0; i < system.contacts.size(); ++i)
    gaps.push_back(starting_gap(system, static_cast<int>(i)));
  return gaps;
}

double negligible_gap(const System& system, const ContactPoint& contact) {
  constexpr double share = 1e-9;
  if (contact.face) return share * contact.face->radius;
  if (contact.space) {
    const FacetSurface* const surface = system.facets_of(contact);
    const SpacePlace& space = *contact.space;
    return share * (surface != nullptr ? surface->extent()
                                       : std::max(1.0, (space.slave - space.origin).norm()));
  }
  return share * system.surface_of(contact).arc_length.back();
}

}  // namespace stridor
