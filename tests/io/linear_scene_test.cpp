#include "io/linear_scene.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <fstream>

#include "core/errors.hpp"
#include "io/scene.hpp"
#include "tests/support/message_of.hpp"
#include "tests/support/program.hpp"

namespace stridor {
namespace {

using test::message_of;
using test::scene_path;
using ::testing::HasSubstr;

const char* const small_scene = R"(format: 1
substructures:
  body:
    type: matrices
    mass: ["2 0", "0 1"]
    stiffness: K.mtx
    gyroscopic: ["0 3", "-3 0"]
    load: 0.5
    load_stiffness: ["0 2", "0 0"]
)";

/// The small scene in a folder of its own.
class MatrixFolder {
 public:
  MatrixFolder() {
    std::ofstream(path()) << small_scene;
    std::ofstream((folder_ / "K.mtx").string())
        << "%%MatrixMarket matrix array real symmetric\n2 2\n5\n1\n7\n";
  }
  std::string path() const { return (folder_ / "scene.yaml").string(); }
  LinearModel model(const std::vector<std::string>& sets) const {
    return load_linear_scene(path(), sets).model();
  }
  std::string failure(const std::vector<std::string>& sets) const {
    return message_of<ConfigError>([&] { model(sets); });
  }

 private:
  test::TemporaryFolder folder_;
};

TEST(MatrixScene, AddsItsMatricesUp) {
  const MatrixFolder folder;
  const LinearSystem found = folder.model({}).dense;
  EXPECT_EQ(found.mass, (Eigen::MatrixXd{{2.0, 0.0}, {0.0, 1.0}}));
  EXPECT_EQ(found.velocity, (Eigen::MatrixXd{{0.0, 3.0}, {-3.0, 0.0}}));
  EXPECT_EQ(found.position, (Eigen::MatrixXd{{5.0, 2.0}, {1.0, 7.0}}));
  EXPECT_TRUE(std::isinf(folder.model({}).highest_frequency));
}

TEST(MatrixScene, RowsAreListsOrTexts) {
  const MatrixFolder folder;
  const std::string body = "substructures.body.";
  const LinearSystem found =
      folder.model({body + "mass=[[4, 1], [1, 2.5e0]]", body + "gyroscopic=[[0, 3], '-3 0']"})
          .dense;
  EXPECT_EQ(found.mass, (Eigen::MatrixXd{{4.0, 1.0}, {1.0, 2.5}}));
  EXPECT_EQ(found.velocity, (Eigen::MatrixXd{{0.0, 3.0}, {-3.0, 0.0}}));
  EXPECT_THAT(folder.failure({body + "mass=[[1, 0], [0]]"}),
              HasSubstr("mass: row 2 has 1 numbers, expected 2"));
  EXPECT_THAT(folder.failure({body + "mass=[[1, x], [0, 1]]"}),
              HasSubstr("mass.0.1: 'x' is not a number"));
}

TEST(MatrixScene, LargeMatricesStaySparse) {
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
  std::ofstream(path) << "format: 1\nsubstructures:\n  chain: {type: matrices, mass: M.mtx, "
                         "stiffness: K.mtx}\n";
  const LinearModel model = load_linear_scene(path, {}).model();
  ASSERT_TRUE(model.sparse.has_value());
  EXPECT_EQ(model.sparse->size(), n);
  EXPECT_EQ(model.sparse->position.nonZeros(), 3 * n - 2);
}

TEST(MatrixScene, SaysWhichMatrixIsWrong) {
  const MatrixFolder folder;
  const std::string body = "substructures.body.";
  EXPECT_THAT(folder.failure({body + "mass=[1 0, 0 -1]"}),
              HasSubstr("mass: must be positive definite"));
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
  EXPECT_THAT(folder.failure({"substructures.other={type: matrices, mass: ['1'], "
                              "stiffness: ['1']}"}),
              HasSubstr("stands alone"));
}

TEST(DiscScene, ReadsTheReferenceBrake) {
  const LoadedLinearScene loaded = load_linear_scene(scene_path("disc_and_pads.yaml"), {});
  const LinearModel model = loaded.model();
  EXPECT_EQ(model.dense.size(), 19);
  EXPECT_EQ(model.dense.gaps.rows(), 2);
  EXPECT_NEAR(model.highest_frequency, 7494.83, 0.01);
  // A resolved scene reads back as the same.
  const LoadedLinearScene again = load_resolved_linear_scene(loaded.resolved(), "resolved");
  EXPECT_EQ(again.model().dense.position, model.dense.position);
}

TEST(DiscScene, SaysWhatDoesNotFit) {
  const auto failure = [](const std::vector<std::string>& sets) {
    return message_of<ConfigError>(
        [&] { load_linear_scene(scene_path("disc_and_pads.yaml"), sets); });
  };
  EXPECT_THAT(failure({"terms=[gyro]"}),
              HasSubstr("there is no term 'gyro', did you mean 'gyroscopic'?"));
  EXPECT_THAT(failure({"disc.speed=0"}),
              HasSubstr("disc.speed: must be positive with the term friction_damping"));
  EXPECT_THAT(failure({"pads.radius=0.2"}), HasSubstr("pads.radius: must lie between"));
  EXPECT_THAT(failure({"disc.outer_radius=0.05"}),
              HasSubstr("disc.outer_radius: must be larger than inner_radius"));
  EXPECT_THAT(failure({"disc.radial_modes=9"}),
              HasSubstr("disc.radial_modes: must not exceed radial_terms = 8"));
  EXPECT_THAT(failure({"pads.stiffness.coupling=1e8"}),
              HasSubstr("must be smaller than the geometric mean"));
  EXPECT_THAT(message_of<ConfigError>([] { load_scene(scene_path("disc_and_pads.yaml"), {}); }),
              HasSubstr("disc: belongs to a scene of small motion"));
}

}  // namespace
}  // namespace stridor
