#include "models/face_contact_pair.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>

namespace stridor {
namespace {

const BodyFace& face_of(const ContactPair& pair, const ModelBody& master) {
  return master.matrices.faces.at(pair.master_name.substr(master.name.size() + 1));
}

/// Where the middle of a slave body stands.
struct FaceStart {
  double radius = 0.0;
  double angle = 0.0;
};

/// Refuses what means nothing on a face.
FaceStart check_face_pair(const ContactPair& pair, const BodyFace& face) {
  const ContactParameters& given = *pair.parameters;
  const auto refuse = [&](Refusal refusal, const char* key, const std::string& text) {
    throw ConfigError(refusal, pair.key_of(key), text);
  };
  if (!given.start.radius) {
    refuse(Refusal::wrong_value, "start",
           fmt::format("must be {{radius, angle}} on '{}', the face of a plate", pair.master_name));
  }
  const FaceStart start{*given.start.radius, given.start.angle.value_or(0.0)};
  if (!(start.radius > face.inner_radius && start.radius < face.outer_radius)) {
    refuse(Refusal::wrong_value, "start.radius",
           fmt::format("must lie between the edges of the plate, {:g} and {:g} m, "
                       "got {:g} m",
                       face.inner_radius, face.outer_radius, start.radius));
  }
  if (given.sliding == SlidingMode::frozen && face.spin != 0.0) {
    refuse(Refusal::wrong_value, "sliding",
           "`frozen` holds what a drive moves at its place; a plate spins in its own: contacts on "
           "it stay at their place as they are");
  }
  const ContactAssumption assumption = given.assumption_or_default();
  if (assumption == ContactAssumption::subs_a || assumption == ContactAssumption::subs_c) {
    refuse(Refusal::contradiction, "assumption",
           "must be subs_b or film on the face of a plate: contacts stay at their place, so that "
           "no motion is prescribed, and normal and place follow from the same slope");
  }
  if (given.surface != SurfaceKind::polyline) {
    refuse(Refusal::contradiction, "surface",
           "is of a curve through nodes; the face of a plate is smooth as it is");
  }
  if (given.roughness)
    refuse(Refusal::contradiction, "roughness", "is of a curve; the face of a plate has none");
  return start;
}

/// x of the slave body's middle, and the height of its contact points.
struct SlaveExtent {
  double middle = 0.0;
  double height = 0.0;
};

SlaveExtent extent_of_slave(const ContactPair& pair, const ModelBody& slave) {
  const auto x = slave.matrices.nodes.col(0);
  const auto y = slave.matrices.nodes.col(1);
  const double size = x.maxCoeff() - x.minCoeff() + y.maxCoeff() - y.minCoeff();
  const double height = y(pair.slave_nodes.front());
  for (std::size_t k = 1; k < pair.slave_nodes.size(); ++k) {
    const double gap = y(pair.slave_nodes[k]) - height;
    if (std::abs(gap) <= 1e-6 * size) continue;
    throw ConfigError(
        Refusal::off_the_surface, pair.key_of("slave"),
        fmt::format("slave point {} starts {:g} m away from the face '{}', which the "
                    "first one lies on; every slave point must lie on it at the start",
                    k + 1, gap, pair.master_name));
  }
  return {0.5 * (x.maxCoeff() + x.minCoeff()), height};
}

/// A slave that is elastic must be above its face.
void check_side_of_face(const ContactPair& pair, const ModelBody& slave, double height) {
  if (!slave.parameters->is_filled()) return;
  const double mean = slave.matrices.nodes.col(1).mean() - height;
  if (mean >= 0.0) return;
  throw ConfigError(Refusal::off_the_surface, pair.key_of("slave"),
                    fmt::format("'{}' starts inside the plate '{}', on average {:.3g} m deep: y of "
                                "its frame points away from the face; take a point or surface of "
                                "its lower side",
                                slave.name, pair.master_name, -mean));
}

/// Places the frame of a slave for figures: along the unrolled outer edge of the plate.
void place_on_face(const ContactPair& pair, const BodyFace& face, const FaceStart& start,
                   const SlaveExtent& extent, ModelBody& slave) {
  const Eigen::Vector3d place(face.outer_radius * start.angle - extent.middle,
                              face.half_thickness - extent.height, 0.0);
  const bool is_mirrored = face.side < 0;
  if (!slave.is_placed) {
    slave.place = place;
    slave.is_placed = true;
    slave.is_mirrored = is_mirrored;
    return;
  }
  const bool is_same =
      (slave.place - place).norm() <= 1e-9 * face.outer_radius && slave.is_mirrored == is_mirrored;
  if (is_same) return;
  throw ConfigError(Refusal::doubled_name, pair.key_of("start"),
                    fmt::format("'{}' is placed already by another contact, elsewhere; a body can "
                                "be placed by one pair only",
                                slave.name));
}

}  // namespace

void add_face_contacts(const ContactPair& pair, const PairDrive& drive,
                       std::vector<ModelBody>& bodies, System& system) {
  ModelBody& slave = bodies[static_cast<std::size_t>(pair.slave_body)];
  ModelBody& master = bodies[static_cast<std::size_t>(pair.master_body)];
  const BodyFace& face = face_of(pair, master);
  const FaceStart start = check_face_pair(pair, face);
  const SlaveExtent extent = extent_of_slave(pair, slave);
  check_side_of_face(pair, slave, extent.height);
  place_on_face(pair, face, start, extent, slave);
  for (std::size_t k = 0; k < pair.slave_nodes.size(); ++k) {
    const int node = pair.slave_nodes[k];
    slave.keep_node(node);
    ContactPoint point = make_contact_point(pair, k, drive);
    point.slave_rows = slave.rows_of(node);
    point.slave_position = slave.position(node);
    point.surface = -1;
    FacePlace place;
    place.name = pair.master_name;
    place.body = pair.master_body;
    place.radius = start.radius;
    place.turned = (slave.matrices.nodes(node, 0) - extent.middle) / start.radius;
    if (std::abs(place.turned) > std::numbers::pi) {
      throw ConfigError(Refusal::off_the_surface, pair.key_of("slave"),
                        fmt::format("slave point {} is {:g} m away from the middle of '{}', beyond "
                                    "half the circumference of {:g} m there",
                                    k + 1, std::abs(place.turned) * start.radius, slave.name,
                                    2.0 * std::numbers::pi * start.radius));
    }
    place.angle = start.angle + place.turned;
    place.half_thickness = face.half_thickness;
    place.side = face.side;
    place.spin = face.spin;
    const std::array<DofSum, 5> rows = face.rows(place.radius, place.angle);
    for (std::size_t i = 0; i < rows.size(); ++i) place.rows[i] = master.row_of(rows[i]);
    point.face = std::move(place);
    if (point.penalty)
      point.overlap = pair.parameters->normal.number("preload").value_or(0.0) / *point.penalty;
    system.contacts.push_back(std::move(point));
  }
}

std::vector<double> preloads_of(const std::vector<ContactPair>& pairs, const System& system) {
  std::vector<double> preloads(system.contacts.size(), 0.0);
  for (const ContactPair& pair : pairs) {
    for (std::size_t k = 0; k < pair.slave_nodes.size(); ++k) {
      for (std::size_t i = 0; i < preloads.size(); ++i) {
        if (system.contacts[i].name == pair.point_name(k))
          preloads[i] = pair.parameters->normal.number("preload").value_or(0.0);
      }
    }
  }
  return preloads;
}

void hold_preloads(const std::vector<double>& preloads, System& system) {
  const auto hold = [&](int b, int row, double force) {
    if (row < 0) return;
    SystemBody& body = system.bodies[static_cast<std::size_t>(b)];
    if (body.held_load.size() == 0) body.held_load = Eigen::VectorXd::Zero(body.reduced.size());
    body.held_load += force * body.reduced.rows.row(row).transpose();
  };
  for (std::size_t i = 0; i < preloads.size(); ++i) {
    const ContactPoint& contact = system.contacts[i];
    if (!contact.face || preloads[i] == 0.0) continue;
    const FacePlace& face = *contact.face;
    const double speed = face.spin * face.radius;
    const double friction = preloads[i] * sliding_friction(contact.friction, speed);
    // n = s (p_z − w) and b = p_φ + s (h/2) w_φ/r.
    hold(contact.slave_body, contact.slave_rows.y, -preloads[i]);
    hold(contact.slave_body, contact.slave_rows.x, -friction * std::cos(face.turned));
    hold(contact.slave_body, contact.slave_rows.z, friction * std::sin(face.turned));
    hold(face.body, face.rows[0], face.side * preloads[i]);
    hold(face.body, face.rows[2],
         -friction * face.side * face.half_thickness / face.radius);
  }
}

}  // namespace stridor
