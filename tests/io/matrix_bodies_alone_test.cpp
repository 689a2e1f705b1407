#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>

#include "core/errors.hpp"
#include "io/scene/scene.hpp"
#include "io/scene/scene_family.hpp"
#include "io/scene/scene_files.hpp"
#include "substructures/matrices/linear_system.hpp"
#include "tests/support/message_of.hpp"
#include "tests/support/program.hpp"

namespace stridor {
namespace {

using test::message_of;
using ::testing::AllOf;
using ::testing::HasSubstr;

const char* const small_scene = R"(format: 2
parameters: {load: 0.5}
substructures:
  body:
    type: matrices
    mass: ["2 0", "0 1"]
    stiffness: K.mtx
    gyroscopic: ["0 3", "-3 0"]
    terms:
      - {role: position, matrix: ["0 2", "0 0"], factor: =load}
      - {role: velocity, matrix: D.mtx, factor: 0}
)";

/// The small scene in a folder of its own.
class MatrixFolder {
 public:
  MatrixFolder() {
    std::ofstream(path()) << small_scene;
    std::ofstream((folder_ / "K.mtx").string())
        << "%%MatrixMarket matrix array real symmetric\n2 2\n5\n1\n7\n";
    std::ofstream((folder_ / "D.mtx").string())
        << "%%MatrixMarket matrix array real general\n2 2\n5\n0\n1\n7\n";
  }
  std::string path() const { return (folder_ / "scene.yaml").string(); }
  Model model(const std::vector<std::string>& sets) const {
    BodyCache cache;
    return build_model(load_scene(path(), sets), cache);
  }
  /// M, P and Q of its only body.
  LinearSystem system(const std::vector<std::string>& sets) const {
    const ReducedBody body = model(sets).system.bodies.at(0).reduced;
    LinearSystem system;
    system.mass = body.mass;
    system.velocity = body.damping.alpha * body.mass + body.damping.beta * body.stiffness;
    system.position = body.stiffness;
    if (body.coupled.is_empty()) return system;
    system.velocity += body.coupled.velocity;
    system.position += body.coupled.position;
    return system;
  }
  std::string failure(const std::vector<std::string>& sets) const {
    return message_of<ConfigError>([&] { model(sets); });
  }

  void remove_files() const {
    std::filesystem::remove(folder_ / "K.mtx");
    std::filesystem::remove(folder_ / "D.mtx");
  }

 private:
  test::TemporaryFolder folder_;
};

TEST(MatrixBodiesAlone, AddsItsMatricesUp) {
  const MatrixFolder folder;
  const LinearSystem found = folder.system({});
  EXPECT_EQ(found.mass, (Eigen::MatrixXd{{2.0, 0.0}, {0.0, 1.0}}));
  EXPECT_EQ(found.velocity, (Eigen::MatrixXd{{0.0, 3.0}, {-3.0, 0.0}}));
  EXPECT_EQ(found.position, (Eigen::MatrixXd{{5.0, 2.0}, {1.0, 7.0}}));
}

TEST(MatrixBodiesAlone, TermsAddToTheMatrixOfTheirRole) {
  const MatrixFolder folder;
  const auto with = [&](const std::string& terms) {
    return folder.system({"substructures.body.terms=" + terms});
  };
  const Eigen::MatrixXd k{{5.0, 1.0}, {1.0, 7.0}};
  const Eigen::MatrixXd g{{0.0, 3.0}, {-3.0, 0.0}};
  for (const std::string role : {"stiffness", "circulatory", "position"}) {
    const LinearSystem found =
        with("[{role: " + role + ", matrix: [[0, 1], [-1, 0]], factor: 4}, {role: " + role +
             ", matrix: [[0, 1], [-1, 0]]}]");
    EXPECT_EQ(found.position, k + Eigen::MatrixXd({{0.0, 5.0}, {-5.0, 0.0}})) << role;
    EXPECT_EQ(found.velocity, g) << role;
  }
  for (const std::string role : {"damping", "gyroscopic", "velocity"}) {
    const LinearSystem found =
        with("[{role: " + role + ", matrix: [[0, 1], [-1, 0]], factor: =2*load}]");
    EXPECT_EQ(found.position, k) << role;
    EXPECT_EQ(found.velocity, g + Eigen::MatrixXd({{0.0, 1.0}, {-1.0, 0.0}})) << role;
  }
  // A term may be all there is of the stiffness.
  const LinearSystem alone = folder.system(
      {"substructures.body.stiffness=[]",
       "substructures.body.terms=[{role: stiffness, matrix: [[2, 0], [0, 4]], factor: =load}]"});
  EXPECT_EQ(alone.position, (Eigen::MatrixXd{{1.0, 0.0}, {0.0, 2.0}}));
}

TEST(MatrixBodiesAlone, TermsAreCheckedAsMatricesAre) {
  const MatrixFolder folder;
  const std::string set = "substructures.body.terms=";
  EXPECT_THAT(folder.failure({set + "[{role: gyroscopic, matrix: [[0, 1], [1, 0]]}]"}),
              HasSubstr("substructures.body.terms.0.matrix: must be skew-symmetric"));
  EXPECT_THAT(folder.failure({set + "[{role: circulatory, matrix: [[1, 0], [0, 1]]}]"}),
              HasSubstr("terms.0.matrix: must be skew-symmetric"));
  EXPECT_THAT(folder.failure({set + "[{role: position, matrix: [[1]]}]"}),
              HasSubstr("terms.0.matrix: is 1 x 1, expected 2 x 2 as `mass` is"));
  EXPECT_THAT(folder.failure({set + "[{role: position, matrix: []}]"}),
              HasSubstr("terms.0.matrix: is empty, expected a matrix"));
  EXPECT_THAT(folder.failure({set + "[{role: mass, matrix: [[1, 0], [0, 1]]}]"}),
              HasSubstr("terms.0.role"));
  EXPECT_THAT(folder.failure({set + "[]", "substructures.body.stiffness=[]"}),
              HasSubstr("stiffness: is missing; give it, or a term of the role stiffness"));
}

TEST(MatrixBodiesAlone, FormerKeysAreRefusedEachWithTheNewOne) {
  const MatrixFolder folder;
  const std::string body = "substructures.body.";
  EXPECT_THAT(folder.failure({body + "factors={gyroscopic: 2, stiffness: 3}"}),
              AllOf(HasSubstr("factors.gyroscopic: is now terms: [{role: gyroscopic, matrix"),
                    HasSubstr("factors.stiffness: is now terms: [{role: stiffness, matrix")));
  EXPECT_THAT(folder.failure({body + "load=0.5"}),
              HasSubstr("load: is now a parameter of the scene, `parameters: {load: ...}`"));
  EXPECT_THAT(
      folder.failure({body + "load_damping=[[1, 0], [0, 1]]"}),
      HasSubstr("load_damping: is now terms: [{role: velocity, matrix: ..., factor: =load}]"));
  EXPECT_THAT(folder.failure({body + "load_stiffness=L.mtx"}),
              HasSubstr("load_stiffness: is now terms: [{role: position"));
}

TEST(MatrixBodiesAlone, RowsAreListsOrTexts) {
  const MatrixFolder folder;
  const std::string body = "substructures.body.";
  const LinearSystem found =
      folder.system({body + "mass=[[4, 1], [1, 2.5e0]]", body + "gyroscopic=[[0, 3], '-3 0']"});
  EXPECT_EQ(found.mass, (Eigen::MatrixXd{{4.0, 1.0}, {1.0, 2.5}}));
  EXPECT_EQ(found.velocity, (Eigen::MatrixXd{{0.0, 3.0}, {-3.0, 0.0}}));
  EXPECT_THAT(folder.failure({body + "mass=[[1, 0], [0]]"}),
              HasSubstr("mass: row 2 has 1 numbers, expected 2"));
  EXPECT_THAT(folder.failure({body + "mass=[[1, x], [0, 1]]"}),
              HasSubstr("mass.0.1: 'x' is not a number"));
}

TEST(MatrixBodiesAlone, LargeMatricesStaySparse) {
  const test::TemporaryFolder folder;
  constexpr int n = 1001;
  for (const std::string name : {"M", "K"}) {
    std::ofstream file((folder / (name + ".mtx")).string());
    file << "%%MatrixMarket matrix coordinate real symmetric\n"
         << n << ' ' << n << ' ' << (name == "M" ? n : 2 * n - 1) << '\n';
    for (int i = 1; i <= n; ++i) file << i << ' ' << i << (name == "M" ? " 1\n" : " 2\n");
    if (name == "M") continue;
    for (int i = 1; i < n; ++i) file << i + 1 << ' ' << i << " -1\n";
  }
  const std::string path = (folder / "scene.yaml").string();
  std::ofstream(path) << "format: 2\nsubstructures:\n  chain: {type: matrices, mass: M.mtx, "
                         "stiffness: K.mtx}\n";
  BodyCache cache;
  const Model model = build_model(load_scene(path, {}), cache);
  ASSERT_TRUE(model.sparse.has_value());
  EXPECT_EQ(model.sparse->size(), n);
  EXPECT_EQ(model.sparse->position.nonZeros(), 3 * n - 2);
}

TEST(MatrixBodiesAlone, SaysWhichMatrixIsWrong) {
  const MatrixFolder folder;
  const std::string body = "substructures.body.";
  EXPECT_THAT(folder.failure({body + "mass=[1 0, 0 -1]"}),
              HasSubstr("mass: must be positive semidefinite"));
  EXPECT_THAT(folder.failure({body + "mass=[1 2, 0 1]"}), HasSubstr("mass: must be symmetric"));
  EXPECT_THAT(folder.failure({body + "mass=[]"}), HasSubstr("mass: is empty, expected a matrix"));
  EXPECT_THAT(folder.failure({body + "gyroscopic=[0 1, 1 0]"}),
              HasSubstr("gyroscopic: must be skew-symmetric"));
  EXPECT_THAT(folder.failure({body + "circulatory=[0 1 0, -1 0 0, 0 0 0]"}),
              HasSubstr("circulatory: is 3 x 3, expected 2 x 2 as `mass` is"));
  EXPECT_THAT(folder.failure({body + "mass=[1 a, 0 1]"}),
              HasSubstr("mass: row 1: expected a finite number, got 'a'"));
  EXPECT_THAT(message_of<FileError>([&] { folder.model({body + "damping=C.mtx"}); }),
              HasSubstr("C.mtx"));
}

TEST(MatrixBodiesAlone, AreReadOnceForAllValuesOfAKey) {
  const MatrixFolder folder;
  LoadedScene loaded = load_scene(folder.path(), {});
  const NumericKey key = find_numeric_key(loaded.scene, "parameters.load", "--parameter");
  SceneFamily family(loaded, {key});
  const auto position = [&](double load) {
    const ReducedBody body = family.at({{load}}).model->system.bodies.at(0).reduced;
    return Eigen::MatrixXd(body.stiffness + body.coupled.position);
  };
  EXPECT_EQ(position(0.5), (Eigen::MatrixXd{{5.0, 2.0}, {1.0, 7.0}}));
  folder.remove_files();
  EXPECT_EQ(position(1.5), (Eigen::MatrixXd{{5.0, 4.0}, {1.0, 7.0}}));
  EXPECT_THROW(folder.model({}), FileError);
}

TEST(MatrixBodiesAlone, HaveADigestOfEveryFile) {
  const MatrixFolder folder;
  const LoadedScene loaded = load_scene(folder.path(), {});
  const std::vector<SceneFile> files = scene_files(loaded);
  ASSERT_EQ(files.size(), 2U);
  EXPECT_EQ(files[1].key, "substructures.body.terms.1.matrix");
  EXPECT_EQ(files[0].key, "substructures.body.stiffness");
  const std::string hash = loaded.hash();
  std::ofstream(files[0].path, std::ios::app) << "\n";
  EXPECT_NE(loaded.hash(), hash);
}

}  // namespace
}  // namespace stridor
