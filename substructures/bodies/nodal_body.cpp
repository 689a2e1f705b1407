#include "substructures/bodies/nodal_body.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <unordered_map>
#include <utility>

#include "core/errors.hpp"
#include "core/units.hpp"

namespace stridor {
namespace {

/// The keys that such a body has in common with one from a mesh.
MeshBodyParameters mesh_keys(const TouchedMatrixBodyParameters& parameters) {
  MeshBodyParameters keys;
  keys.mesh = std::shared_ptr<const Mesh>(parameters.matrices, &parameters.matrices->mesh);
  keys.length_unit = parameters.nodes.length_unit;
  keys.angle = parameters.angle;
  keys.supports = parameters.supports;
  keys.springs = parameters.springs;
  keys.interface = parameters.interface;
  for (const auto& [name, surface] : parameters.surfaces) {
    if (surface.points.empty())
      keys.surfaces[name] = {surface.plane, surface.cylinder, surface.box, surface.tolerance};
  }
  for (const auto& [name, point] : parameters.points)
    keys.points[name] = {point.at, point.node, point.mean_of};
  if (parameters.guided) keys.guided = MeshGuideParameters{parameters.guided->on};
  return keys;
}

void refuse_number_keys(const TouchedMatrixBodyParameters& parameters) {
  for (const auto& [name, point] : parameters.points) {
    if (point.x == 0 && point.y == 0) continue;
    throw ConfigError(
        Refusal::contradiction, fmt::format("points.{}.{}", name, point.x > 0 ? "x" : "y"),
        "is not used: it is known which rows are which nodes; leave it out, the place "
        "or `node` says enough");
  }
  if (parameters.guided && parameters.guided->on.empty()) {
    throw ConfigError(
        Refusal::contradiction, "guided.load",
        "is not used: it is known which rows are which nodes; give `on` in its place");
  }
}

/// Turns displacements from the frame of the matrices to that of the body: A <- T A Tᵀ.
class Turn {
 public:
  Turn(double angle, Eigen::Index size) : cosine_(std::cos(angle)), sine_(std::sin(angle)) {
    if (std::abs(cosine_) < 1e-15) cosine_ = 0.0;
    if (std::abs(sine_) < 1e-15) sine_ = 0.0;
    matrix_.resize(size, size);
    is_turned_.assign(static_cast<std::size_t>(size), false);
  }

  /// Rows of one node along x and y.
  void add(int x, int y) {
    entries_.emplace_back(x, x, cosine_);
    entries_.emplace_back(x, y, -sine_);
    entries_.emplace_back(y, x, sine_);
    entries_.emplace_back(y, y, cosine_);
    is_turned_[static_cast<std::size_t>(x)] = is_turned_[static_cast<std::size_t>(y)] = true;
  }

  void finish() {
    for (std::size_t row = 0; row < is_turned_.size(); ++row)
      if (!is_turned_[row]) entries_.emplace_back(static_cast<int>(row), static_cast<int>(row), 1.0);
    matrix_.setFromTriplets(entries_.begin(), entries_.end());
    matrix_.prune(0.0, 0.0);
    transposed_ = matrix_.transpose();
  }

  void apply(SparseMatrix& matrix) const { matrix = SparseMatrix(matrix_ * matrix * transposed_); }

 private:
  double cosine_, sine_;
  std::vector<Eigen::Triplet<double>> entries_;
  std::vector<bool> is_turned_;
  SparseMatrix matrix_, transposed_;
};

/// @throws ConfigError where only one of the two displacements is free, since the other frame has
///         none that is held then
void turn(const NamedMatrices& matrices, const NodeRows& nodes, double angle,
          SparseSystem& system) {
  Turn turn(angle, system.size());
  const auto pair = [&](int x, int y, std::size_t node) {
    const bool has_x = x != BodyMatrices::held;
    const bool has_y = y != BodyMatrices::held;
    if (has_x && has_y) turn.add(x, y);
    if (has_x == has_y) return;
    throw ConfigError(Refusal::contradiction, "angle",
                      fmt::format("the matrices hold node {} along or about {} alone, which is no "
                                  "axis of the body once it is turned; hold it by `supports`",
                                  matrices.mesh.node_labels[node], has_x ? "y" : "x"));
  };
  const auto d = static_cast<std::size_t>(dimension_of(matrices));
  for (std::size_t node = 0; node < matrices.mesh.num_nodes(); ++node) {
    pair(nodes.rows[d * node], nodes.rows[d * node + 1], node);
    if (!nodes.rotations.empty() && d == 3)
      pair(nodes.rotations[3 * node], nodes.rotations[3 * node + 1], node);
  }
  turn.finish();
  turn.apply(system.mass);
  turn.apply(system.velocity);
  turn.apply(system.position);
  if (system.loss.size() > 0) turn.apply(system.loss);
}

double unit_of(const std::string& unit, const char* key, const char* of) {
  try {
    return parse_quantity("1 " + unit, of);
  } catch (const std::invalid_argument& error) {
    throw ConfigError(Refusal::wrong_mesh, key, error.what());
  }
}

/// The matrices with A_ij multiplied by s_i s_j.
SparseMatrix scaled(const SparseMatrix& matrix, const Eigen::VectorXd& scales, double factor) {
  return scales.asDiagonal() * SparseMatrix(factor * matrix) * scales.asDiagonal();
}

}  // namespace

SparseSystem sum(const NamedMatrices& matrices, const MatrixBodyParameters& body,
                 const MatrixNodesParameters& nodes) {
  SparseSystem system;
  system.mass = matrices.mass;
  system.velocity = matrices.damping + matrices.gyroscopic;
  system.position = matrices.stiffness + matrices.circulatory;
  for (std::size_t i = 0; i < body.terms.size(); ++i) {
    const MatrixRole role = body.terms[i].role;
    if (role == MatrixRole::structural && system.loss.size() == 0)
      system.loss.resize(system.size(), system.size());
    SparseMatrix& to = role == MatrixRole::structural ? system.loss
                       : is_of_velocity(role)         ? system.velocity
                                                      : system.position;
    const SparseMatrix before = std::move(to);
    to = before + body.terms[i].factor * matrices.terms.at(i);
  }
  const double length = unit_of(nodes.length_unit, "length_unit", "m");
  const double force = unit_of(nodes.force_unit, "force_unit", "N");
  const double time = unit_of(nodes.time_unit, "time_unit", "s");
  if (length == 1.0 && force == 1.0 && time == 1.0) return system;
  // Energy ½ uᵀKu is a number of force x length; displacements are numbers of lengths, rotations of
  // radians.
  const double energy = force * length;
  Eigen::VectorXd scales = Eigen::VectorXd::Constant(system.size(), 1.0 / length);
  for (std::size_t row = 0; row < matrices.unknowns.size(); ++row)
    if (matrices.unknowns[row].direction > 3) scales(static_cast<Eigen::Index>(row)) = 1.0;
  system.mass = scaled(system.mass, scales, energy * time * time);
  system.velocity = scaled(system.velocity, scales, energy * time);
  system.position = scaled(system.position, scales, energy);
  if (system.loss.size() > 0) system.loss = scaled(system.loss, scales, energy);
  return system;
}

int dimension_of(const NamedMatrices& matrices) {
  if (has_elements(matrices)) return matrices.mesh.dimension();
  const bool has_z = std::any_of(matrices.unknowns.begin(), matrices.unknowns.end(),
                                 [](const NodeUnknown& unknown) { return unknown.direction == 3; });
  return has_z ? 3 : 2;
}

NodeRows node_rows(const NamedMatrices& matrices) {
  const Mesh& mesh = matrices.mesh;
  const auto d = static_cast<std::size_t>(dimension_of(matrices));
  std::unordered_map<std::int64_t, std::size_t> position;
  for (std::size_t node = 0; node < mesh.num_nodes(); ++node)
    position.emplace(mesh.node_labels[node], node);
  NodeRows found;
  found.rows.assign(d * mesh.num_nodes(), BodyMatrices::held);
  const bool turns = std::any_of(matrices.unknowns.begin(), matrices.unknowns.end(),
                                 [](const NodeUnknown& unknown) {
                                   return unknown.direction >= 4 && unknown.direction <= 6;
                                 });
  if (turns) found.rotations.assign(3 * mesh.num_nodes(), BodyMatrices::held);
  std::vector<bool> moves(mesh.num_nodes(), false);
  for (std::size_t row = 0; row < matrices.unknowns.size(); ++row) {
    const NodeUnknown& unknown = matrices.unknowns[row];
    const auto node = position.find(unknown.node);
    if (node == position.end()) {
      if (unknown.is_displacement()) found.missing.push_back(unknown.node);
      continue;
    }
    const auto direction = static_cast<std::size_t>(unknown.direction);
    if (unknown.is_displacement() && direction <= d) {
      found.rows[d * node->second + direction - 1] = static_cast<int>(row);
      moves[node->second] = true;
    } else if (direction >= 4 && direction <= 6) {
      found.rotations[3 * node->second + direction - 4] = static_cast<int>(row);
    }
  }
  std::sort(found.missing.begin(), found.missing.end());
  found.missing.erase(std::unique(found.missing.begin(), found.missing.end()), found.missing.end());
  found.num_without = static_cast<std::size_t>(std::count(moves.begin(), moves.end(), false));
  return found;
}

Mesh named_mesh(const TouchedMatrixBodyParameters& parameters) {
  const MeshBodyParameters keys = mesh_keys(parameters);
  NodalMatrices none;
  none.dimension = dimension_of(*parameters.matrices);
  none.rows.assign(static_cast<std::size_t>(none.dimension) * keys.mesh->num_nodes(),
                   BodyMatrices::held);
  return named_mesh(keys, none);
}

double num_nodes_named(const TouchedMatrixBodyParameters& parameters, const std::string& name) {
  const Mesh mesh = named_mesh(parameters);
  const auto surface = mesh.surfaces.find(name);
  return surface == mesh.surfaces.end()
             ? 0.0
             : static_cast<double>(nodes_of(mesh, surface->second).size());
}

BodyMatrices make_nodal_body(const TouchedMatrixBodyParameters& parameters) {
  refuse_number_keys(parameters);
  const NamedMatrices& matrices = *parameters.matrices;
  NodeRows nodes = node_rows(matrices);
  SparseSystem system = sum(matrices, parameters.body, parameters.nodes);
  if (parameters.angle != 0.0) turn(matrices, nodes, parameters.angle, system);
  BodyMatrices parts;
  take_system(std::move(system), parts);
  const NodalMatrices nodal{dimension_of(matrices),        std::move(parts.mass),
                            std::move(parts.stiffness),    parts.damping,
                            std::move(parts.velocity),     std::move(parts.circulatory),
                            std::move(nodes.rows),         std::move(nodes.rotations),
                            std::move(parts.loss_stiffness)};
  BodyMatrices body = make_meshed_body(mesh_keys(parameters), nodal);
  add_point_surfaces(parameters, body);
  return body;
}

}  // namespace stridor
