#include "models/space_contact.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <stdexcept>

namespace stridor {
namespace {

Eigen::Vector3d vector_of(const std::vector<double>& components) {
  return {components[0], components[1], components[2]};
}

/// Refuses what means nothing in space.
void check_keys(const ContactPair& pair) {
  const ContactParameters& given = *pair.parameters;
  const auto refuse = [&](Refusal refusal, const char* key, const std::string& text) {
    throw ConfigError(refusal, pair.key_of(key), text);
  };
  const ContactAssumption assumption = given.assumption_or_default();
  if (assumption == ContactAssumption::subs_a || assumption == ContactAssumption::subs_c) {
    refuse(Refusal::contradiction, "assumption",
           "must be subs_b or film in space: place and normal are those of the deformed bodies");
  }
  if (given.start.along || given.start.radius) {
    refuse(Refusal::wrong_value, "start",
           "must be {at: [x, y, z]} in space, or be left out: bodies stand where their meshes have "
           "them");
  }
  if (given.roughness)
    refuse(Refusal::contradiction, "roughness", "is of a curve; in space there is none");
  if (given.normal.number("preload")) {
    refuse(Refusal::contradiction, "normal.preload",
           "is of the face of a plate; in space the loads of the drive press bodies "
           "together");
  }
  if (given.normal.law->has_area()) {
    refuse(Refusal::wrong_value, "normal.law",
           fmt::format("is that of a half-space in a plane; in space take {}",
                       normal_laws_with([](const NormalLawType& law) { return !law.has_area(); })));
  }
}

/// Diagonal of the box around the nodes of a body, m.
double extent_of(const ModelBody& body) {
  if (body.matrices.nodes.rows() == 0) return 0.0;
  return (body.matrices.nodes.colwise().maxCoeff() - body.matrices.nodes.colwise().minCoeff())
      .norm();
}

void place_slave(const ContactPair& pair, ModelBody& slave) {
  const std::vector<double>& at = pair.parameters->start.at;
  if (at.empty()) {
    slave.is_placed = true;
    return;
  }
  const Eigen::Vector3d shift = vector_of(at) - slave.place_of(pair.slave_nodes.front());
  const double size = extent_of(slave);
  if (slave.is_placed && shift.norm() > 1e-9 * std::max(size, vector_of(at).norm())) {
    throw ConfigError(
        Refusal::doubled_name, pair.key_of("start"),
        fmt::format("'{}' is placed already, and its point stands {:g} m away from the "
                    "place asked for; a body can be placed by one pair only",
                    slave.name, shift.norm()));
  }
  if (!slave.is_placed) slave.place += shift;
  slave.is_placed = true;
}

/// The facets of the master, with rows for all of their nodes.
FacetSurface make_facets(const ContactPair& pair, ModelBody& master) {
  FacetSurface surface;
  surface.name = pair.master_name;
  surface.body = pair.master_body;
  surface.facets = master.matrices.facets.at(pair.surface_name());
  if (const auto& spin = master.matrices.spin) {
    surface.spin = spin->speed * spin->direction;
    surface.axis_point = spin->point + master.place;
  }
  std::vector<int> nodes;
  for (const Facet& facet : surface.facets)
    nodes.insert(nodes.end(), facet.nodes.begin(), facet.nodes.begin() + facet.count);
  std::sort(nodes.begin(), nodes.end());
  nodes.erase(std::unique(nodes.begin(), nodes.end()), nodes.end());
  for (const int node : nodes) {
    master.keep_node(node);
    std::array<int, 3> rows{};
    for (std::size_t i = 0; i < 3; ++i) rows[i] = master.row_of(master.matrices.displacement(node, i));
    surface.rows.push_back(rows);
    surface.positions.push_back(master.place_of(node));
  }
  for (Facet& facet : surface.facets) {
    for (std::size_t k = 0; k < static_cast<std::size_t>(facet.count); ++k) {
      facet.nodes[k] = static_cast<int>(
          std::lower_bound(nodes.begin(), nodes.end(), facet.nodes[k]) - nodes.begin());
    }
  }
  try {
    connect_facets(surface, pair.parameters->surface);
  } catch (const std::invalid_argument& error) {
    throw ConfigError(Refusal::wrong_value, pair.key_of("master"),
                      fmt::format("'{}' {}", pair.master_name, error.what()));
  }
  return surface;
}

SpacePlace plane_of(const ContactPair& pair, const ModelBody& slave) {
  SpacePlace plane;
  plane.origin = slave.place_of(pair.slave_nodes.front());
  if (const auto& given = pair.parameters->plane) {
    if (!given->normal.empty()) plane.normal = vector_of(given->normal).normalized();
    if (!given->point.empty()) plane.origin = vector_of(given->point);
  }
  return plane;
}

/// Refuses a slave whose middle lies on the inner side of its master.
void check_side(const ContactPair& pair, const ModelBody& slave, const Eigen::Vector3d& normal) {
  Eigen::Vector3d touched = Eigen::Vector3d::Zero();
  for (const int node : pair.slave_nodes) touched += slave.matrices.nodes.row(node).transpose();
  touched /= static_cast<double>(pair.slave_nodes.size());
  const Eigen::Vector3d middle = slave.matrices.nodes.colwise().mean().transpose();
  const double height = normal.dot(middle - touched);
  if (!slave.parameters->is_spatial() || height >= 0.0) return;
  throw ConfigError(
      Refusal::off_the_surface, pair.key_of("slave"),
      fmt::format(
          "'{}' starts on the inner side of its master '{}': its middle lies {:.3g} m behind "
          "the surface; take its surface on the other side, or {}",
          slave.name, pair.master_name, -height,
          pair.is_on_facets ? "another surface of the master"
                            : "turn plane.normal towards the slave"));
}

/// Where one slave point stands.
struct Standing {
  SpacePlace place;
  double gap = 0.0;  ///< m
};

Standing stand(const ContactPair& pair, std::size_t k, const SpacePlace& master,
               const FacetSurface* surface, const ModelBody& slave) {
  Standing standing{master, 0.0};
  SpacePlace& place = standing.place;
  place.slave = slave.place_of(pair.slave_nodes[k]);
  Eigen::Vector2d at = Eigen::Vector2d::Zero();
  if (surface != nullptr) {
    const FacetPlace found = locate_on(*surface, place.slave);
    if (found.facet < 0) {
      throw ConfigError(
          Refusal::off_the_surface, pair.key_of("slave"),
          fmt::format(
              "slave point {} of '{}', at ({:.6g}, {:.6g}, {:.6g}) m, is beside the surface "
              "'{}'; every slave point must stand over it at the start",
              k + 1, slave.name, place.slave.x(), place.slave.y(), place.slave.z(),
              pair.master_name));
    }
    place.first_facet = found.facet;
    at = {found.xi, found.eta};
  }
  const Eigen::Index num_ports = surface == nullptr ? 3 : 3 * surface->max_nodes() + 3;
  const SpaceInstant instant =
      space_instant(place, surface, place.first_facet, 0.0, TangentPorts::Zero(num_ports));
  Eigen::Vector3d normal = place.normal;
  if (surface != nullptr) normal = space_geometry(instant, at).frame.normal;
  place.normal = normal;
  place.reference = reference_for(normal);
  standing.gap = normal.dot(instant.slave) -
                 (surface == nullptr
                      ? 0.0
                      : normal.dot(instant.undeformed.at(at.x(), at.y()).place));
  return standing;
}

}  // namespace

void add_space_contacts(const ContactPair& pair, const PairDrive& drive,
                        std::vector<ModelBody>& bodies, System& system) {
  check_keys(pair);
  ModelBody& slave = bodies[static_cast<std::size_t>(pair.slave_body)];
  ModelBody& master = bodies[static_cast<std::size_t>(pair.master_body)];
  place_slave(pair, slave);
  SpacePlace on;
  const FacetSurface* surface = nullptr;
  if (pair.is_on_facets) {
    on.surface = static_cast<int>(system.facet_surfaces.size());
    surface = &system.facet_surfaces.emplace_back(make_facets(pair, master));
  } else {
    on = plane_of(pair, slave);
  }
  on.name = pair.master_name;
  on.body = pair.master_body;
  const double size = std::max(extent_of(slave), surface == nullptr ? 0.0 : surface->extent());
  const double closed = pair.parameters->adjust.value_or(1e-6 * size);
  Eigen::Vector3d normal = Eigen::Vector3d::Zero();
  for (std::size_t k = 0; k < pair.slave_nodes.size(); ++k) {
    const int node = pair.slave_nodes[k];
    slave.keep_node(node);
    ContactPoint point = make_contact_point(pair, k, drive);
    point.slave_rows = slave.rows_of(node);
    point.slave_position = slave.position(node);
    point.surface = -1;
    const Standing standing = stand(pair, k, on, surface, slave);
    point.space = standing.place;
    if (std::abs(standing.gap) <= closed) point.overlap = standing.gap;
    normal += standing.place.normal;
    system.contacts.push_back(std::move(point));
  }
  if (normal.norm() > 0.0) check_side(pair, slave, normal.normalized());
}

}  // namespace stridor
