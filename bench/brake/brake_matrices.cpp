// Matrices of a disc brake with penalty contact, unsymmetric friction, Coriolis and damping terms,
// as Matrix Market files and a scene that names them: a large eigenvalue problem for stridor and
// for large_eigenvalues.py.
//
//   gmsh -3 -setnumber lc 0.027 -setnumber order 1 -o brake.msh bench/brake/brake.geo
//   build/release/bench/brake_matrices brake.msh DIRECTORY
//   build/release/stridor eig DIRECTORY/brake.yaml --below 16kHz
//
// K has the springs of the pads on the rings across the faces, F the friction that they cause,
// which the scene multiplies by its parameter mu.
#include <fmt/format.h>
#include <fmt/os.h>

#include <Eigen/Dense>
#include <cmath>
#include <cstdlib>
#include <string>
#include <vector>

#include "core/errors.hpp"
#include "io/imports/mesh_file.hpp"
#include "substructures/elements/assembly.hpp"
#include "substructures/elements/mesh_surfaces.hpp"

using namespace stridor;

namespace {

constexpr double stiffness_per_area = 1e14;  // N/m³
constexpr double spin = 40.0;                // Ω of the disc, rad/s
constexpr double loss_factor = 0.002;        // of the material ...
constexpr double loss_frequency = 18850.0;   // ... at 3 kHz, rad/s
using Triplets = std::vector<Eigen::Triplet<double>>;

/// Numbers of the unknowns; -1 where a node is held.
struct Unknowns {
  std::vector<int> of_dof;
  int count = 0;
};

Unknowns number_unknowns(const Mesh& mesh) {
  std::vector<bool> is_held(3 * mesh.num_nodes(), false);
  const auto hold = [&](const std::string& surface, int directions) {
    for (const int node : nodes_of(mesh, mesh.surfaces.at(surface)))
      for (int d = 0; d < directions; ++d) is_held[static_cast<std::size_t>(3 * node + d)] = true;
  };
  hold("held", 3);
  hold("pad_lower_back", 2);
  hold("pad_upper_back", 2);
  for (const int node : nodes_without_elements(mesh))
    for (int d = 0; d < 3; ++d) is_held[static_cast<std::size_t>(3 * node + d)] = true;
  Unknowns unknowns;
  for (const bool held : is_held) unknowns.of_dof.push_back(held ? -1 : unknowns.count++);
  return unknowns;
}

SparseMatrix matrix_of(const Triplets& triplets, const Unknowns& unknowns) {
  SparseMatrix matrix(unknowns.count, unknowns.count);
  Triplets free;
  for (const auto& entry : triplets) {
    const int row = unknowns.of_dof[static_cast<std::size_t>(entry.row())];
    const int column = unknowns.of_dof[static_cast<std::size_t>(entry.col())];
    if (row >= 0 && column >= 0) free.emplace_back(row, column, entry.value());
  }
  matrix.setFromTriplets(free.begin(), free.end());
  return matrix;
}

void add(Triplets& triplets, const SparseMatrix& matrix, double factor) {
  for (Eigen::Index column = 0; column < matrix.cols(); ++column)
    for (SparseMatrix::InnerIterator entry(matrix, column); entry; ++entry)
      triplets.emplace_back(static_cast<int>(entry.row()), static_cast<int>(column),
                            factor * entry.value());
}

/// 2 Ω ẑ x u̇ of the material of the disc, seen from the disc.
Triplets coriolis(const Mesh& mesh, const SparseMatrix& mass) {
  std::vector<bool> is_disc(mesh.num_nodes(), false);
  for (const int element : mesh.element_sets.at("disc"))
    for (const int node : mesh.nodes_of(static_cast<std::size_t>(element)))
      is_disc[static_cast<std::size_t>(node)] = true;
  Triplets triplets;
  for (Eigen::Index column = 0; column < mass.cols(); column += 3) {
    if (!is_disc[static_cast<std::size_t>(column / 3)]) continue;
    for (SparseMatrix::InnerIterator entry(mass, column); entry; ++entry) {
      if (entry.row() % 3 != 0) continue;
      const int a = static_cast<int>(entry.row());
      const int b = static_cast<int>(column);
      triplets.emplace_back(a, b + 1, -2.0 * spin * entry.value());
      triplets.emplace_back(a + 1, b, 2.0 * spin * entry.value());
    }
  }
  return triplets;
}

/// A node with its weight in a displacement.
using Weights = std::vector<std::pair<int, double>>;

/// Where a node lies on one of some triangles, seen along z.
Weights weights_on(const Mesh& mesh, const std::vector<ElementSide>& sides, int node) {
  Weights best;
  double least = -1e300;
  const Eigen::Vector2d place = mesh.nodes.row(node).head<2>();
  for (const ElementSide& side : sides) {
    const std::vector<int> corners = nodes_of(mesh, side);
    Eigen::Matrix3d system;
    for (int k = 0; k < 3; ++k)
      system.col(k) << mesh.nodes.row(corners[static_cast<std::size_t>(k)]).head<2>().transpose(),
          1.0;
    const Eigen::Vector3d weights = system.inverse() * Eigen::Vector3d(place.x(), place.y(), 1.0);
    if (weights.minCoeff() <= least) continue;
    least = weights.minCoeff();
    best.clear();
    for (int k = 0; k < 3; ++k) best.emplace_back(corners[static_cast<std::size_t>(k)], weights(k));
  }
  return best;
}

/// Springs of a pad's face on a ring, and friction: k w b_nᵀ b_n and k w b_tᵀ b_n.
/// @param up +1 where the pad is above the ring
void add_contact(const Mesh& mesh, const MeshSections& sections, const std::string& pad,
                 const std::string& ring, double up, Triplets& normal, Triplets& friction) {
  const auto& sides = mesh.surfaces.at(pad);
  const Eigen::VectorXd areas = node_areas(mesh, sections, sides);
  for (const int node : nodes_of(mesh, sides)) {
    const double k = stiffness_per_area * areas(node);
    Weights relative = weights_on(mesh, mesh.surfaces.at(ring), node);
    for (auto& [other, weight] : relative) weight = -weight;
    relative.emplace_back(node, 1.0);
    const Eigen::Vector2d radius = mesh.nodes.row(node).head<2>().normalized();
    const Eigen::Vector2d along(-radius.y(), radius.x());  // the way the disc turns
    for (const auto& [a, weight_a] : relative) {
      for (const auto& [b, weight_b] : relative) {
        normal.emplace_back(3 * a + 2, 3 * b + 2, k * weight_a * weight_b);
        for (int d = 0; d < 2; ++d)
          friction.emplace_back(3 * a + d, 3 * b + 2, k * weight_a * along(d) * weight_b * up);
      }
    }
  }
}

void write(const std::string& path, const SparseMatrix& matrix, const std::string& symmetry) {
  auto file = fmt::output_file(path);
  const bool is_whole = symmetry == "general";
  std::size_t count = 0;
  const auto for_entries = [&](auto&& act) {
    for (Eigen::Index column = 0; column < matrix.cols(); ++column)
      for (SparseMatrix::InnerIterator entry(matrix, column); entry; ++entry)
        if (is_whole || entry.row() > column || (entry.row() == column && symmetry == "symmetric"))
          act(entry);
  };
  for_entries([&](const auto&) { ++count; });
  file.print("%%MatrixMarket matrix coordinate real {}\n{} {} {}\n", symmetry, matrix.rows(),
             matrix.cols(), count);
  for_entries([&](const auto& entry) {
    file.print("{} {} {:.17g}\n", entry.row() + 1, entry.col() + 1, entry.value());
  });
}

constexpr const char* scene = R"(# Written by bench/brake_matrices.
format: 2
parameters: {mu: 0.3}
substructures:
  brake:
    type: matrices
    mass: M.mtx
    damping: D.mtx
    gyroscopic: G.mtx
    stiffness: K.mtx
    terms:
      - {role: position, matrix: F.mtx, factor: =mu}
)";

}  // namespace

int main(int argc, char** argv) try {
  if (argc != 3) {
    fmt::print(stderr, "usage: brake_matrices MESH DIRECTORY\n");
    return 2;
  }
  const Mesh mesh = read_mesh_file(argv[1]).mesh;
  const std::string directory = std::string(argv[2]) + "/";
  const ElasticLaw steel(IsotropicElasticity{200e9, 0.3}, PlaneState::none);
  const MeshSections sections = one_section(mesh, {steel, 7850.0});
  const MeshMatrices matrices = assemble_mesh(mesh, sections);
  const Unknowns unknowns = number_unknowns(mesh);

  Triplets mass, damping, stiffness, friction;
  add(mass, matrices.mass, 1.0);
  add(damping, matrices.stiffness, loss_factor / loss_frequency);
  add(stiffness, matrices.stiffness, 1.0);
  add_contact(mesh, sections, "pad_upper_face", "disc_upper", 1.0, stiffness, friction);
  add_contact(mesh, sections, "pad_lower_face", "disc_lower", -1.0, stiffness, friction);
  write(directory + "M.mtx", matrix_of(mass, unknowns), "symmetric");
  write(directory + "D.mtx", matrix_of(damping, unknowns), "symmetric");
  write(directory + "G.mtx", matrix_of(coriolis(mesh, matrices.mass), unknowns), "skew-symmetric");
  write(directory + "K.mtx", matrix_of(stiffness, unknowns), "symmetric");
  write(directory + "F.mtx", matrix_of(friction, unknowns), "general");
  fmt::output_file(directory + "brake.yaml").print("{}", scene);
  fmt::print("{} unknowns\n", unknowns.count);
  return 0;
} catch (const std::exception& error) {
  fmt::print(stderr, "{}\n", error.what());
  return 1;
}
