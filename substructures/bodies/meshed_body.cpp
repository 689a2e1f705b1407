#include "substructures/bodies/meshed_body.hpp"

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

/// Surfaces of a planar body that are a chain of edges, and what is drawn besides.
void add_outlines(const MeshBodyParameters& parameters, const Mesh& mesh, BodyMatrices& body) {
  for (const auto& [name, sides] : mesh.surfaces) {
    try {
      body.surfaces[name] = outline_of(mesh, sides);
    } catch (const std::invalid_argument& error) {
      if (parameters.surfaces.contains(name)) throw ConfigError("surfaces." + name, error.what());
    }
  }
  // What is drawn whether surfaces have names or not.
  for (const ElementSide& side : outer_sides(mesh)) {
    std::vector<int> nodes = nodes_of(mesh, side);
    if (nodes.size() == 3) std::swap(nodes[1], nodes[2]);
    body.outlines.push_back(std::move(nodes));
  }
}

}  // namespace

Mesh named_mesh(const MeshBodyParameters& parameters) {
  return NamedMesh(parameters).mesh;
}

BodyMatrices make_meshed_body(const MeshBodyParameters& parameters) {
  NamedMesh named(parameters);
  const MeshConstraints constraints = make_constraints(parameters, named);
  const Mesh& mesh = named.mesh;
  const MeshSections sections = named.sections();
  const SparseMatrix choice = constraints.matrix();
  BodyMatrices body;
  body.damping = parameters.damping;
  body.nodes = mesh.nodes.leftCols<2>();
  body.kept = constraints.determinate;
  add_displacements(constraints, static_cast<std::size_t>(named.dimension), body);
  try {
    const MeshMatrices all = assemble_mesh(mesh, sections);
    body.mass = projected(all.mass, choice);
    body.stiffness = projected(all.stiffness, choice);
    if (body.follows_drive()) {
      // Held nodes move with the support.
      Eigen::VectorXd along_x = Eigen::VectorXd::Zero(all.mass.rows());
      for (Eigen::Index row = 0; row < along_x.size(); row += named.dimension) along_x(row) = 1.0;
      body.base_inertia = choice.transpose() * (all.mass * along_x);
    }
  } catch (const std::invalid_argument& error) {
    throw ConfigError("file", error.what());
  }
  add_material_damping(parameters, named, sections, choice, body);
  if (named.dimension == 2) add_outlines(parameters, mesh, body);
  add_to_mesh_body(parameters, named, constraints, body);
  return body;
}

}  // namespace stridor
