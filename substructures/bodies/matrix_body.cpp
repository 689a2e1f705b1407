#include "substructures/bodies/matrix_body.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "core/errors.hpp"
#include "core/suggestion.hpp"
#include "substructures/bodies/nodal_body.hpp"
#include "substructures/reduction/proportional_damping.hpp"

namespace stridor {
namespace {

std::string listed(const std::map<std::string, MatrixPointParameters>& points) {
  std::vector<std::string> names;
  names.reserve(points.size());
  for (const auto& entry : points) names.push_back(entry.first);
  return fmt::format("{}", fmt::join(names, ", "));
}

/// Keys that mean something only where it is known which rows are which nodes.
void refuse_node_keys(const TouchedMatrixBodyParameters& parameters) {
  const auto refuse = [](const std::string& key) {
    throw ConfigError(Refusal::missing, key,
                      "needs to know which rows of the matrices are which nodes; give `unknowns`");
  };
  for (const auto& [name, point] : parameters.points) {
    if (point.node) refuse("points." + name + ".node");
    if (!point.mean_of.empty()) refuse("points." + name + ".mean_of");
    if (point.at.size() != 2)
      throw ConfigError(Refusal::wrong_size, "points." + name + ".at",
                        "must be two lengths, x and y");
  }
  for (const auto& [name, surface] : parameters.surfaces)
    if (surface.points.empty()) refuse("surfaces." + name);
  if (!parameters.supports.empty()) refuse("supports");
  if (!parameters.springs.empty()) refuse("springs");
  if (parameters.angle != 0.0) refuse("angle");
  if (parameters.guided && !parameters.guided->on.empty()) refuse("guided.on");
}

/// An unknown counted from 1, or `held`.
int dof_of(std::int64_t number, Eigen::Index num_dofs, const std::string& key) {
  if (number > num_dofs) {
    throw ConfigError(
        Refusal::unknown_name, key,
        fmt::format("there is no unknown {}: the matrices have {}", number, num_dofs));
  }
  return static_cast<int>(number) - 1;
}

}  // namespace

void take_system(SparseSystem system, BodyMatrices& body) {
  const Eigen::Index n = system.size();
  body.mass = std::move(system.mass);
  const SparseMatrix transposed = system.position.transpose();
  body.stiffness = 0.5 * (system.position + transposed);
  body.loss_stiffness = std::move(system.loss);
  SparseMatrix skew = 0.5 * (system.position - transposed);
  const std::optional<RayleighDamping> damping =
      proportional_damping(system.velocity, body.mass, body.stiffness);
  if (damping) body.damping = *damping;
  if (!damping || skew.norm() > 0.0) {
    body.velocity = damping ? SparseMatrix(n, n) : std::move(system.velocity);
    body.circulatory = std::move(skew);
  }
}

void add_point_surfaces(const TouchedMatrixBodyParameters& parameters, BodyMatrices& body) {
  for (const auto& [name, surface] : parameters.surfaces) {
    if (surface.points.empty()) continue;
    const std::string key = "surfaces." + name + ".points";
    if (body.points.contains(name))
      throw ConfigError(Refusal::doubled_name, "surfaces." + name,
                        "a point has this name already; take another");
    std::vector<int> nodes;
    for (const std::string& point : surface.points) {
      const auto found = body.points.find(point);
      if (found == body.points.end()) {
        std::vector<std::string> names;
        for (const auto& entry : body.points) names.push_back(entry.first);
        throw ConfigError(Refusal::unknown_name, key,
                          fmt::format("there is no point '{}'{} (there are: {})", point,
                                      did_you_mean(point, names), listed(parameters.points)));
      }
      if (!nodes.empty() &&
          !((body.nodes.row(nodes.back()) - body.nodes.row(found->second)).norm() > 0.0)) {
        throw ConfigError(Refusal::doubled_name, key,
                          fmt::format("'{}' stands where the point before it does", point));
      }
      nodes.push_back(found->second);
    }
    body.surfaces[name] = nodes;
  }
}

BodyMatrices make_matrix_body(const TouchedMatrixBodyParameters& parameters) {
  if (!parameters.matrices)
    throw std::invalid_argument("make_matrix_body: the matrices have not been read");
  if (parameters.has_nodes()) return make_nodal_body(parameters);
  refuse_node_keys(parameters);
  SparseSystem system = sum(*parameters.matrices, parameters.body, parameters.nodes);
  const Eigen::Index n = system.size();
  BodyMatrices body;
  take_system(std::move(system), body);
  body.nodes.resize(static_cast<Eigen::Index>(parameters.points.size()), 3);
  for (const auto& [name, point] : parameters.points) {
    const auto node = static_cast<int>(body.node_dofs.size());
    const std::string key = "points." + name;
    body.nodes.row(node) << point.at[0], point.at[1], 0.0;
    body.node_dofs.push_back({dof_of(point.x, n, key + ".x"), dof_of(point.y, n, key + ".y")});
    body.points[name] = node;
  }
  add_point_surfaces(parameters, body);
  if (!parameters.guided) return body;
  const MatrixGuideParameters& guide = *parameters.guided;
  body.load_dof = dof_of(guide.load, n, "guided.load");
  if (static_cast<Eigen::Index>(guide.translation.size()) != n) {
    throw ConfigError(Refusal::wrong_size, "guided.translation",
                      fmt::format("has {} numbers, expected one for each of the {} unknowns",
                                  guide.translation.size(), n));
  }
  body.base_inertia = body.mass * Eigen::Map<const Eigen::VectorXd>(guide.translation.data(), n);
  return body;
}

void TouchedMatrixBodyParameters::read(const BodyFiles& files) {
  matrices = std::make_shared<const NamedMatrices>(read_matrices(body, nodes, files));
}

bool TouchedMatrixBodyParameters::take_contents(const BodyParameters& other) {
  const auto* given = dynamic_cast<const TouchedMatrixBodyParameters*>(&other);
  if (given == nullptr || !given->matrices || !have_same_matrices(given->body, body) ||
      given->nodes != nodes)
    return false;
  matrices = given->matrices;
  return true;
}

BodyMatrices TouchedMatrixBodyParameters::make() const {
  return make_matrix_body(*this);
}

std::optional<int> TouchedMatrixBodyParameters::num_modes() const {
  if (!reduction) return std::nullopt;
  return reduction->fixed_interface_modes;
}

bool TouchedMatrixBodyParameters::is_filled() const {
  return has_nodes() && has_elements(*matrices) && matrices->mesh.dimension() == 2;
}

std::vector<DrawnElement> TouchedMatrixBodyParameters::elements() const {
  return has_nodes() ? drawn_elements(matrices->mesh) : std::vector<DrawnElement>();
}

double TouchedMatrixBodyParameters::num_slave_nodes(const std::string& name) const {
  if (has_nodes()) {
    const double num_nodes = num_nodes_named(*this, name);
    if (num_nodes > 0.0) return num_nodes;
  }
  const auto surface = surfaces.find(name);
  return surface == surfaces.end() ? 1.0 : static_cast<double>(surface->second.points.size());
}

ReductionSize TouchedMatrixBodyParameters::reduction_size(double interface_nodes) const {
  ReductionSize size;
  if (!matrices || !reduction) return size;
  const auto n = static_cast<double>(matrices->mass.rows());
  auto entries = static_cast<double>(matrices->stiffness.nonZeros());
  for (std::size_t i = 0; i < matrices->terms.size(); ++i) {
    if (!is_of_velocity(body.terms[i].role) && body.terms[i].role != MatrixRole::structural)
      entries += static_cast<double>(matrices->terms[i].nonZeros());
  }
  const double d = has_nodes() ? dimension_of(*matrices) : 2.0;
  size.interface = size.watched = std::min(d * interface_nodes, n);
  size.unknowns = n - size.interface;
  size.modes = reduction->fixed_interface_modes;
  size.matrix_entries = static_cast<double>(matrices->mass.nonZeros()) + entries;
  // As of a solid body under nested dissection.
  size.factor_entries =
      std::max(0.5 * entries, std::min(0.5 * n * n, 4.0 * std::pow(n, 4.0 / 3.0)));
  return size;
}

SizeKey TouchedMatrixBodyParameters::size_key() const {
  return {".mass", "give smaller matrices, or fewer points"};
}

std::optional<ImportFacts> TouchedMatrixBodyParameters::import_facts() const {
  if (!matrices || (matrices->files.empty() && !has_nodes())) return std::nullopt;
  constexpr int num_frequencies = 10;
  ImportFacts facts;
  facts.matrices = matrix_facts(*matrices, body, nodes, num_frequencies);
  if (has_nodes() && has_elements(*matrices)) facts.mesh = mesh_facts(named_mesh(*this), 1.0);
  return facts;
}

}  // namespace stridor
