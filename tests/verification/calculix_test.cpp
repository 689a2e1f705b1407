// Matrices of elements against those of CalculiX, which runs as a program of its own.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cstdlib>
#include <fstream>
#include <numeric>
#include <random>
#include <string>
#include <vector>

#include "core/helper_program.hpp"
#include "io/imports/mesh_file.hpp"
#include "substructures/elements/assembly.hpp"
#include "tests/support/element_meshes.hpp"
#include "tests/support/temporary_folder.hpp"

namespace stridor {
namespace {

constexpr double modulus = 2.1e11;
constexpr double ratio = 0.29;
constexpr double density = 7850.0;

/// Two cells in a row, every node moved by chance: curved sides where the shape has middle nodes.
Mesh distorted_cells(ElementShape shape) {
  const ElementShape linear = test::linear_shape(shape);
  Mesh mesh = test::linear_grid(
      {2, 1, 1}, {2.0, 1.0, 1.2}, false, [&](int, int, int) { return linear; },
      [](int, int, int) { return true; });
  if (test::is_quadratic(shape)) mesh = test::with_middles(mesh);
  std::mt19937 random(5);
  std::uniform_real_distribution<double> uniform(-0.06, 0.06);
  // Written with 15 digits, and so the same for both programs.
  for (double& entry : mesh.nodes.reshaped())
    entry = std::stod(fmt::format("{:.15g}", entry + uniform(random)));
  mesh.node_labels.resize(mesh.num_nodes());
  std::iota(mesh.node_labels.begin(), mesh.node_labels.end(), 1);
  return mesh;
}

std::string deck_of(const Mesh& mesh, const char* type) {
  std::string deck = "*NODE\n";
  for (std::size_t node = 0; node < mesh.num_nodes(); ++node) {
    const auto row = mesh.nodes.row(static_cast<Eigen::Index>(node));
    deck += fmt::format("{}, {:.15g}, {:.15g}, {:.15g}\n", node + 1, row(0), row(1), row(2));
  }
  deck += fmt::format("*ELEMENT, TYPE={}, ELSET=EALL\n", type);
  for (std::size_t e = 0; e < mesh.num_elements(); ++e) {
    deck += fmt::format("{}", e + 1);
    int on_line = 1;
    for (const int node : mesh.nodes_of(e)) {
      // At most 16 entries a line.
      deck += on_line == 15 ? ",\n" : ", ";
      on_line = on_line == 15 ? 1 : on_line + 1;
      deck += fmt::format("{}", node + 1);
    }
    deck += '\n';
  }
  return deck + fmt::format(
                    "*MATERIAL, NAME=M\n*ELASTIC\n{}, {}\n*DENSITY\n{}\n"
                    "*SOLID SECTION, ELSET=EALL, MATERIAL=M\n"
                    "*STEP\n*FREQUENCY, SOLVER=MATRIXSTORAGE\n*END STEP\n",
                    modulus, ratio, density);
}

/// A matrix of which CalculiX wrote one triangle, in the order of our DoFs.
Eigen::MatrixXd read_matrix(const std::string& path, const std::vector<int>& order) {
  std::ifstream file(path);
  EXPECT_TRUE(file.good()) << path;
  const auto n = static_cast<Eigen::Index>(order.size());
  Eigen::MatrixXd matrix = Eigen::MatrixXd::Zero(n, n);
  std::size_t row = 0;
  std::size_t column = 0;
  for (double value = 0.0; file >> row >> column >> value;) {
    const int i = order.at(row - 1);
    const int j = order.at(column - 1);
    matrix(i, j) = matrix(j, i) = value;
  }
  return matrix;
}

/// Our DoF of every equation, from lines "node.direction".
std::vector<int> read_order(const std::string& path) {
  std::ifstream file(path);
  std::vector<int> order;
  for (std::string word; file >> word;) {
    const std::size_t dot = word.find('.');
    order.push_back(3 * (std::stoi(word.substr(0, dot)) - 1) + std::stoi(word.substr(dot + 1)) - 1);
  }
  return order;
}

class CalculixTest : public testing::TestWithParam<std::pair<ElementShape, const char*>> {};

// Both sum the same polynomials at the same points; 13 digits are written.
TEST_P(CalculixTest, HasTheSameMatrices) {
  const auto [shape, type] = GetParam();
  const Mesh mesh = distorted_cells(shape);
  const test::TemporaryFolder folder;
  const std::string job = (folder / "job").string();
  std::ofstream(job + ".inp") << deck_of(mesh, type);
  const HelperOutcome outcome = run_helper({"ccx", "-i", job}, job + ".log", job + ".log");
  ASSERT_EQ(outcome.spawn_error, 0) << "ccx is missing: install calculix-ccx";
  const std::vector<int> order = read_order(job + ".dof");
  ASSERT_EQ(order.size(), 3 * mesh.num_nodes());

  // Our reader finds in the deck what was written.
  const Mesh read = read_mesh_file(job + ".inp").mesh;
  EXPECT_EQ(read.nodes, mesh.nodes);
  EXPECT_EQ(read.connectivity, mesh.connectivity);
  const MeshMatrices ours = assemble_mesh(
      read, one_section(read, {ElasticLaw(IsotropicElasticity{modulus, ratio}, PlaneState::none),
                               density}));
  const Eigen::MatrixXd stiffness(ours.stiffness);
  const Eigen::MatrixXd theirs = read_matrix(job + ".sti", order);
  EXPECT_LE((stiffness - theirs).cwiseAbs().maxCoeff(), 1e-12 * stiffness.cwiseAbs().maxCoeff());
  if (shape != ElementShape::hex20) return;  // the mass of C3D10 has too few points there
  const Eigen::MatrixXd mass(ours.mass);
  EXPECT_LE((mass - read_matrix(job + ".mas", order)).cwiseAbs().maxCoeff(),
            1e-12 * mass.cwiseAbs().maxCoeff());
}

INSTANTIATE_TEST_SUITE_P(Elements, CalculixTest,
                         testing::Values(std::pair(ElementShape::tet4, "C3D4"),
                                         std::pair(ElementShape::tet10, "C3D10"),
                                         std::pair(ElementShape::hex20, "C3D20")),
                         [](const auto& given) { return std::string(given.param.second); });

}  // namespace
}  // namespace stridor
