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

StartingGap starting_gap(const System& system, int index) {
  const ContactPoint& contact = system.contacts[static_cast<std::size_t>(index)];
  if (contact.face) return {index, gap_on_face(system, contact), Eigen::Vector2d::UnitY()};
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
              projection.normal};
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
  return share * (contact.face ? contact.face->radius : system.surface_of(contact).arc_length.back());
}

}  // namespace stridor
