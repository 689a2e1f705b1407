#include "substructures/bodies/import_facts.hpp"

#include <Eigen/QR>
#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <utility>

#include "core/errors.hpp"
#include "core/units.hpp"
#include "substructures/bodies/matrix_body.hpp"
#include "substructures/bodies/nodal_body.hpp"
#include "substructures/elements/assembly.hpp"
#include "substructures/matrices/definiteness.hpp"
#include "substructures/matrices/massless_motions.hpp"
#include "substructures/reduction/lowest_modes.hpp"

namespace stridor {
namespace {

double asymmetry(const SparseMatrix& matrix) {
  const double size = matrix.norm();
  if (!(size > 0.0)) return 0.0;
  const SparseMatrix transposed = matrix.transpose();
  return SparseMatrix(matrix - transposed).norm() / size;
}

/// A shift s for which K + sM is well conditioned, small beside elastic motion of the elements.
double shift_of(const SparseMatrix& stiffness, const SparseMatrix& mass) {
  constexpr double share = 1e-7;
  const double trace = mass.diagonal().sum();
  return trace > 0.0 ? share * stiffness.diagonal().cwiseAbs().sum() / trace : 0.0;
}

/// The lowest ω² of K φ = ω² M φ, by the factor of K + sM.
Eigen::VectorXd lowest_squares(const SparseMatrix& stiffness, const SparseMatrix& mass,
                               Eigen::Index count) {
  constexpr Eigen::Index small = 300;
  if (mass.rows() <= small) {
    const SemidefinitePairs pairs = semidefinite_eigenpairs(
        Eigen::MatrixXd(stiffness), Eigen::MatrixXd(mass), "modes of the matrices");
    return pairs.values.head(std::min(count, pairs.values.size()));
  }
  const double shift = shift_of(stiffness, mass);
  const SparseMatrix shifted = stiffness + shift * mass;
  const SparseCholesky factor(shifted, "stiffness and a little mass");
  return lowest_modes(factor, shifted, mass, count).omega_squared.array() - shift;
}

void find_frequencies(const SparseMatrix& stiffness, const SparseMatrix& mass, int count,
                      MatrixFacts& facts) {
  if (count <= 0) return;
  try {
    const Eigen::VectorXd squares =
        lowest_squares(stiffness, mass, std::min<Eigen::Index>(count, mass.rows()));
    // Rounding of the stiffness of elements, against which a rigid motion has none.
    const double rounding = 1e-4 * shift_of(stiffness, mass);
    for (const double square : squares) {
      const bool is_rigid = std::abs(square) <= rounding;
      if (is_rigid) ++facts.num_rigid;
      facts.frequencies.push_back(
          is_rigid ? 0.0 : std::copysign(std::sqrt(std::abs(square)), square) /
                               (2.0 * std::numbers::pi));
    }
    std::sort(facts.frequencies.begin(), facts.frequencies.end());
    facts.stiffness = facts.frequencies.front() < 0.0 ? Definiteness::indefinite
                      : facts.num_rigid > 0           ? Definiteness::semidefinite
                                                      : Definiteness::positive;
  } catch (const NumericalError& error) {
    facts.trouble = error.what();
    facts.stiffness = Definiteness::indefinite;
  }
}

/// Rigid motions of all displacements of all nodes: translations along three axes and rotations
/// about them through the mean of the nodes, of lengths of 1.
Eigen::MatrixXd rigid_columns(const Mesh& mesh, int dimension) {
  const Eigen::RowVector3d mean = mesh.nodes.colwise().mean();
  Mesh::Nodes from_mean = mesh.nodes.rowwise() - mean;
  const double extent = std::max(from_mean.rowwise().norm().maxCoeff(), 1e-300);
  from_mean /= extent;
  const auto d = static_cast<Eigen::Index>(dimension);
  const Eigen::Index num_rotations = dimension == 3 ? 3 : 1;
  Eigen::MatrixXd motions = Eigen::MatrixXd::Zero(d * mesh.nodes.rows(), d + num_rotations);
  for (Eigen::Index node = 0; node < mesh.nodes.rows(); ++node) {
    const Eigen::Vector3d place = from_mean.row(node);
    motions.block(d * node, 0, d, d).setIdentity();
    for (Eigen::Index k = 0; k < num_rotations; ++k) {
      const Eigen::Vector3d axis = Eigen::Vector3d::Unit(dimension == 3 ? k : 2);
      motions.block(d * node, d + k, d, 1) = axis.cross(place).head(d);
    }
  }
  return motions;
}

/// How many rigid motions displace nothing that is held.
int count_free_motions(const Mesh& mesh, const NodeRows& nodes, int dimension) {
  const Eigen::MatrixXd motions = rigid_columns(mesh, dimension);
  // A motion displaces held nodes if and only if it has a part in HᵀH of their rows H.
  Eigen::MatrixXd squares = Eigen::MatrixXd::Zero(motions.cols(), motions.cols());
  for (std::size_t k = 0; k < nodes.rows.size(); ++k) {
    if (nodes.rows[k] != BodyMatrices::held) continue;
    const auto row = motions.row(static_cast<Eigen::Index>(k));
    squares += row.transpose() * row;
  }
  Eigen::ColPivHouseholderQR<Eigen::MatrixXd> factor(squares);
  factor.setThreshold(1e-10);
  return static_cast<int>(motions.cols() - factor.rank());
}

/// rᵀ M r and the centre of mass as translations r see it.
std::vector<DirectionMass> masses_of(const Mesh& mesh, const NodeRows& nodes, int dimension,
                                     const SparseMatrix& mass) {
  std::vector<DirectionMass> masses;
  const auto d = static_cast<std::size_t>(dimension);
  for (std::size_t direction = 0; direction < d; ++direction) {
    Eigen::VectorXd unit = Eigen::VectorXd::Zero(mass.rows());
    Eigen::MatrixXd places = Eigen::MatrixXd::Zero(mass.rows(), 3);
    for (std::size_t node = 0; node < mesh.num_nodes(); ++node) {
      const int row = nodes.rows[d * node + direction];
      if (row == BodyMatrices::held) continue;
      unit(row) = 1.0;
      places.row(row) = mesh.nodes.row(static_cast<Eigen::Index>(node));
    }
    const Eigen::VectorXd inertia = mass * unit;
    DirectionMass& found = masses.emplace_back();
    found.mass = unit.dot(inertia);
    found.centre = places.transpose() * inertia / found.mass;
  }
  return masses;
}

}  // namespace

MeshFacts mesh_facts(const Mesh& mesh, double thickness) {
  MeshFacts facts;
  facts.num_nodes = mesh.num_nodes();
  facts.dimension = mesh.dimension();
  for (const ElementShape shape : mesh.shapes) ++facts.elements[shape];
  // Volumes and areas; what it is made of does not matter.
  const ElementSection any{
      ElasticLaw(IsotropicElasticity{1.0, 0.0},
                 facts.dimension == 3 ? PlaneState::none : PlaneState::stress),
      1.0, thickness};
  const MeshSections sections = one_section(mesh, any);
  const MassProperties whole = mass_properties(mesh, sections);
  facts.volume = whole.volume;
  facts.centre = whole.centre;
  facts.lowest = mesh.nodes.colwise().minCoeff();
  facts.highest = mesh.nodes.colwise().maxCoeff();
  for (const auto& [name, nodes] : mesh.node_sets) facts.node_sets[name] = nodes.size();
  for (const auto& [name, elements] : mesh.element_sets) facts.element_sets[name] = elements.size();
  for (const auto& [name, sides] : mesh.surfaces) {
    SurfaceFacts& surface = facts.surfaces[name];
    surface.num_sides = sides.size();
    for (const ElementSide& side : sides) {
      const SideGeometry geometry = side_geometry(mesh, sections, side);
      surface.area += geometry.area;
      surface.normal += geometry.area * geometry.normal;
      surface.centre += geometry.area * geometry.centre;
    }
    if (!(surface.area > 0.0)) continue;
    surface.normal /= surface.area;
    surface.centre /= surface.area;
    // Of a closed or round surface nothing but rounding is left.
    surface.normal = (surface.normal.array().abs() < 1e-12).select(0.0, surface.normal);
  }
  return facts;
}

MatrixFacts matrix_facts(const NamedMatrices& matrices, const MatrixBodyParameters& body,
                         const MatrixNodesParameters& nodes, int num_frequencies) {
  const SparseSystem system = sum(matrices, body, nodes);
  MatrixFacts facts;
  facts.num_unknowns = system.size();
  facts.files = matrices.files;
  facts.mass_asymmetry = asymmetry(system.mass);
  facts.stiffness_asymmetry = asymmetry(system.position);
  facts.smallest_pivot = smallest_pivot_ratio(system.mass);
  facts.mass = facts.smallest_pivot > 1e-12             ? Definiteness::positive
               : is_positive_semidefinite(system.mass) ? Definiteness::semidefinite
                                                       : Definiteness::indefinite;
  const SparseMatrix transposed = system.position.transpose();
  const SparseMatrix stiffness = 0.5 * (system.position + transposed);
  find_frequencies(stiffness, system.mass, num_frequencies, facts);
  if (matrices.unknowns.empty()) return facts;
  const NodeRows rows = node_rows(matrices);
  const int dimension = dimension_of(matrices);
  Mesh mesh;
  mesh.nodes = matrices.mesh.nodes * parse_quantity("1 " + nodes.length_unit, "m");
  mesh.node_labels = matrices.mesh.node_labels;
  facts.num_nodes = mesh.num_nodes();
  facts.num_without = rows.num_without;
  facts.missing = rows.missing;
  if (facts.missing.empty()) facts.num_rigid_expected = count_free_motions(mesh, rows, dimension);
  facts.masses = masses_of(mesh, rows, dimension, system.mass);
  return facts;
}

}  // namespace stridor
