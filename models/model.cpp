#include "models/model.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/activity.hpp"
#include "core/memory.hpp"
#include "core/suggestion.hpp"
#include "models/body_cache.hpp"
#include "models/initial_motion.hpp"
#include "models/set_up_estimate.hpp"
#include "substructures/whole_body.hpp"

namespace stridor {
namespace {

/// Name of the body of the endless masters that the drive moves.
constexpr const char* moving_master = "moving rigid";

/// Whether a master is a straight line along +x without end, and no surface of a body.
bool is_endless_master(const std::string& master) {
  return master == rigid_master || master == half_space_master;
}

/// A contact pair with its names resolved to nodes. A rigid master has no nodes.
struct ResolvedPair {
  std::string name;
  std::string key;  ///< key path of its section
  const ContactParameters* parameters = nullptr;
  int slave_body = 0;
  std::vector<int> slave_nodes;
  std::string master_name;
  int master_body = 0;
  std::vector<int> master_nodes;
};

struct Body {
  std::string name;
  const BodyParameters* parameters = nullptr;  ///< null for the rigid master
  BodyMatrices matrices;
  Eigen::Vector2d place = Eigen::Vector2d::Zero();
  bool is_placed = false;
  bool is_touched = false;  ///< by a contact
  std::vector<int> interface;  ///< DoFs kept
  std::vector<int> watched;    ///< DoFs with a row, in order of the rows

  int row_of(int dof) {
    const auto found = std::find(watched.begin(), watched.end(), dof);
    if (found != watched.end()) return static_cast<int>(found - watched.begin());
    watched.push_back(dof);
    return static_cast<int>(watched.size()) - 1;
  }
  PointRows rows_of(int node) {
    const auto& dofs = matrices.node_dofs[static_cast<std::size_t>(node)];
    return {row_of(dofs[0]), row_of(dofs[1])};
  }
  /// Whether nothing is to be reduced of it.
  bool is_whole() const {
    return parameters != nullptr && !is_touched && !parameters->num_modes();
  }
  Eigen::Vector2d position(int node) const { return matrices.nodes.row(node).transpose() + place; }
  void keep(int dof) {
    if (dof != BodyMatrices::held &&
        std::find(interface.begin(), interface.end(), dof) == interface.end()) {
      interface.push_back(dof);
    }
  }
  void keep_node(int node) {
    for (const int dof : matrices.node_dofs[static_cast<std::size_t>(node)]) keep(dof);
  }
};

template <class Map>
std::vector<std::string> names_of(const Map& map) {
  std::vector<std::string> names;
  names.reserve(map.size());
  for (const auto& entry : map) names.push_back(entry.first);
  return names;
}

std::string listed(const std::vector<std::string>& names) {
  return fmt::format("{}", fmt::join(names, ", "));
}

/// "<body>.<name>" split at the first dot; the body looked up.
std::pair<int, std::string> split_name(const std::string& name, const std::vector<Body>& bodies,
                                       const std::string& key) {
  const std::size_t dot = name.find('.');
  if (dot == std::string::npos || dot == 0 || dot + 1 == name.size()) {
    throw ConfigError(key, fmt::format("'{}' is not of the form <body>.<point or surface>", name));
  }
  const std::string body_name = name.substr(0, dot);
  std::vector<std::string> names;
  for (std::size_t b = 0; b < bodies.size(); ++b) {
    if (bodies[b].parameters == nullptr) continue;  // the rigid master has no points
    if (bodies[b].name == body_name) return {static_cast<int>(b), name.substr(dot + 1)};
    names.push_back(bodies[b].name);
  }
  throw ConfigError(key, fmt::format("there is no substructure '{}'{} (there are: {})", body_name,
                                     did_you_mean(body_name, names), listed(names)));
}

double node_distance(const BodyMatrices& body, const std::vector<int>& nodes, std::size_t k) {
  return (body.nodes.row(nodes[k + 1]) - body.nodes.row(nodes[k])).norm();
}

/// The nodes of a surface that `interface.spacing` keeps.
std::vector<int> spaced_nodes(const Body& body, const std::vector<int>& nodes) {
  const std::optional<double> spacing = body.parameters->interface_spacing();
  if (!spacing) return nodes;
  const double distance = node_distance(body.matrices, nodes, 0);
  const double ratio = *spacing / distance;
  const auto stride = static_cast<std::size_t>(std::llround(ratio));
  const std::size_t num_intervals = nodes.size() - 1;
  if (stride < 1 || std::abs(ratio - static_cast<double>(stride)) > 1e-6 * ratio ||
      num_intervals % stride != 0) {
    throw ConfigError(fmt::format("substructures.{}.interface.spacing", body.name),
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
void refuse_second_contact(const ResolvedPair& pair, const std::string& name) {
  const std::vector<int>& nodes = pair.slave_nodes;
  for (std::size_t k = 0; k < nodes.size(); ++k) {
    const auto first = std::find(nodes.begin(), nodes.end(), nodes[k]);
    if (first == nodes.begin() + static_cast<std::ptrdiff_t>(k)) continue;
    throw ConfigError(
        pair.key + ".slave",
        fmt::format(
            "'{}' names a node that is slave point {} already, and two contacts at one node "
            "leave their forces undetermined; name every node once",
            name, first - nodes.begin() + 1));
  }
}

/// The slave points of a pair, edges node by node.
void resolve_slaves(ResolvedPair& pair, const std::vector<Body>& bodies) {
  const std::string& key = pair.key;
  const std::vector<std::string>& names = pair.parameters->slave;
  for (std::size_t k = 0; k < names.size(); ++k) {
    const auto [slave, point] = split_name(names[k], bodies, key + ".slave");
    const Body& body = bodies[static_cast<std::size_t>(slave)];
    if (k == 0) pair.slave_body = slave;
    if (slave != pair.slave_body) {
      throw ConfigError(
          key + ".slave",
          "the points of one pair must belong to one body; use `contacts` for several pairs");
    }
    const auto node = body.matrices.points.find(point);
    const auto edge = body.matrices.surfaces.find(point);
    if (node != body.matrices.points.end()) {
      pair.slave_nodes.push_back(node->second);
    } else if (edge != body.matrices.surfaces.end()) {
      pair.slave_nodes.insert(pair.slave_nodes.end(), edge->second.begin(), edge->second.end());
    } else {
      std::vector<std::string> known = names_of(body.matrices.points);
      for (const std::string& other : names_of(body.matrices.surfaces)) known.push_back(other);
      throw ConfigError(key + ".slave",
                        fmt::format("'{}' has no point or surface '{}'{} (it has: {})", body.name,
                                    point, did_you_mean(point, known), listed(known)));
    }
    refuse_second_contact(pair, names[k]);
  }
}

/// Bodies without degrees of freedom that carry the masters without end.
struct EndlessMasters {
  int at_rest = -1;  ///< index of the body; −1 where no contact has such a master
  int moving = -1;   ///< with the drive
};

/// Whether the drive moves the master of a pair.
bool moves_master(const DriveParameters& drive, const std::string& pair) {
  return std::find(drive.moves.begin(), drive.moves.end(), pair + ".master") != drive.moves.end();
}

ResolvedPair resolve_pair(const std::string& name, const std::string& key,
                          const ContactParameters& parameters, const std::vector<Body>& bodies,
                          int endless_master) {
  ResolvedPair pair;
  pair.name = name;
  pair.key = key;
  pair.parameters = &parameters;

  pair.master_name = parameters.master;
  if (is_endless_master(parameters.master)) {
    pair.master_body = endless_master;
    resolve_slaves(pair, bodies);
    return pair;
  }
  const auto [master, surface] = split_name(parameters.master, bodies, key + ".master");
  const auto& surfaces = bodies[static_cast<std::size_t>(master)].matrices.surfaces;
  const auto found = surfaces.find(surface);
  if (found == surfaces.end()) {
    throw ConfigError(
        key + ".master",
        fmt::format("'{}' has no surface '{}'{} (it has: {})",
                    bodies[static_cast<std::size_t>(master)].name, surface,
                    did_you_mean(surface, names_of(surfaces)), listed(names_of(surfaces))));
  }
  pair.master_body = master;
  pair.master_nodes = spaced_nodes(bodies[static_cast<std::size_t>(master)], found->second);
  resolve_slaves(pair, bodies);
  if (pair.slave_body == pair.master_body) {
    throw ConfigError(key + ".slave", "slave and master must be different bodies");
  }
  return pair;
}

/// Refuses what the drive is to move and is not there, or cannot be moved by it.
void check_drive(const DriveParameters& drive,
                 const std::map<std::string, ContactParameters>& pairs) {
  for (std::size_t i = 0; i < drive.moves.size(); ++i) {
    const std::string& name = drive.moves[i];
    if (name == guided_supports) continue;
    const std::string key = fmt::format("drive.moves.{}", i);
    const auto pair = std::find_if(pairs.begin(), pairs.end(),
                                   [&](const auto& one) { return one.first + ".master" == name; });
    if (pair == pairs.end()) {
      std::vector<std::string> known{guided_supports};
      for (const auto& one : pairs) known.push_back(one.first + ".master");
      throw ConfigError(key, fmt::format("there is no '{}' to move{} (there are: {})", name,
                                         did_you_mean(name, known), listed(known)));
    }
    if (!is_endless_master(pair->second.master)) {
      throw ConfigError(key, fmt::format("'{}' is the surface of a body, which its supports hold; "
                                         "give that body a guided support",
                                         pair->second.master));
    }
  }
}

/// Adds the bodies of masters without end, which come last.
EndlessMasters add_endless_masters(const DriveParameters& drive,
                                   const std::map<std::string, ContactParameters>& pairs,
                                   std::vector<Body>& bodies) {
  EndlessMasters endless;
  for (const auto& [name, pair] : pairs) {
    if (!is_endless_master(pair.master)) continue;
    const bool moves = moves_master(drive, name);
    int& index = moves ? endless.moving : endless.at_rest;
    if (index >= 0) continue;
    index = static_cast<int>(bodies.size());
    bodies.emplace_back();
    bodies.back().name = moves ? moving_master : rigid_master;
  }
  return endless;
}

/// Two pairs with one slave node on one master.
void refuse_shared_nodes(const std::vector<ResolvedPair>& pairs) {
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
          pairs[i].key + ".slave",
          fmt::format("shares a node with the pair '{}' on the same master, and two contacts at "
                      "one node leave their forces undetermined; remove it from one of them",
                      pairs[j].name));
    }
  }
}

/// Largest difference in height of two slave points of one body, m.
double height_of_roughness(const ContactParameters& parameters) {
  constexpr double never_exceeded = 20.0;
  return parameters.roughness ? never_exceeded * parameters.roughness->rms : 0.0;
}

/// @param length of the master, m
Roughness make_roughness(const ResolvedPair& pair, double length) {
  const std::optional<RoughnessParameters>& given = pair.parameters->roughness;
  if (!given || given->rms == 0.0) return {};
  const double least = length / Roughness::max_correlation_lengths;
  if (!(given->correlation_length >= least)) {
    throw ConfigError(
        pair.key + ".roughness.correlation_length",
        fmt::format("{:g} m is too small for a master of {:g} m, on which it takes {:g} m at least",
                    given->correlation_length, length, least));
  }
  return Roughness(*given, length);
}

MasterSurface make_surface(const ResolvedPair& pair, Body& body) {
  MasterSurface surface;
  surface.name = pair.master_name;
  surface.body = pair.master_body;
  surface.kind = pair.parameters->surface;
  if (is_endless_master(pair.master_name)) {
    if (pair.parameters->roughness) {
      throw ConfigError(pair.key + ".roughness",
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
    if (k > 0) arc += node_distance(body.matrices, pair.master_nodes, k - 1);
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

void place_slave(const ResolvedPair& pair, const MasterSurface& surface, Body& slave) {
  const double start = pair.parameters->start;
  const double length = surface.arc_length.back();
  if (!surface.is_endless && start > length * (1.0 + 1e-12)) {
    throw ConfigError(
        pair.key + ".start",
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
    slave.place += shift;
    slave.is_placed = true;
  } else if (shift.norm() > 1e-9 * length + height_of_roughness(*pair.parameters)) {
    throw ConfigError(pair.key + ".start",
                      fmt::format("'{}' is placed already, and its point stands {:g} m away from "
                                  "the {:g} m asked for; a body can be "
                                  "placed by one pair only",
                                  slave.name, shift.norm(), start));
  }
}

/// Refuses a filled slave of which the part over the master lies on the inner side of its surface.
void check_side(const ResolvedPair& pair, const MasterSurface& surface, const Body& slave) {
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
      pair.key + ".slave",
      fmt::format("'{}' starts on the inner side of its master '{}', on average {:.3g} m deep; "
                  "turn it (substructures.{}.angle), or take a point or edge of its other side",
                  slave.name, surface.name, -height / num_over, slave.name));
}

/// A node of a body by the name of its point.
int node_at(const Body& body, const std::string& point, const std::string& key) {
  const auto node = body.matrices.points.find(point);
  if (node != body.matrices.points.end()) return node->second;
  const auto known = names_of(body.matrices.points);
  throw ConfigError(key, fmt::format("'{}' has no point '{}'{} (it has: {})", body.name, point,
                                     did_you_mean(point, known), listed(known)));
}

/// The initial displacements or velocities of a scene with their names resolved.
struct InitialMotion {
  struct Entry {
    std::string key;
    int body = 0;
    std::optional<PointRows> rows;  ///< of a point; none for the whole body
    Eigen::Vector2d value;
  };
  std::vector<Entry> entries;

  template <MotionKind kind>
  InitialMotion(const std::vector<InitialMotionParameters<kind>>& given, const std::string& key,
                std::vector<Body>& bodies) {
    for (std::size_t k = 0; k < given.size(); ++k) {
      Entry entry{fmt::format("{}.{}", key, k), 0, std::nullopt, {given[k].x, given[k].y}};
      const std::string& at = given[k].at;
      const bool is_point = at.find('.') != std::string::npos;
      const auto [b, point] = split_name(is_point ? at : at + ".all", bodies, entry.key + ".at");
      entry.body = b;
      Body& body = bodies[static_cast<std::size_t>(b)];
      if (is_point) entry.rows = body.rows_of(node_at(body, point, entry.key + ".at"));
      entries.push_back(std::move(entry));
    }
  }

  /// The motion of one body in reduced coordinates; empty where nothing is given.
  Eigen::VectorXd of(int body, const Body& built, const SystemBody& finished) const {
    Eigen::VectorXd motion;
    std::vector<PrescribedRow> prescribed;
    std::string key;
    const auto add = [&](const Eigen::VectorXd& part) {
      motion = motion.size() == 0 ? part : Eigen::VectorXd(motion + part);
    };
    for (const Entry& entry : entries) {
      if (entry.body != body) continue;
      if (entry.rows) {
        key = entry.key;
        if (entry.value.x() != 0.0) prescribed.push_back({entry.rows->x, entry.value.x()});
        if (entry.value.y() != 0.0) prescribed.push_back({entry.rows->y, entry.value.y()});
      } else {
        add(translation(entry, built, finished));
      }
    }
    if (!prescribed.empty()) {
      try {
        add(static_shape(finished.modal, prescribed));
      } catch (const NumericalError& error) {
        throw ConfigError(key + ".at", error.what());
      }
    }
    return motion;
  }

  /// Constraint modes carry a body along with its interface; that is a translation where no support
  /// resists it.
  static Eigen::VectorXd translation(const Entry& entry, const Body& built,
                                     const SystemBody& finished) {
    Eigen::VectorXd motion = Eigen::VectorXd::Zero(finished.reduced.size());
    const Eigen::MatrixXd& stiffness = finished.reduced.stiffness;
    for (Eigen::Index direction = 0; direction < 2; ++direction) {
      if (entry.value(direction) == 0.0) continue;
      Eigen::VectorXd unit = Eigen::VectorXd::Zero(finished.reduced.size());
      for (std::size_t k = 0; k < built.interface.size(); ++k) {
        for (const auto& dofs : built.matrices.node_dofs) {
          if (dofs[static_cast<std::size_t>(direction)] == built.interface[k])
            unit(static_cast<Eigen::Index>(k)) = 1.0;
        }
      }
      const double energy = unit.dot(stiffness * unit);
      const double scale = unit.dot(stiffness.cwiseAbs() * unit);
      // A body without interface DoFs in this direction is held by its supports alone.
      if (unit.isZero() || !(energy <= 1e-9 * scale)) {
        throw ConfigError(entry.key + ".at",
                          fmt::format("the supports of '{}' do not let all of it move alike; name "
                                      "a point of it",
                                      built.name));
      }
      motion += entry.value(direction) * unit;
    }
    return motion;
  }
};

/// A master without end: its one row stays where the body is.
SystemBody make_rigid_body(const std::string& name) {
  SystemBody body;
  body.name = name;
  body.follows_drive = name == moving_master;
  body.reduced.rows.resize(1, 0);
  body.modal.rows.resize(1, 0);
  return body;
}

/// Whether a list of the drive holds the guided supports.
bool names_guided(const std::vector<std::string>& list) {
  return list.empty() || std::find(list.begin(), list.end(), guided_supports) != list.end();
}

bool follows_drive(const Body& body, const DriveParameters& drive) {
  return body.matrices.follows_drive() && names_guided(drive.moves);
}

/// Refuses a velocity that nothing follows: contacts would be taken to slide and do not.
void check_something_follows(const DriveParameters& parameters, const Drive& drive,
                             const std::vector<Body>& bodies, const EndlessMasters& endless) {
  const std::vector<double>& velocities = drive.velocity.table().values;
  const bool is_at_rest =
      std::all_of(velocities.begin(), velocities.end(), [](double v) { return v == 0.0; });
  const bool is_followed = std::any_of(bodies.begin(), bodies.end(), [&](const Body& body) {
    return body.parameters != nullptr && follows_drive(body, parameters);
  });
  if (is_at_rest || is_followed || endless.moving >= 0) return;
  throw ConfigError("drive.velocity",
                    fmt::format("moves nothing: no body has a support that is guided{}, and no "
                                "master is named in drive.moves; give the body that is to slide a "
                                "guided support, or move a rigid or half_space master",
                                names_guided(parameters.moves) ? "" : " and named in drive.moves"));
}

/// Size of the drive's load in the end, N.
double final_load(const DriveParameters& drive) {
  return std::abs(drive.load.value(std::numeric_limits<double>::infinity()));
}

/// Refuses loads on what is not there.
void check_loads(const DriveParameters& drive, const std::vector<Body>& bodies) {
  for (std::size_t i = 0; i < drive.load_on.size(); ++i) {
    const std::string& name = drive.load_on[i];
    if (name == guided_supports) continue;
    const std::string key = fmt::format("drive.load_on.{}", i);
    const auto [b, point] = split_name(name, bodies, key);
    const Body& body = bodies[static_cast<std::size_t>(b)];
    const int node = node_at(body, point, key);
    if (body.matrices.node_dofs[static_cast<std::size_t>(node)][1] == BodyMatrices::held)
      throw ConfigError(key, fmt::format("'{}' is held in y, so that no load moves it", name));
  }
}

/// Row of a body on which the drive's load acts; −1 where there is none.
int load_row_of(Body& body, const DriveParameters& drive) {
  int dof = BodyMatrices::held;
  if (body.matrices.follows_drive()) {
    body.keep(body.matrices.load_dof);
    if (names_guided(drive.load_on)) dof = body.matrices.load_dof;
  }
  for (std::size_t i = 0; i < drive.load_on.size(); ++i) {
    const std::string prefix = body.name + ".";
    if (!drive.load_on[i].starts_with(prefix)) continue;
    const std::string key = fmt::format("drive.load_on.{}", i);
    if (dof != BodyMatrices::held) {
      throw ConfigError(key, fmt::format("'{}' carries the drive's load already; one place of each "
                                         "body can",
                                         body.name));
    }
    const int node = node_at(body, drive.load_on[i].substr(prefix.size()), key);
    dof = body.matrices.node_dofs[static_cast<std::size_t>(node)][1];
    body.keep(dof);
  }
  return dof == BodyMatrices::held ? -1 : body.row_of(dof);
}

/// Number of fixed-interface modes asked for; for a body of which nothing is to be reduced, all
/// unknowns become interface.
int modes_of(Body& body, const std::string& key) {
  if (const std::optional<int> asked = body.parameters->num_modes()) return *asked;
  if (body.matrices.num_dofs() > largest_dense_size) {
    throw ConfigError(key + ".reduction",
                      fmt::format("missing: {} unknowns are too many to keep them all (up to {}); "
                                  "give fixed_interface_modes",
                                  body.matrices.num_dofs(), largest_dense_size));
  }
  for (int dof = 0; dof < body.matrices.num_dofs(); ++dof) body.keep(dof);
  return 0;
}

/// Whether the bodies of which every unknown is kept are too large for dense matrices.
bool is_large(const std::vector<Body>& bodies) {
  Eigen::Index size = 0;
  for (const Body& body : bodies)
    if (body.is_whole()) size += body.matrices.num_dofs();
  return size > largest_dense_size;
}

/// Terms that couple modes keep no rigid motion apart, so statics know none.
void check_coupled(const SystemBody& body, const std::string& key) {
  const CoupledTerms& coupled = body.modal.coupled;
  if (coupled.is_empty() || coupled.position.isZero(0.0)) return;
  if ((body.modal.omega.array() > 0.0).all()) return;
  throw ConfigError(key + ".circulatory",
                    fmt::format("goes with a stiffness that resists every motion; that of '{}' "
                                "leaves some free",
                                body.name));
}

}  // namespace

const Schema& ModelParameters::schema() {
  static const Schema keys =
      SchemaOf<ModelParameters>("model")
          .named_types("substructures", &ModelParameters::substructures, "type",
                       {.doc = "The bodies, by name; may be absent where only `contact` evaluates "
                               "the normal laws.",
                        .optional = true})
          .section("contact", &ModelParameters::contact,
                   {.doc = "The contact pair, where there is one only.", .optional = true})
          .named_sections("contacts", &ModelParameters::contacts,
                          {.doc = "Several contact pairs, by name.", .optional = true})
          .section("drive", &ModelParameters::drive,
                   {.doc = "What moves and loads guided supports; default: nothing does.",
                    .optional = true})
          .section("initial", &ModelParameters::initial,
                   {.doc = "State at the start of a run.", .optional = true})
          .check([](const ModelParameters& model, std::vector<Problem>& problems) {
            if (model.substructures.empty() && model.pairs().empty())
              problems.push_back(
                  {"substructures", "is missing: there is nothing to move", {}, 0, 0});
            if (model.contact && !model.contacts.empty()) {
              problems.push_back(
                  {"contacts",
                   "give either `contact` (one pair) or `contacts` (several), not both",
                   {},
                   0,
                   0});
            }
            const auto pairs = model.pairs();
            for (const auto& [name, pair] : pairs) {
              if (pair.sliding != pairs.begin()->second.sliding) {
                problems.push_back({"contacts." + name + ".sliding",
                                    "must be the same for all pairs: one drive moves them",
                                    {},
                                    0,
                                    0});
              }
            }
          });
  return keys;
}

std::map<std::string, ContactParameters> ModelParameters::pairs() const {
  if (contact) return {{"contact", *contact}};
  return contacts;
}

void require_modes(const Model& model) {
  if (!model.sparse) return;
  for (const auto& [name, body] : model.substructures) {
    if (body->num_modes()) continue;
    throw ConfigError("substructures." + name + ".reduction",
                      fmt::format("missing: the bodies have {} unknowns, too many to keep them all "
                                  "in a run (up to {}); give fixed_interface_modes",
                                  model.sparse->size(), largest_dense_size));
  }
}

Model make_model(const ModelParameters& parameters,
                 const std::vector<std::pair<PointName, std::string>>& observed) {
  BodyCache cache;
  return make_model(parameters, observed, cache);
}

Model make_model(const ModelParameters& parameters,
                 const std::vector<std::pair<PointName, std::string>>& observed, BodyCache& cache) {
  require_memory(estimate_set_up(parameters), memory_limit());
  std::vector<Body> bodies;
  for (const auto& [name, substructure] : parameters.substructures) {
    if (is_endless_master(name)) {
      throw ConfigError("substructures." + name,
                        fmt::format("'{}' is the name of a master; give the body another", name));
    }
    Body body;
    body.name = name;
    body.parameters = &*substructure;
    const Activity assembling(fmt::format("assembling '{}'", name));
    try {
      body.matrices = cache.matrices(*substructure);
    } catch (const ConfigError& error) {
      const Problem& problem = error.problems().front();
      throw ConfigError("substructures." + name + "." + problem.key, problem.message);
    }
    bodies.push_back(std::move(body));
  }
  const auto pairs = parameters.pairs();
  const DriveParameters drive = parameters.drive_or_rest();
  check_drive(drive, pairs);
  const EndlessMasters endless = add_endless_masters(drive, pairs, bodies);

  std::vector<ResolvedPair> resolved;
  resolved.reserve(pairs.size());
  for (const auto& [name, pair] : pairs) {
    resolved.push_back(
        resolve_pair(name, parameters.contact ? name : "contacts." + name, pair, bodies,
                     moves_master(drive, name) ? endless.moving : endless.at_rest));
  }

  for (const ResolvedPair& pair : resolved) {
    for (const int body : {pair.slave_body, pair.master_body})
      bodies[static_cast<std::size_t>(body)].is_touched = true;
  }

  // A body that carries others is placed before them; chains are placed in order.
  Model model;
  model.substructures = parameters.substructures;
  System& system = model.system;
  system.drive = make_drive(drive,
                            pairs.empty() ? SlidingMode::moving : pairs.begin()->second.sliding);
  if (!pairs.empty()) check_something_follows(drive, system.drive, bodies, endless);
  std::vector<ResolvedPair*> waiting;
  waiting.reserve(resolved.size());
  for (ResolvedPair& pair : resolved) waiting.push_back(&pair);
  const auto is_waiting_slave = [&](int body) {
    return std::any_of(waiting.begin(), waiting.end(), [&](const ResolvedPair* pair) {
      return pair->slave_body == body && !bodies[static_cast<std::size_t>(body)].is_placed;
    });
  };
  while (!waiting.empty()) {
    const auto ready = std::find_if(waiting.begin(), waiting.end(), [&](const ResolvedPair* pair) {
      return !is_waiting_slave(pair->master_body);
    });
    if (ready == waiting.end()) {
      throw ConfigError(waiting.front()->key + ".master",
                        "the pairs form a circle: no body of it can be placed first");
    }
    const ResolvedPair& pair = **ready;
    Body& slave = bodies[static_cast<std::size_t>(pair.slave_body)];
    Body& master = bodies[static_cast<std::size_t>(pair.master_body)];
    MasterSurface surface = make_surface(pair, master);
    place_slave(pair, surface, slave);
    check_side(pair, surface, slave);
    for (const int node : pair.master_nodes) master.keep_node(node);

    for (std::size_t k = 0; k < pair.slave_nodes.size(); ++k) {
      const int node = pair.slave_nodes[k];
      slave.keep_node(node);
      ContactPoint point;
      point.name = pair.slave_nodes.size() == 1 ? pair.name : fmt::format("{}[{}]", pair.name, k);
      point.slave_body = pair.slave_body;
      point.slave_rows = slave.rows_of(node);
      point.slave_position = slave.position(node);
      point.surface = static_cast<int>(system.surfaces.size());
      const auto [segment, projection] = locate_on(surface, point.slave_position);
      const double length = surface.arc_length.back();
      const double rounding = 1e-9;
      if (!surface.is_endless && (projection.xi < -rounding || projection.xi > 1.0 + rounding)) {
        throw ConfigError(pair.key + ".start",
                          fmt::format("slave point {} starts off the end of the master '{}'", k + 1,
                                      surface.name));
      }
      const double gap = projection.normal.dot(
          point.slave_position - surface.positions[static_cast<std::size_t>(segment)]);
      if (std::abs(gap) > 1e-6 * length + height_of_roughness(*pair.parameters)) {
        throw ConfigError(pair.key + ".slave",
                          fmt::format("slave point {} starts {:g} m away from the master '{}'; "
                                      "every slave point must lie on it at the "
                                      "start",
                                      k + 1, gap, surface.name));
      }
      point.first_segment = segment;
      point.assumption = pair.parameters->assumption_or_default();
      if (pair.parameters->friction) point.friction = make_friction_law(*pair.parameters->friction);
      point.penalty = pair.parameters->normal.stiffness;
      if (pair.parameters->normal.law == NormalLaw::viscoelastic)
        point.substrate = make_substrate_contact(*pair.parameters, final_load(drive));
      point.friction_rise = TimeCurve::ramp(1.0, drive.ramp);
      point.on_violation = pair.parameters->on_violation;
      point.armed_from = pair.parameters->armed_from.value_or(drive.ramp);
      system.contacts.push_back(std::move(point));
    }
    system.surfaces.push_back(std::move(surface));
    waiting.erase(ready);
  }
  refuse_shared_nodes(resolved);

  for (const auto& [name, key] : observed) {
    const auto [b, point] = split_name(name.body + "." + name.point, bodies, key);
    Body& body = bodies[static_cast<std::size_t>(b)];
    model.points[name] = {b, body.rows_of(node_at(body, point, key))};
  }

  check_loads(drive, bodies);
  const InitialMotion displacement(parameters.initial.displacement, "initial.displacement", bodies);
  const InitialMotion velocity(parameters.initial.velocity, "initial.velocity", bodies);
  const bool is_sparse = pairs.empty() && is_large(bodies);
  std::vector<SparseSystem> blocks;
  for (Body& body : bodies) {
    if (body.parameters == nullptr) {
      system.bodies.push_back(make_rigid_body(body.name));
      model.placements.emplace_back();
      continue;
    }
    const std::string key = "substructures." + body.name;
    SystemBody finished;
    finished.name = body.name;
    finished.follows_drive = follows_drive(body, drive);
    finished.load_row = load_row_of(body, drive);
    if (is_sparse && body.is_whole()) {
      blocks.push_back(make_sparse(body.matrices));
      continue;
    }
    const int num_modes = modes_of(body, key);
    const auto num_interior =
        body.matrices.num_dofs() - static_cast<Eigen::Index>(body.interface.size());
    if (num_modes > num_interior) {
      throw ConfigError(key + ".reduction.fixed_interface_modes",
                        fmt::format("{} modes asked, but '{}' has only {} DoFs besides its "
                                    "interface; take at most that",
                                    num_modes, body.name, num_interior));
    }
    const Activity reducing(fmt::format("reducing '{}'", body.name));
    try {
      BodyCache::Reduction reduction =
          body.is_whole() ? cache.keep_whole(*body.parameters, body.matrices, body.watched)
                          : cache.reduce(*body.parameters, body.matrices, body.interface,
                                         num_modes, body.watched);
      finished.reduced = std::move(reduction.reduced);
      finished.modal = std::move(reduction.modal);
    } catch (const NumericalError& error) {
      throw ConfigError(
          key, fmt::format("cannot be reduced: {}. Give it supports or more contact points",
                           error.what()));
    }
    if (body.is_touched) check_coupled(finished, key);
    const auto number = static_cast<int>(system.bodies.size());
    finished.initial_displacement = displacement.of(number, body, finished);
    finished.initial_velocity = velocity.of(number, body, finished);
    system.bodies.push_back(std::move(finished));
    model.placements.push_back({body.place, body.interface});
  }
  if (is_sparse) {
    for (const SystemBody& body : system.bodies) blocks.push_back(make_sparse(body.modal));
    model.sparse = block_diagonal(blocks);
    system = {};
    model.points.clear();
    model.placements.clear();
  }
  return model;
}

}  // namespace stridor
