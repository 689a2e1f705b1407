#include "models/initial_motion.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <vector>

#include "core/errors.hpp"
#include "substructures/bodies/beam.hpp"
#include "tests/support/full_model.hpp"
#include "tests/support/message_of.hpp"
#include "tests/support/paper_model.hpp"
#include "tests/support/spring_chain.hpp"

namespace stridor {
namespace {

using namespace test;

using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::SizeIs;

constexpr const char* impossible =
    "the body cannot take this motion: a support holds it, or values contradict";

/// The chain of n masses, row i the mass i, row n held.
ModalBody modal_chain(const Eigen::MatrixXd& stiffness) {
  const Eigen::Index n = stiffness.rows();
  ReducedBody body;
  body.mass = Eigen::MatrixXd::Identity(n, n);
  body.stiffness = stiffness;
  body.rows = Eigen::MatrixXd::Zero(n + 1, n);
  body.rows.topRows(n).setIdentity();
  return make_modal(body);
}

Eigen::VectorXd shape_of(const ModalBody& body, const std::vector<PrescribedRow>& prescribed) {
  return static_shape(body, prescribed);
}

TEST(StaticShape, OfOnePointIsItsComplianceScaled) {
  constexpr int n = 7;
  const ModalBody body = modal_chain(chain_stiffness(n));
  for (int k = 0; k < n; ++k) {
    const Eigen::VectorXd shape = shape_of(body, {{k, 0.3}});
    // The condition number of the chain is 25; rounding of a 7 x 7 eigenproblem on top.
    for (int i = 0; i < n; ++i) {
      EXPECT_NEAR(shape(i), 0.3 * chain_compliance(n, i, k) / chain_compliance(n, k, k), 1e-14);
    }
  }
}

TEST(StaticShape, ThroughSeveralPointsNeedsForcesThereOnly) {
  constexpr int n = 9;
  const Eigen::MatrixXd stiffness = chain_stiffness(n);
  const Eigen::VectorXd shape = shape_of(modal_chain(stiffness), {{1, 0.2}, {4, -0.5}, {7, 0.1}});
  EXPECT_NEAR(shape(1), 0.2, 1e-14);
  EXPECT_NEAR(shape(4), -0.5, 1e-14);
  EXPECT_NEAR(shape(7), 0.1, 1e-14);
  const Eigen::VectorXd forces = stiffness * shape;
  for (const int i : {0, 2, 3, 5, 6, 8}) EXPECT_NEAR(forces(i), 0.0, 1e-13) << i;
}

TEST(StaticShape, AFreeBodyIsCarriedAlongWithoutStrain) {
  Eigen::MatrixXd stiffness = chain_stiffness(4);
  stiffness(0, 0) = stiffness(3, 3) = 1.0;  // no springs to ground
  const ModalBody body = modal_chain(stiffness);
  const Eigen::VectorXd one = shape_of(body, {{2, 0.3}});
  for (int i = 0; i < 4; ++i) EXPECT_NEAR(one(i), 0.3, 1e-14);
  // Two points: straight between them, unstrained outside.
  const Eigen::VectorXd two = shape_of(body, {{0, 0.0}, {2, 0.3}});
  const double expected[] = {0.0, 0.15, 0.3, 0.3};
  for (int i = 0; i < 4; ++i) EXPECT_NEAR(two(i), expected[i], 1e-14);
}

TEST(StaticShape, ABodyWithRigidMotionsOnlyIsMovedAsOne) {
  const ModalBody body = modal_chain(Eigen::MatrixXd::Zero(2, 2));
  const Eigen::VectorXd shape = shape_of(body, {{1, 0.3}});
  EXPECT_NEAR(shape(1), 0.3, 1e-15);
  EXPECT_NEAR(shape(0), 0.0, 1e-15);  // the smallest of all
}

TEST(StaticShape, TheUnitOfStiffnessDoesNotMatter) {
  const Eigen::VectorXd reference = shape_of(modal_chain(chain_stiffness(5)), {{1, 0.2}, {3, 0.4}});
  for (const double scale : {1e-9, 1e9}) {
    Eigen::MatrixXd stiffness = chain_stiffness(5);
    stiffness *= scale;
    const Eigen::VectorXd shape = shape_of(modal_chain(stiffness), {{1, 0.2}, {3, 0.4}});
    EXPECT_LT((shape - reference).cwiseAbs().maxCoeff(), 1e-14) << scale;
  }
}

TEST(StaticShape, WhatASupportHoldsIsRefused) {
  const ModalBody body = modal_chain(chain_stiffness(3));
  EXPECT_EQ(message_of<NumericalError>([&] { shape_of(body, {{3, 0.1}}); }), impossible);
  EXPECT_EQ(message_of<NumericalError>([&] { shape_of(body, {{0, 0.1}, {3, 0.1}}); }), impossible);
}

TEST(StaticShape, ContradictionsAreRefusedRepetitionsAreNot) {
  const ModalBody body = modal_chain(chain_stiffness(3));
  EXPECT_EQ(message_of<NumericalError>([&] { shape_of(body, {{1, 0.1}, {1, 0.2}}); }), impossible);
  EXPECT_NEAR(shape_of(body, {{1, 0.1}, {1, 0.1}})(1), 0.1, 1e-15);
}

// ---- as scenes ask for them

constexpr std::size_t cantilever = 0;
constexpr std::size_t oblique = 1;

/// The paper's beams with coarse meshes.
ModelParameters coarse_model() {
  ModelParameters parameters = paper_model();
  auto& lower = parameters.substructures["cantilever"].get<BeamParameters>();
  lower.mesh.along = 10;
  lower.interface.spacing = 0.005;
  lower.reduction = {4};
  auto& upper = parameters.substructures["oblique"].get<BeamParameters>();
  upper.mesh.along = 8;
  upper.reduction = {4};
  return parameters;
}

Model model_with(const std::vector<InitialMotionParameters<MotionKind::displacement>>& displacement,
                 const std::vector<InitialMotionParameters<MotionKind::velocity>>& velocity) {
  ModelParameters parameters = coarse_model();
  parameters.initial.displacement = displacement;
  parameters.initial.velocity = velocity;
  return make_model(parameters, {{free_end, "k"}, {{"oblique", "end_top"}, "k"}});
}

/// Displacement or velocity of a point, from that of the body in reduced coordinates.
Eigen::Vector2d at(const SystemBody& body, const PointRows& rows, const Eigen::VectorXd& motion) {
  return {body.reduced.rows.row(rows.x).dot(motion), body.reduced.rows.row(rows.y).dot(motion)};
}

TEST(InitialMotion, APointStandsWhereItIsPutInEveryForm) {
  const Model model = model_with({{"cantilever.free_end", 0.0, -1e-3}}, {});
  const PointRows rows = model.points.at(free_end).rows;
  EXPECT_THAT(model.system.bodies[oblique].initial_displacement, SizeIs(0));
  EXPECT_THAT(model.system.bodies[cantilever].initial_velocity, SizeIs(0));
  // Relative 1e-10: the reduced stiffness has a condition number of 1e8 or so.
  EXPECT_NEAR(at(model.system.bodies[cantilever], rows,
                 model.system.bodies[cantilever].initial_displacement)
                  .y(),
              -1e-3, 1e-13);
  for (const Coordinates form :
       {Coordinates::modal, Coordinates::craig_bampton, Coordinates::craig_bampton_fused}) {
    System system = model.system;
    system.contacts.clear();
    const Simulation simulation(system, paper_time(2e-7, form));
    EXPECT_NEAR(simulation.displacement(cantilever, rows.y), -1e-3, 1e-13);
    EXPECT_EQ(simulation.displacement(oblique, 0), 0.0);
  }
}

TEST(InitialMotion, TheShapeOfADeflectedCantileverIsThatOfATipForce) {
  // Of a slender beam: w(x)/w(L) = (3 (x/L)² − (x/L)³)/2, shear and Poisson effects of less
  // than a hundredth aside.
  ModelParameters parameters = paper_model();
  parameters.initial.displacement = {{"cantilever.free_end", 0.0, -1e-3}};
  const Model model = make_paper_model(parameters);
  const SystemBody& body = model.system.bodies[cantilever];
  const MasterSurface& surface = model.system.surfaces[0];
  for (const std::size_t k : {20u, 50u, 80u}) {
    const double x = static_cast<double>(k) / 100.0;
    const double expected = -1e-3 * (3.0 * x * x - x * x * x) / 2.0;
    EXPECT_NEAR(at(body, surface.rows[k], body.initial_displacement).y(), expected,
                1e-2 * std::abs(expected));
  }
}

TEST(InitialMotion, AWholeBodyMovesUniformly) {
  // The oblique beam is guided: free in y. Its interface carries all of it along.
  const Model model = model_with({{"oblique", 0.0, 2e-4}}, {{"oblique", 0.0, -0.1}});
  const SystemBody& body = model.system.bodies[oblique];
  const PointRows end = model.points.at({"oblique", "end_top"}).rows;
  const PointRows tip = model.system.contacts[0].slave_rows;
  for (const PointRows& rows : {end, tip}) {
    EXPECT_NEAR(at(body, rows, body.initial_displacement).x(), 0.0, 1e-15);
    EXPECT_NEAR(at(body, rows, body.initial_displacement).y(), 2e-4, 1e-15);
    EXPECT_NEAR(at(body, rows, body.initial_velocity).y(), -0.1, 1e-12);
  }
  // Uniform everywhere: the momentum is that of the whole mass, ρ L t w.
  const double mass = 2770.0 * 0.075 * 0.0015 * 0.010;
  const Eigen::VectorXd& v = body.initial_velocity;
  EXPECT_NEAR(v.dot(body.reduced.mass * v), mass * 0.01, 1e-9 * mass);
  // And it strains nothing.
  EXPECT_LT((body.reduced.stiffness * v).norm(), 1e-9 * body.reduced.stiffness.norm() * v.norm());
}

TEST(InitialMotion, VelocitiesAreThoseOfTheSimulationAtItsStart) {
  const Model model = model_with({}, {{"oblique", 0.0, -0.1}, {"cantilever.free_end", 0.0, 0.2}});
  System system = model.system;
  system.contacts.clear();
  const PointRows end = model.points.at(free_end).rows;
  for (const Coordinates form :
       {Coordinates::modal, Coordinates::craig_bampton, Coordinates::craig_bampton_fused}) {
    const Simulation simulation(system, paper_time(2e-7, form));
    const Propagator::Motion motion = simulation.motion(cantilever);
    const Eigen::MatrixXd& rows = form == Coordinates::modal
                                      ? system.bodies[cantilever].modal.rows
                                      : system.bodies[cantilever].reduced.rows;
    // The increment of a step, 4e-8 m, is known to 1e-16 of it or of the displacement (zero).
    EXPECT_NEAR(rows.row(end.y).dot(motion.velocity), 0.2, 1e-9);
    EXPECT_EQ(simulation.displacement(cantilever, end.y), 0.0);
  }
}

TEST(InitialMotion, PointsOfABodyAreMetTogetherAndOnlyInTheComponentsGiven) {
  const Model model =
      model_with({{"cantilever.free_end", 0.0, -1e-3}, {"cantilever.end_bottom", 1e-5, 0.0}}, {});
  const SystemBody& body = model.system.bodies[cantilever];
  const PointRows top = model.points.at(free_end).rows;
  const Eigen::Vector2d free = at(body, top, body.initial_displacement);
  EXPECT_NEAR(free.y(), -1e-3, 1e-13);
  EXPECT_GT(std::abs(free.x()), 1e-6);  // the end turns as it likes
}

TEST(InitialMotion, AWholeBodyAndAPointOfItAdd) {
  const Model model = model_with({{"oblique", 0.0, 2e-4}, {"oblique.tip", 0.0, 1e-4}}, {});
  const SystemBody& body = model.system.bodies[oblique];
  EXPECT_NEAR(at(body, model.system.contacts[0].slave_rows, body.initial_displacement).y(), 3e-4,
              1e-13);
}

/// The complaint about initial.velocity.0.at, with the same for a displacement.
std::string refusal(const std::string& body_or_point, double x, double y) {
  const std::string message = message_of<ConfigError>([&] {
    model_with({}, {{body_or_point, x, y}});
  });
  const std::string other = message_of<ConfigError>([&] {
    model_with({{body_or_point, x, y}}, {});
  });
  const std::string key = "initial.velocity.0.at: ";
  EXPECT_THAT(message, ::testing::StartsWith(key));
  EXPECT_EQ(other, "initial.displacement.0.at: " + message.substr(key.size()));
  return message.substr(key.size());
}

TEST(InitialMotion, BodiesAndPointsThatDoNotExistAreNamedWithSuggestions) {
  EXPECT_EQ(refusal("obliq", 0.0, 0.1),
            "there is no substructure 'obliq', did you mean 'oblique'? (there are: cantilever, "
            "oblique)");
  EXPECT_THAT(refusal("obliq.tip", 0.0, 0.1), HasSubstr("there is no substructure 'obliq'"));
  EXPECT_THAT(refusal("oblique.tup", 0.0, 0.1),
              HasSubstr("'oblique' has no point 'tup', did you mean 'tip'?"));
  EXPECT_THAT(refusal("oblique.", 0.0, 0.1), HasSubstr("is not of the form <body>.<point"));
}

TEST(InitialMotion, SupportsThatHoldABodyRefuseItsTranslation) {
  const auto held = [](const std::string& body) {
    return "the supports of '" + body + "' do not let all of it move alike; name a point of it";
  };
  EXPECT_EQ(refusal("oblique", 0.1, 0.0), held("oblique"));
  EXPECT_EQ(refusal("oblique", 1e-9, 0.1), held("oblique"));
  EXPECT_EQ(refusal("cantilever", 0.1, 0.0), held("cantilever"));
  EXPECT_EQ(refusal("cantilever", 0.0, 0.1), held("cantilever"));
}

TEST(InitialMotion, ABodyWithoutContactsIsHeldByItsSupportsLikewise) {
  ModelParameters parameters = coarse_model();
  parameters.substructures["shelf"] = parameters.substructures["cantilever"];
  parameters.initial.velocity = {{"shelf", 0.0, 0.1}};
  EXPECT_EQ(
      message_of<ConfigError>([&] { make_model(parameters, {}); }),
      "initial.velocity.0.at: the supports of 'shelf' do not let all of it move alike; name a "
      "point of it");
}

TEST(InitialMotion, HeldPointsAndContradictionsAreRefused) {
  EXPECT_EQ(refusal("cantilever.start", 0.0, 0.1), impossible);
  EXPECT_EQ(refusal("oblique.end_top", 0.1, 0.0), impossible);  // guided in x
  // All nodes of a guided end share one vertical displacement.
  EXPECT_EQ(message_of<ConfigError>([] {
              model_with({{"oblique.end_top", 0.0, 1e-4}, {"oblique.end_bottom", 0.0, 2e-4}}, {});
            }),
            std::string("initial.displacement.1.at: ") + impossible);
}

template <MotionKind kind>
std::vector<Problem> problems_of(const InitialMotionParameters<kind>& motion) {
  std::vector<Problem> problems;
  for (const auto& check : InitialMotionParameters<kind>::schema().checks) check(&motion, problems);
  return problems;
}

TEST(InitialMotionParameters, AMotionOfNothingIsRefused) {
  const auto none = problems_of(InitialMotionParameters<MotionKind::velocity>{"oblique", 0.0, 0.0});
  ASSERT_THAT(none, SizeIs(1));
  EXPECT_EQ(none[0].text(), "at: moves nothing: give some of `x`, `y` and `z`");
  EXPECT_THAT(problems_of(InitialMotionParameters<MotionKind::displacement>{"oblique", 0.0, 0.0}),
              SizeIs(1));
  EXPECT_THAT(problems_of(InitialMotionParameters<MotionKind::velocity>{"oblique", 0.1, 0.0}),
              IsEmpty());
  EXPECT_THAT(problems_of(InitialMotionParameters<MotionKind::velocity>{"oblique", 0.0, -0.1}),
              IsEmpty());
}

std::vector<std::string> complaints(const InitialParameters& initial) {
  std::vector<Problem> problems;
  for (const auto& check : InitialParameters::schema().checks) check(&initial, problems);
  std::vector<std::string> lines;
  for (const Problem& problem : problems) lines.push_back(problem.text());
  return lines;
}

TEST(InitialParameters, TheStateIsRestEquilibriumOrARunFile) {
  InitialParameters initial;
  EXPECT_FALSE(initial.is_file());
  for (const char* state : {"rest", "equilibrium", "out/run.h5"}) {
    initial.state = state;
    EXPECT_THAT(complaints(initial), IsEmpty()) << state;
  }
  EXPECT_TRUE(initial.is_file());
  for (const char* state : {"restt", "run.hdf5", ".h5", ""}) {
    initial.state = state;
    EXPECT_THAT(complaints(initial),
                ::testing::ElementsAre(std::string("state: '") + state +
                                       "' is neither rest nor equilibrium nor a run file (*.h5)"));
  }
}

TEST(InitialParameters, APerturbationNeedsTheEquilibrium) {
  InitialParameters initial;
  initial.perturbation = PerturbationParameters{1, 1e-6};
  EXPECT_THAT(complaints(initial),
              ::testing::ElementsAre("perturbation: is added to the sliding equilibrium: needs "
                                     "state: equilibrium"));
  initial.state = InitialParameters::equilibrium;
  EXPECT_THAT(complaints(initial), IsEmpty());
}

}  // namespace
}  // namespace stridor
