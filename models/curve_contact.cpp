#include "models/curve_contact.hpp"

#include <fmt/format.h>

#include <cmath>

namespace stridor {
namespace {

/// Largest difference in height of two slave points of one body, m.
double height_of_roughness(const ContactParameters& parameters) {
  constexpr double never_exceeded = 20.0;
  return parameters.roughness ? never_exceeded * parameters.roughness->rms : 0.0;
}

/// @param length of the master, m
Roughness make_roughness(const ContactPair& pair, double length) {
  const std::optional<RoughnessParameters>& given = pair.parameters->roughness;
  if (!given || given->rms == 0.0) return {};
  const double least = length / Roughness::max_correlation_lengths;
  if (!(given->correlation_length >= least)) {
    throw ConfigError(
        Refusal::wrong_value, pair.key + ".roughness.correlation_length",
        fmt::format("{:g} m is too small for a master of {:g} m, on which it takes {:g} m at least",
                    given->correlation_length, length, least));
  }
  return Roughness(*given, length);
}

MasterSurface make_surface(const ContactPair& pair, ModelBody& body) {
  MasterSurface surface;
  surface.name = pair.master_name;
  surface.body = pair.master_body;
  surface.kind = pair.parameters->surface;
  if (is_endless_master(pair.master_name)) {
    if (pair.parameters->roughness) {
      throw ConfigError(Refusal::missing, pair.key + ".roughness",
                        fmt::format("the master `{}` has no end, a rough surface needs one; take "
                                    "the surface of a body",
                                    pair.master_name));
    }
    surface.rows = {{0, 0}, {0, 0}};
    surface.positions = {Eigen::Vector2d(0.0, 0.0), Eigen::Vector2d(1.0, 0.0)};
    surface.arc_length = {0.0, 1.0};
    surface.is_endless = true;
    return surface;
  }
  double arc = 0.0;
  for (std::size_t k = 0; k < pair.master_nodes.size(); ++k) {
    if (k > 0) arc += (body.matrices.nodes.row(pair.master_nodes[k]) -
              body.matrices.nodes.row(pair.master_nodes[k - 1]))
                 .norm();
    surface.rows.push_back(body.rows_of(pair.master_nodes[k]));
    surface.positions.push_back(body.position(pair.master_nodes[k]));
    surface.arc_length.push_back(arc);
  }
  surface.roughness = make_roughness(pair, arc);
  return surface;
}

/// Point at an arc length of the undeformed surface.
Eigen::Vector2d point_at(const MasterSurface& surface, double arc) {
  int segment = 0;
  while (segment + 1 < surface.num_segments() &&
         surface.arc_length[static_cast<std::size_t>(segment) + 1] < arc)
    ++segment;
  const auto s = static_cast<std::size_t>(segment);
  const double xi =
      (arc - surface.arc_length[s]) / (surface.arc_length[s + 1] - surface.arc_length[s]);
  return (1.0 - xi) * surface.positions[s] + xi * surface.positions[s + 1];
}

/// Straight segment under a point of the undeformed configuration, from a first guess on: the first
/// one whose end the point has not passed.
int chord_under(const MasterSurface& surface, const Eigen::Vector2d& point, int segment) {
  const auto is_past = [&](int s) {
    return project(surface.undeformed_segment(s), point).xi > 1.0;
  };
  while (segment > 0 && !is_past(segment - 1)) --segment;
  while (segment + 1 < surface.num_segments() && is_past(segment)) ++segment;
  return segment;
}

/// Segment under a point of the undeformed configuration, and the projection; xi outside [0, 1]
/// where the point is off the surface.
std::pair<int, Projection> locate_on(const MasterSurface& surface, const Eigen::Vector2d& point) {
  // A projection on a smooth segment is solved for, so the chords say where to begin.
  int segment = chord_under(surface, point, 0);
  Projection projection = surface.project_undeformed(segment, point);
  while (projection.xi < 0.0 && segment > 0)
    projection = surface.project_undeformed(--segment, point);
  while (projection.xi > 1.0 && segment + 1 < surface.num_segments())
    projection = surface.project_undeformed(++segment, point);
  return {segment, projection};
}

void place_slave(const ContactPair& pair, const MasterSurface& surface, ModelBody& slave) {
  if (pair.parameters->start.radius) {
    throw ConfigError(
        Refusal::contradiction, pair.key_of("start"),
        fmt::format("must be a length along the master '{}'; {{radius, angle}} is for "
                    "the face of a plate",
                    surface.name));
  }
  const double start = pair.parameters->start.along.value_or(0.0);
  const double length = surface.arc_length.back();
  if (!surface.is_endless && start > length * (1.0 + 1e-12)) {
    throw ConfigError(
        Refusal::off_the_surface, pair.key + ".start",
        fmt::format("{:g} m is off the master '{}', which is {:g} m long; allowed: 0 to {:g} m",
                    start, surface.name, length, length));
  }
  // On the rough surface, so that the contact begins closed.
  const auto [segment, projection] = locate_on(surface, point_at(surface, start));
  const Eigen::Vector2d target =
      point_at(surface, start) +
      surface.roughness_at(segment, projection.weights) * projection.normal;
  const Eigen::Vector2d shift = target - slave.position(pair.slave_nodes.front());
  if (!slave.is_placed) {
    slave.place.head<2>() += shift;
    slave.is_placed = true;
  } else if (shift.norm() > 1e-9 * length + height_of_roughness(*pair.parameters)) {
    throw ConfigError(Refusal::doubled_name, pair.key + ".start",
                      fmt::format("'{}' is placed already, and its point stands {:g} m away from "
                                  "the {:g} m asked for; a body can be "
                                  "placed by one pair only",
                                  slave.name, shift.norm(), start));
  }
}

/// Refuses a filled slave of which the part over the master lies on the inner side of its surface.
void check_side(const ContactPair& pair, const MasterSurface& surface, const ModelBody& slave) {
  if (!slave.parameters->is_filled()) return;
  double height = 0.0;
  int num_over = 0;
  int segment = 0;
  for (int node = 0; node < static_cast<int>(slave.matrices.nodes.rows()); ++node) {
    const Eigen::Vector2d position = slave.position(node);
    // Neighbouring nodes are over neighbouring chords, and chords suffice to tell the sides apart.
    segment = chord_under(surface, position, segment);
    const Segment chord = surface.undeformed_segment(segment);
    const Projection projection = project(chord, position);
    if (!surface.is_endless && (projection.xi < 0.0 || projection.xi > 1.0)) continue;
    height += projection.normal.dot(position - chord.first);
    ++num_over;
  }
  if (num_over == 0 || height >= 0.0) return;
  throw ConfigError(
      Refusal::off_the_surface, pair.key + ".slave",
      fmt::format("'{}' starts on the inner side of its master '{}', on average {:.3g} m deep; "
                  "turn it (substructures.{}.angle), or take a point or edge of its other side",
                  slave.name, surface.name, -height / num_over, slave.name));
}

/// Contact k of a pair, under which the surface has its number in the system.
ContactPoint make_curve_contact(const ContactPair& pair, std::size_t k,
                                const PairDrive& drive, const MasterSurface& surface,
                                ModelBody& slave) {
  const int node = pair.slave_nodes[k];
  slave.keep_node(node);
  ContactPoint point = make_contact_point(pair, k, drive);
  point.slave_rows = slave.rows_of(node);
  point.slave_position = slave.position(node);
  const auto [segment, projection] = locate_on(surface, point.slave_position);
  const double length = surface.arc_length.back();
  const double rounding = 1e-9;
  if (!surface.is_endless && (projection.xi < -rounding || projection.xi > 1.0 + rounding)) {
    throw ConfigError(
        Refusal::off_the_surface, pair.key_of("start"),
        fmt::format("slave point {} starts off the end of the master '{}'", k + 1, surface.name));
  }
  const double gap = projection.normal.dot(point.slave_position -
                                           surface.positions[static_cast<std::size_t>(segment)]);
  if (std::abs(gap) > 1e-6 * length + height_of_roughness(*pair.parameters)) {
    throw ConfigError(Refusal::off_the_surface, pair.key_of("slave"),
                      fmt::format("slave point {} starts {:g} m away from the master '{}'; "
                                  "every slave point must lie on it at the "
                                  "start",
                                  k + 1, gap, surface.name));
  }
  point.first_segment = segment;
  return point;
}

}  // namespace

void add_curve_contacts(const ContactPair& pair, const PairDrive& drive,
                        std::vector<ModelBody>& bodies, System& system) {
  if (pair.parameters->normal.number("preload")) {
    throw ConfigError(Refusal::contradiction, pair.key_of("normal.preload"),
                      "is of a contact on the face of a plate; on a curve the loads of the drive "
                      "press bodies together");
  }
  if (!pair.parameters->start.at.empty()) {
    throw ConfigError(Refusal::contradiction, pair.key_of("start"),
                      "must be a length along the master; {at} is for contacts "
                      "in space");
  }
  ModelBody& slave = bodies[static_cast<std::size_t>(pair.slave_body)];
  ModelBody& master = bodies[static_cast<std::size_t>(pair.master_body)];
  MasterSurface surface = make_surface(pair, master);
  place_slave(pair, surface, slave);
  check_side(pair, surface, slave);
  for (const int node : pair.master_nodes) master.keep_node(node);
  for (std::size_t k = 0; k < pair.slave_nodes.size(); ++k) {
    ContactPoint point = make_curve_contact(pair, k, drive, surface, slave);
    point.surface = static_cast<int>(system.surfaces.size());
    system.contacts.push_back(std::move(point));
  }
  system.surfaces.push_back(std::move(surface));
}

}  // namespace stridor
