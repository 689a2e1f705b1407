#include "models/contact_pair.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "core/suggestion.hpp"

namespace stridor {
namespace {

double distance_of_nodes(const BodyMatrices& body, const std::vector<int>& nodes, std::size_t k) {
  return (body.nodes.row(nodes[k + 1]) - body.nodes.row(nodes[k])).norm();
}

/// The nodes of a surface that `interface.spacing` keeps.
std::vector<int> spaced_nodes(const ModelBody& body, const std::vector<int>& nodes) {
  const std::optional<double> spacing = body.parameters->interface_spacing();
  if (!spacing) return nodes;
  const double distance = distance_of_nodes(body.matrices, nodes, 0);
  const double ratio = *spacing / distance;
  const auto stride = static_cast<std::size_t>(std::llround(ratio));
  const std::size_t num_intervals = nodes.size() - 1;
  if (stride < 1 || std::abs(ratio - static_cast<double>(stride)) > 1e-6 * ratio ||
      num_intervals % stride != 0) {
    throw ConfigError(Refusal::wrong_value,
                      fmt::format("substructures.{}.interface.spacing", body.name),
                      fmt::format("{:g} m must be a whole multiple of the node distance {:g} m and "
                                  "divide the surface of {} such "
                                  "intervals into equal parts",
                                  *spacing, distance, num_intervals));
  }
  std::vector<int> kept;
  for (std::size_t k = 0; k < nodes.size(); k += stride) kept.push_back(nodes[k]);
  return kept;
}

/// A node can carry one contact force only.
void refuse_second_contact(const ContactPair& pair, const std::string& name) {
  const std::vector<int>& nodes = pair.slave_nodes;
  for (std::size_t k = 0; k < nodes.size(); ++k) {
    const auto first = std::find(nodes.begin(), nodes.end(), nodes[k]);
    if (first == nodes.begin() + static_cast<std::ptrdiff_t>(k)) continue;
    throw ConfigError(
        Refusal::doubled_name, pair.key + ".slave",
        fmt::format(
            "'{}' names a node that is slave point {} already, and two contacts at one node "
            "leave their forces undetermined; name every node once",
            name, first - nodes.begin() + 1));
  }
}

/// Nodes of facets, ascending, each once.
std::vector<int> nodes_of(const std::vector<Facet>& facets) {
  std::vector<int> nodes;
  for (const Facet& facet : facets)
    nodes.insert(nodes.end(), facet.nodes.begin(), facet.nodes.begin() + facet.count);
  std::sort(nodes.begin(), nodes.end());
  nodes.erase(std::unique(nodes.begin(), nodes.end()), nodes.end());
  return nodes;
}

/// The slave points of a pair, edges and surfaces node by node.
void resolve_slaves(ContactPair& pair, const std::vector<ModelBody>& bodies) {
  const std::string& key = pair.key;
  const std::vector<std::string>& names = pair.parameters->slave;
  for (std::size_t k = 0; k < names.size(); ++k) {
    const auto [slave, point] = split_name(names[k], bodies, key + ".slave");
    const ModelBody& body = bodies[static_cast<std::size_t>(slave)];
    if (k == 0) pair.slave_body = slave;
    if (slave != pair.slave_body) {
      throw ConfigError(
          Refusal::wrong_value, key + ".slave",
          "the points of one pair must belong to one body; use `contacts` for several pairs");
    }
    if (body.matrices.spin) {
      throw ConfigError(
          Refusal::wrong_value, key + ".slave",
          fmt::format("'{}' spins, so that its material passes its points in space; make "
                      "its surface the master, and points of the other body the slave",
                      body.name));
    }
    const auto node = body.matrices.points.find(point);
    const auto edge = body.matrices.surfaces.find(point);
    const auto facets = body.matrices.facets.find(point);
    if (node != body.matrices.points.end()) {
      pair.slave_nodes.push_back(node->second);
    } else if (edge != body.matrices.surfaces.end()) {
      pair.slave_nodes.insert(pair.slave_nodes.end(), edge->second.begin(), edge->second.end());
    } else if (facets != body.matrices.facets.end()) {
      const std::vector<int> nodes = nodes_of(facets->second);
      pair.slave_nodes.insert(pair.slave_nodes.end(), nodes.begin(), nodes.end());
    } else {
      std::vector<std::string> known = names_in_map(body.matrices.points);
      for (const std::string& other : names_in_map(body.matrices.surfaces)) known.push_back(other);
      for (const std::string& other : names_in_map(body.matrices.facets)) known.push_back(other);
      throw ConfigError(Refusal::unknown_name, key + ".slave",
                        fmt::format("'{}' has no point or surface '{}'{} (it has: {})", body.name,
                                    point, did_you_mean(point, known), listed_names(known)));
    }
    refuse_second_contact(pair, names[k]);
  }
}

}  // namespace

std::string ContactPair::point_name(std::size_t k) const {
  return slave_nodes.size() == 1 ? name : fmt::format("{}[{}]", name, k);
}

bool is_endless_master(const std::string& master) {
  return master == rigid_master || master == half_space_master;
}

ContactPair resolve_pair(const std::string& name, const std::string& key,
                          const ContactParameters& parameters, const std::vector<ModelBody>& bodies,
                          int endless_master) {
  ContactPair pair;
  pair.name = name;
  pair.key = key;
  pair.parameters = &parameters;

  pair.master_name = parameters.master;
  if (is_endless_master(parameters.master)) {
    pair.master_body = endless_master;
    resolve_slaves(pair, bodies);
    const ModelBody& slave = bodies[static_cast<std::size_t>(pair.slave_body)];
    pair.is_in_space = parameters.plane || (parameters.master == rigid_master &&
                                            slave.parameters->is_spatial());
    return pair;
  }
  const auto [master, surface] = split_name(parameters.master, bodies, key + ".master");
  const ModelBody& body = bodies[static_cast<std::size_t>(master)];
  const auto found = body.matrices.surfaces.find(surface);
  pair.master_body = master;
  pair.is_on_face = body.matrices.faces.contains(surface);
  pair.is_on_facets = pair.is_in_space = body.matrices.facets.contains(surface);
  if (found != body.matrices.surfaces.end()) {
    pair.master_nodes = spaced_nodes(body, found->second);
  } else if (!pair.is_on_face && !pair.is_on_facets) {
    std::vector<std::string> known = names_in_map(body.matrices.surfaces);
    for (const std::string& facets : names_in_map(body.matrices.facets)) known.push_back(facets);
    for (const std::string& face : names_in_map(body.matrices.faces)) known.push_back(face);
    throw ConfigError(Refusal::unknown_name, key + ".master",
                      fmt::format("'{}' has no surface '{}'{} (it has: {})", body.name, surface,
                                  did_you_mean(surface, known), listed_names(known)));
  }
  resolve_slaves(pair, bodies);
  if (pair.slave_body == pair.master_body) {
    throw ConfigError(Refusal::wrong_value, key + ".slave",
                      "slave and master must be different bodies");
  }
  const ModelBody& slave = bodies[static_cast<std::size_t>(pair.slave_body)];
  if (slave.parameters->is_spatial() && !pair.is_in_space) {
    throw ConfigError(
        Refusal::wrong_value, key + ".master",
        fmt::format("'{}' is {}; '{}' is a body in space, which slides on the surface of "
                    "another such body or on `rigid`",
                    parameters.master,
                    pair.is_on_face ? "the face of a plate, on which slaves are planar"
                                    : "a curve in the plane",
                    slave.name));
  }
  if (parameters.adjust && !pair.is_in_space)
    throw ConfigError(Refusal::contradiction, key + ".adjust", "is of contacts in space");
  return pair;
}

void refuse_shared_nodes(const std::vector<ContactPair>& pairs) {
  for (std::size_t i = 0; i < pairs.size(); ++i) {
    for (std::size_t j = 0; j < i; ++j) {
      if (pairs[i].slave_body != pairs[j].slave_body ||
          pairs[i].master_name != pairs[j].master_name)
        continue;
      const std::vector<int>& others = pairs[j].slave_nodes;
      const bool shares = std::any_of(
          pairs[i].slave_nodes.begin(), pairs[i].slave_nodes.end(),
          [&](int node) { return std::find(others.begin(), others.end(), node) != others.end(); });
      if (!shares) continue;
      throw ConfigError(
          Refusal::doubled_name, pairs[i].key + ".slave",
          fmt::format("shares a node with the pair '{}' on the same master, and two contacts at "
                      "one node leave their forces undetermined; remove it from one of them",
                      pairs[j].name));
    }
  }
}

ContactPoint make_contact_point(const ContactPair& pair, std::size_t k, const PairDrive& drive) {
  const ContactParameters& parameters = *pair.parameters;
  ContactPoint point;
  point.name = pair.point_name(k);
  point.slave_body = pair.slave_body;
  point.assumption = parameters.assumption_or_default();
  if (parameters.friction) point.friction = make_friction_law(*parameters.friction);
  point.penalty = parameters.normal.stiffness();
  if (parameters.normal.law->has_area())
    point.substrate = make_substrate_contact(parameters, drive.load);
  point.friction_rise = TimeCurve::ramp(1.0, drive.ramp);
  point.on_violation = parameters.on_violation;
  point.armed_from = parameters.armed_from.value_or(drive.ramp);
  return point;
}

}  // namespace stridor
