// Bodies given by their matrices, in contact.
#include "substructures/bodies/matrix_body.hpp"
#include "substructures/bodies/whole_body.hpp"
#include "substructures/reduction/modal_body.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <Eigen/Dense>

#include "core/errors.hpp"
#include "models/model.hpp"
#include "substructures/bodies/beam.hpp"
#include "tests/support/message_of.hpp"
#include "tests/support/paper_model.hpp"

namespace stridor {
namespace {

using namespace test;
using ::testing::HasSubstr;

SparseMatrix sparse(const Eigen::MatrixXd& dense) {
  return dense.sparseView();
}

/// Three unknowns; two points of which the first has x and y, the second y alone.
TouchedMatrixBodyParameters small_body() {
  NamedMatrices matrices;
  matrices.mass = sparse(Eigen::Vector3d(2.0, 3.0, 4.0).asDiagonal());
  matrices.damping = sparse(Eigen::Matrix3d{{1, 0, 0}, {0, 0, 0}, {0, 0, 0}});
  matrices.gyroscopic = sparse(Eigen::Matrix3d{{0, 3, 0}, {-3, 0, 0}, {0, 0, 0}});
  matrices.stiffness = sparse(Eigen::Matrix3d{{50, 4, 0}, {0, 60, 0}, {0, 0, 70}});
  matrices.circulatory = SparseMatrix(3, 3);
  matrices.terms = {sparse(Eigen::Matrix3d{{0, 1, 0}, {-1, 0, 0}, {0, 0, 0}}),
                    sparse(Eigen::Matrix3d{{0, 0, 1}, {0, 0, 0}, {-1, 0, 0}})};
  TouchedMatrixBodyParameters body;
  body.matrices = std::make_shared<const NamedMatrices>(matrices);
  body.body.terms = {{MatrixRole::gyroscopic, {}, 2.0}, {MatrixRole::circulatory, {}, 2.0}};
  body.points["left"] = {{0.0, 0.0}, 1, 2};
  body.points["right"] = {{0.1, 0.02}, 0, 3};
  body.surfaces["top"].points = {"left", "right"};
  return body;
}

TEST(MatrixBody, KeepsTheSymmetricStiffnessApartFromWhatCouples) {
  const BodyMatrices body = make_matrix_body(small_body());
  EXPECT_EQ(Eigen::MatrixXd(body.stiffness), (Eigen::MatrixXd{{50, 2, 0}, {2, 60, 0}, {0, 0, 70}}));
  EXPECT_EQ(Eigen::MatrixXd(body.circulatory),
            (Eigen::MatrixXd{{0, 2, 2}, {-2, 0, 0}, {-2, 0, 0}}));
  EXPECT_EQ(Eigen::MatrixXd(body.velocity), (Eigen::MatrixXd{{1, 5, 0}, {-5, 0, 0}, {0, 0, 0}}));
  EXPECT_EQ(body.nodes, (Eigen::MatrixXd{{0.0, 0.0, 0.0}, {0.1, 0.02, 0.0}}));
  EXPECT_EQ(body.node_dofs[0], (std::array{0, 1}));
  EXPECT_EQ(body.node_dofs[1], (std::array{BodyMatrices::held, 2}));
  EXPECT_EQ(body.surfaces.at("top"), (std::vector{0, 1}));
  EXPECT_FALSE(body.follows_drive());
}

TEST(MatrixBody, StructuralTermsGiveEveryModeHalfTheirLossFactorOfCriticalDamping) {
  constexpr double loss = 0.02;
  TouchedMatrixBodyParameters given = small_body();
  NamedMatrices matrices = *given.matrices;
  matrices.damping = matrices.gyroscopic = matrices.circulatory = SparseMatrix(3, 3);
  matrices.stiffness = sparse(Eigen::Matrix3d{{50, 4, 0}, {4, 60, -7}, {0, -7, 70}});
  matrices.terms = {matrices.stiffness};
  given.matrices = std::make_shared<const NamedMatrices>(matrices);
  given.body.terms = {{MatrixRole::structural, {}, loss}};
  const BodyMatrices body = make_matrix_body(given);
  EXPECT_LT((body.loss_stiffness - loss * body.stiffness).norm(), 1e-14);
  EXPECT_EQ(body.velocity.size(), 0);
  const std::vector<int> all{0, 1, 2};
  const ModalBody modal = make_modal(make_whole(body, all));
  // With a uniform loss factor the damping between modes is diagonal, η ω.
  Eigen::MatrixXd expected = (loss * modal.omega).asDiagonal();
  EXPECT_LT((modal.coupled.velocity - expected).norm(), 1e-12 * expected.norm());
}

TEST(MatrixBody, FollowsTheDriveWithTheInertiaOfItsTranslation) {
  TouchedMatrixBodyParameters given = small_body();
  given.guided = {2, {1.0, 0.0, 0.5}};
  const BodyMatrices body = make_matrix_body(given);
  EXPECT_EQ(body.load_dof, 1);
  EXPECT_EQ(body.base_inertia, Eigen::Vector3d(2.0, 0.0, 2.0));
}

TEST(MatrixBody, HasNoCoupledTermsWhereNothingCouples) {
  TouchedMatrixBodyParameters given = small_body();
  for (MatrixTermParameters& term : given.body.terms) term.factor = 0.0;
  NamedMatrices matrices = *given.matrices;
  matrices.damping = matrices.gyroscopic = SparseMatrix(3, 3);
  matrices.stiffness = matrices.mass;
  given.matrices = std::make_shared<const NamedMatrices>(matrices);
  EXPECT_EQ(make_matrix_body(given).velocity.size(), 0);
}

TEST(MatrixBody, RefusesWhatIsNotThere) {
  const auto refused = [](const auto& change) {
    TouchedMatrixBodyParameters body = small_body();
    change(body);
    return message_of<ConfigError>([&] { make_matrix_body(body); });
  };
  EXPECT_THAT(refused([](auto& body) { body.points["right"].y = 4; }),
              HasSubstr("points.right.y: there is no unknown 4: the matrices have 3"));
  EXPECT_THAT(refused([](auto& body) { body.surfaces["top"].points[1] = "rigth"; }),
              HasSubstr("surfaces.top.points: there is no point 'rigth', did you mean 'right'?"));
  EXPECT_THAT(refused([](auto& body) {
                body.surfaces["top"].points = {"left", "left"};
              }),
              HasSubstr("'left' stands where the point before it does"));
  EXPECT_THAT(refused([](auto& body) {
                body.surfaces["left"].points = {"left", "right"};
              }),
              HasSubstr("surfaces.left: a point has this name already"));
  EXPECT_THAT(refused([](auto& body) {
                body.guided = {4, {1, 0, 0}};
              }),
              HasSubstr("guided.load: there is no unknown 4"));
  EXPECT_THAT(refused([](auto& body) {
                body.guided = {1, {1, 0}};
              }),
              HasSubstr("guided.translation: has 2 numbers, expected one for each of the 3"));
}

/// The main scene with the cantilever given by the matrices of its mesh, all of whose surface nodes
/// are points.
ModelParameters paper_model_by_matrices(int num_elements = 50) {
  ModelParameters parameters = paper_model();
  auto beam = parameters.substructures["cantilever"].get<BeamParameters>();
  beam.mesh.along = num_elements;
  const BodyMatrices mesh = make_beam(beam);
  NamedMatrices matrices;
  matrices.mass = mesh.mass;
  matrices.stiffness = mesh.stiffness;
  matrices.damping = beam.damping.alpha * mesh.mass + beam.damping.beta * mesh.stiffness;
  const Eigen::Index n = mesh.num_dofs();
  matrices.gyroscopic = matrices.circulatory = SparseMatrix(n, n);
  TouchedMatrixBodyParameters body;
  body.matrices = std::make_shared<const NamedMatrices>(matrices);
  body.reduction.emplace().fixed_interface_modes = beam.reduction.fixed_interface_modes;
  for (const int node : mesh.surfaces.at("top")) {
    const auto dofs = mesh.node_dofs[static_cast<std::size_t>(node)];
    const std::string name = "n" + std::to_string(node);
    body.points[name] = {{mesh.nodes(node, 0), mesh.nodes(node, 1)}, dofs[0] + 1, dofs[1] + 1};
    body.surfaces["top"].points.push_back(name);
  }
  parameters.substructures["cantilever"] = body;
  return parameters;
}

TEST(MatrixBody, OfAMeshIsTheBeamOfThatMesh) {
  ModelParameters beams = paper_model();
  beams.substructures["cantilever"].get<BeamParameters>().interface.spacing.reset();
  const Model expected = make_model(beams, {});
  const Model found = make_model(paper_model_by_matrices(), {});
  const ModalBody& beam = expected.system.bodies[0].modal;
  const ModalBody& body = found.system.bodies[0].modal;
  ASSERT_EQ(body.size(), beam.size());
  EXPECT_TRUE(body.omega.isApprox(beam.omega, 1e-12));
  // Its damping is proportional, and found to be.
  EXPECT_TRUE(body.coupled.is_empty());
  EXPECT_NEAR(body.damping.alpha, beam.damping.alpha, 1e-6 * beam.damping.alpha);
  EXPECT_NEAR(body.damping.beta, beam.damping.beta, 1e-12 * beam.damping.beta);
  EXPECT_EQ(found.system.surfaces[0].arc_length, expected.system.surfaces[0].arc_length);
}

TEST(MatrixBody, KeepsEveryUnknownWhereNoReductionIsGiven) {
  ModelParameters parameters = paper_model();
  TouchedMatrixBodyParameters body = small_body();
  body.guided = {2, {1.0, 0.0, 0.5}};
  body.points["right"].at = {0.1, 0.0};
  parameters.substructures["cantilever"] = body;
  const Model model = make_model(parameters, {});
  const ReducedBody& reduced = model.system.bodies[0].reduced;
  EXPECT_EQ(reduced.size(), 3);
  EXPECT_EQ(reduced.num_interface, 3);
  EXPECT_TRUE(model.system.bodies[0].follows_drive());
  // The unknowns of the points on the surface come first, as they are: 1, 2 and 3.
  EXPECT_EQ(reduced.mass, Eigen::MatrixXd(body.matrices->mass));
  EXPECT_EQ(reduced.base_inertia, Eigen::Vector3d(2.0, 0.0, 2.0));
  EXPECT_EQ(reduced.coupled.velocity, (Eigen::MatrixXd{{1, 5, 0}, {-5, 0, 0}, {0, 0, 0}}));
  EXPECT_EQ(reduced.coupled.position, (Eigen::MatrixXd{{0, 2, 2}, {-2, 0, 0}, {-2, 0, 0}}));
}

TEST(MatrixBody, RefusesToBeReducedAsItCannotBe) {
  ModelParameters parameters = paper_model_by_matrices(220);
  auto& body = parameters.substructures["cantilever"].get<TouchedMatrixBodyParameters>();
  body.reduction.reset();
  EXPECT_THAT(message_of<ConfigError>([&] { make_model(parameters, {}); }),
              HasSubstr("substructures.cantilever.reduction: missing"));

  // Free in y, with circulatory terms.
  parameters = paper_model();
  TouchedMatrixBodyParameters free = small_body();
  NamedMatrices matrices = *free.matrices;
  matrices.stiffness = sparse(Eigen::Matrix3d{{50, 0, 0}, {0, 0, 0}, {0, 0, 70}});
  free.matrices = std::make_shared<const NamedMatrices>(matrices);
  parameters.substructures["cantilever"] = free;
  EXPECT_THAT(message_of<ConfigError>([&] { make_model(parameters, {}); }),
              HasSubstr("substructures.cantilever.circulatory: goes with a stiffness that resists "
                        "every motion"));
}

}  // namespace
}  // namespace stridor
