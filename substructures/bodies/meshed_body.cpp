#include "substructures/bodies/meshed_body.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <stdexcept>
#include <utility>

#include "core/errors.hpp"
#include "substructures/bodies/mesh_additions.hpp"
#include "substructures/bodies/mesh_constraints.hpp"
#include "substructures/bodies/named_mesh.hpp"
#include "substructures/elements/assembly.hpp"
#include "substructures/elements/mesh_surfaces.hpp"

namespace stridor {
namespace {

/// Aᵀ X A.
SparseMatrix projected(const SparseMatrix& matrix, const SparseMatrix& choice) {
  const SparseMatrix transposed = choice.transpose();
  return (transposed * matrix * choice).pruned(0.0, 0.0);
}

/// Displacements of the nodes in terms of the DoFs.
void add_displacements(const MeshConstraints& constraints, std::size_t dimension,
                       BodyMatrices& body) {
  const std::size_t num_nodes = constraints.rows.size() / dimension;
  body.load_dof = constraints.load_dof;
  body.node_dofs.assign(num_nodes, {BodyMatrices::held, BodyMatrices::held});
  if (dimension == 3) body.across.assign(num_nodes, BodyMatrices::held);
  for (std::size_t node = 0; node < num_nodes; ++node) {
    const auto* const rows = &constraints.rows[dimension * node];
    const bool is_plain = std::all_of(rows, rows + dimension, [](const DofSum& row) {
      return row.empty() || (row.size() == 1 && row.front().weight == 1.0);
    });
    if (!is_plain) {
      auto& sums = body.dependent[static_cast<int>(node)];
      std::copy(rows, rows + dimension, sums.begin());
      continue;
    }
    for (std::size_t i = 0; i < dimension; ++i) {
      const int dof = rows[i].empty() ? BodyMatrices::held : rows[i].front().dof;
      (i < 2 ? body.node_dofs[node][i] : body.across[node]) = dof;
    }
  }
}

/// Damping of single materials (docs/theory.md, 1.7).
void add_material_damping(const MeshBodyParameters& parameters, const NamedMesh& named,
                          const MeshSections& sections, const SparseMatrix& choice,
                          BodyMatrices& body) {
  std::vector<const MeshMaterialParameters*> materials{&parameters.material};
  for (const auto& entry : parameters.materials) materials.push_back(&entry.second);
  std::vector<SectionFactors> viscous, structural;
  bool is_viscous = false;
  bool is_structural = false;
  for (const MeshMaterialParameters* material : materials) {
    const MaterialDampingParameters damping =
        material->damping.value_or(MaterialDampingParameters{});
    viscous.push_back({damping.beta, damping.alpha});
    structural.push_back({material->loss_factor, 0.0});
    is_viscous |= damping.beta > 0.0 || damping.alpha > 0.0;
    is_structural |= material->loss_factor > 0.0;
  }
  if (is_viscous) {
    const MeshMatrices parts = assemble_mesh(named.mesh, sections, viscous);
    body.velocity = projected(parts.stiffness + parts.mass, choice);
    body.circulatory.resize(body.num_dofs(), body.num_dofs());
  }
  if (is_structural)
    body.loss_stiffness =
        projected(assemble_mesh(named.mesh, sections, structural).stiffness, choice);
}

/// Surfaces of a planar body that are a chain of edges, and what is drawn besides; facets of a body in
/// space.
void add_outlines(const MeshBodyParameters& parameters, const Mesh& mesh, int dimension,
                  BodyMatrices& body) {
  if (dimension == 3) {
    for (const auto& [name, sides] : mesh.surfaces) body.facets[name] = facets_of(mesh, sides);
    return;
  }
  for (const auto& [name, sides] : mesh.surfaces) {
    try {
      body.surfaces[name] = outline_of(mesh, sides);
    } catch (const std::invalid_argument& error) {
      if (parameters.surfaces.contains(name))
        throw ConfigError(Refusal::wrong_mesh, "surfaces." + name, error.what());
    }
  }
  // What is drawn whether surfaces have names or not.
  for (const ElementSide& side : outer_sides(mesh)) {
    std::vector<int> nodes = nodes_of(mesh, side);
    if (nodes.size() == 3) std::swap(nodes[1], nodes[2]);
    body.outlines.push_back(std::move(nodes));
  }
}

/// Matrices of the elements.
void add_element_matrices(const MeshBodyParameters& parameters, const NamedMesh& named,
                          const MeshConstraints& constraints, BodyMatrices& body) {
  const MeshSections sections = named.sections();
  const SparseMatrix choice = constraints.matrix();
  body.damping = parameters.damping;
  try {
    const MeshMatrices all = assemble_mesh(named.mesh, sections);
    body.mass = projected(all.mass, choice);
    body.stiffness = projected(all.stiffness, choice);
    if (body.follows_drive()) {
      // Held nodes move with the support.
      Eigen::VectorXd along_x = Eigen::VectorXd::Zero(all.mass.rows());
      for (Eigen::Index row = 0; row < along_x.size(); row += named.dimension) along_x(row) = 1.0;
      body.base_inertia = choice.transpose() * (all.mass * along_x);
    }
  } catch (const std::invalid_argument& error) {
    throw ConfigError(Refusal::wrong_mesh, "file", error.what());
  }
  add_material_damping(parameters, named, sections, choice, body);
}

/// Matrices from elsewhere.
void add_given_matrices(const NodalMatrices& given, const Mesh& mesh,
                        const MeshConstraints& constraints, BodyMatrices& body) {
  const SparseMatrix choice = constraints.matrix(given);
  body.damping = given.damping;
  body.mass = projected(given.mass, choice);
  body.stiffness = projected(given.stiffness, choice);
  if (given.loss_stiffness.size() > 0)
    body.loss_stiffness = projected(given.loss_stiffness, choice);
  if (given.velocity.size() > 0) {
    const SparseMatrix transposed = choice.transpose();
    body.velocity = transposed * given.velocity * choice;
    body.circulatory = transposed * given.circulatory * choice;
  }
  if (!body.follows_drive()) return;
  Eigen::VectorXd along_x = Eigen::VectorXd::Zero(given.mass.rows());
  const auto d = static_cast<std::size_t>(given.dimension);
  for (std::size_t k = 0; k < given.rows.size(); k += d) {
    if (given.rows[k] == BodyMatrices::held) {
      throw ConfigError(Refusal::wrong_value, "guided.on",
                        fmt::format("the matrices hold node {} along x, so the inertia of a body "
                                    "that is driven along x is not known; leave all nodes free "
                                    "there when they are written",
                                    mesh.node_labels[k / d]));
    }
    along_x(given.rows[k]) = 1.0;
  }
  body.base_inertia = choice.transpose() * (given.mass * along_x);
}

BodyMatrices make_meshed_body(const MeshBodyParameters& parameters, const NodalMatrices* given) {
  NamedMesh named(parameters, given);
  const MeshConstraints constraints = make_constraints(parameters, named);
  BodyMatrices body;
  body.nodes = named.mesh.nodes;
  body.kept = constraints.determinate;
  add_displacements(constraints, static_cast<std::size_t>(named.dimension), body);
  if (given == nullptr) {
    add_element_matrices(parameters, named, constraints, body);
  } else {
    add_given_matrices(*given, named.mesh, constraints, body);
  }
  add_outlines(parameters, named.mesh, named.dimension, body);
  const SparseMatrix viscous = body.velocity;  // without that of springs, which do not turn
  add_to_mesh_body(parameters, named, constraints, body);
  if (parameters.spin) add_mesh_spin(parameters, named, constraints, viscous, body);
  return body;
}

}  // namespace

Mesh named_mesh(const MeshBodyParameters& parameters) {
  return NamedMesh(parameters).mesh;
}

Mesh named_mesh(const MeshBodyParameters& parameters, const NodalMatrices& matrices) {
  return NamedMesh(parameters, &matrices).mesh;
}

BodyMatrices make_meshed_body(const MeshBodyParameters& parameters) {
  return make_meshed_body(parameters, nullptr);
}

BodyMatrices make_meshed_body(const MeshBodyParameters& parameters, const NodalMatrices& matrices) {
  return make_meshed_body(parameters, &matrices);
}

}  // namespace stridor
