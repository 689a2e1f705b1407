// Parts of a public brake, meshed by gmsh, against CalculiX on the same mesh.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <memory>
#include <numbers>
#include <string>
#include <vector>

#include "core/helper_program.hpp"
#include "io/imports/gmsh_program.hpp"
#include "io/imports/mesh_file.hpp"
#include "substructures/bodies/mesh_body.hpp"
#include "substructures/elements/mesh_surfaces.hpp"
#include "substructures/reduction/craig_bampton.hpp"
#include "substructures/reduction/modal_body.hpp"
#include "tests/support/temporary_folder.hpp"

namespace stridor {
namespace {

namespace fs = std::filesystem;

constexpr double modulus = 200e9;
constexpr double ratio = 0.3;
constexpr double density = 7850.0;

class BrakeParts : public testing::Test {
 protected:
  /// A part of scenes/examples/brake in elements of a size.
  MeshBodyParameters part(const std::string& name, double size) {
    for (const auto& entry : fs::directory_iterator(STRIDOR_SOURCE_DIR "/scenes/examples/brake"))
      if (entry.path().extension() == ".geo")
        fs::copy_file(entry.path(), folder_ / entry.path().filename().string(),
                      fs::copy_options::overwrite_existing);
    MeshBodyParameters body;
    body.file = mesh_with_gmsh((folder_ / name).string(), {size, 2});
    body.mesh = std::make_shared<const Mesh>(read_mesh_file(body.file).mesh);
    body.material = {modulus, ratio, density};
    return body;
  }

  static std::vector<double> frequencies(const MeshBodyParameters& body, int modes, int wanted) {
    const BodyMatrices matrices = body.make();
    const ModalBody modal = make_modal(make_craig_bampton(matrices, matrices.kept, modes, {}));
    std::vector<double> found;
    for (Eigen::Index i = 0; i < wanted; ++i)
      found.push_back(modal.omega(i) / (2.0 * std::numbers::pi));
    return found;
  }

  /// Of the same mesh by CalculiX.
  std::vector<double> calculix(const MeshBodyParameters& body, const std::string& held,
                               int wanted) {
    const std::string job = (folder_ / "job").string();
    std::ofstream deck(job + ".inp");
    // Fields of a card have up to 20 letters.
    deck << "*NODE, NSET=NALL\n";
    const Mesh& mesh = *body.mesh;
    for (Eigen::Index node = 0; node < mesh.nodes.rows(); ++node)
      deck << fmt::format("{}, {:.12e}, {:.12e}, {:.12e}\n", node + 1, mesh.nodes(node, 0),
                          mesh.nodes(node, 1), mesh.nodes(node, 2));
    deck << "*ELEMENT, TYPE=C3D10, ELSET=EALL\n";
    for (std::size_t e = 0; e < mesh.num_elements(); ++e) {
      deck << e + 1;
      for (const int node : mesh.nodes_of(e)) deck << ", " << node + 1;
      deck << '\n';
    }
    if (!held.empty()) {
      deck << "*NSET, NSET=HELD\n";
      for (const int node : nodes_of(mesh, mesh.surfaces.at(held))) deck << node + 1 << ",\n";
      deck << "*BOUNDARY\nHELD, 1, 3\n";
    }
    deck << fmt::format("*MATERIAL, NAME=M\n*ELASTIC\n{}, {}\n*DENSITY\n{}\n", modulus, ratio,
                        density)
         << "*SOLID SECTION, ELSET=EALL, MATERIAL=M\n*STEP\n*FREQUENCY\n"
         << wanted << "\n*END STEP\n";
    deck.close();
    const HelperOutcome outcome = run_helper({"ccx", "-i", job}, job + ".log", job + ".log");
    EXPECT_EQ(outcome.spawn_error, 0) << "ccx is missing: install calculix-ccx";
    // "mode, eigenvalue, rad/time, cycles/time, imaginary part", after a heading.
    std::vector<double> found;
    std::ifstream results(job + ".dat");
    for (std::string line;
         std::getline(results, line) && static_cast<int>(found.size()) < wanted;) {
      int mode = 0;
      double eigenvalue = 0.0;
      double omega = 0.0;
      double frequency = 0.0;
      if (std::sscanf(line.c_str(), "%d %lf %lf %lf", &mode, &eigenvalue, &omega, &frequency) == 4)
        found.push_back(frequency);
    }
    return found;
  }

  test::TemporaryFolder folder_;
};

// The stiffness is the same to rounding; CalculiX integrates the mass of C3D10 at four points, we
// exactly, which the frequencies of a coarse mesh feel by some 1e-4.
TEST_F(BrakeParts, DiscThatIsHeldHasTheFrequenciesOfCalculix) {
  MeshBodyParameters disc = part("disc.geo", 0.02);
  disc.supports["bolted"] = {{"held"}, {}};
  const std::vector<double> expected = calculix(disc, "held", 20);
  ASSERT_EQ(expected.size(), 20u);
  const std::vector<double> found = frequencies(disc, 24, 20);
  for (std::size_t i = 0; i < found.size(); ++i)
    EXPECT_NEAR(found[i], expected[i], 1e-3 * expected[i]) << "mode " << i + 1;
  // Of the published finer mesh: 806.3 Hz; a coarser one is stiffer.
  EXPECT_GT(found[0], 806.3);
  EXPECT_LT(found[0], 1.06 * 806.3);
}

// Free: six motions without frequency, then those of the table for a mesh of 1,700 nodes.
TEST_F(BrakeParts, PadThatIsFreeHasItsTable) {
  const std::vector<double> found = frequencies(part("pad.geo", 0.009), 60, 12);
  for (std::size_t i = 0; i < 6; ++i) EXPECT_EQ(found[i], 0.0);
  const std::vector<double> table{3409.4, 6283.8, 6638.8, 8373.8, 13132.7, 15071.6};
  for (std::size_t i = 0; i < 6; ++i) EXPECT_NEAR(found[6 + i], table[i], 3e-3 * table[i]);
}

}  // namespace
}  // namespace stridor
