#include "models/body_cache.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "models/mode_shape.hpp"
#include "substructures/bodies/beam.hpp"
#include "tests/support/message_of.hpp"
#include "tests/support/paper_model.hpp"

namespace stridor {
namespace {

using namespace test;
using ::testing::HasSubstr;

Model cached_model(const ModelParameters& parameters, BodyCache& cache) {
  return make_model(parameters, {{free_end, "record.channels.0"}}, cache);
}

/// The paper's beams on coarser meshes: what is tested does not depend on it.
ModelParameters small_model() {
  ModelParameters parameters = paper_model();
  auto& oblique = parameters.substructures["oblique"].get<BeamParameters>();
  auto& cantilever = parameters.substructures["cantilever"].get<BeamParameters>();
  oblique.mesh.along = 6;
  cantilever.mesh.along = 10;
  cantilever.interface.spacing = 0.005;
  oblique.reduction.fixed_interface_modes = 4;
  cantilever.reduction.fixed_interface_modes = 4;
  return parameters;
}

void expect_same(const Model& a, const Model& b) {
  ASSERT_EQ(a.system.bodies.size(), b.system.bodies.size());
  for (std::size_t i = 0; i < a.system.bodies.size(); ++i) {
    EXPECT_EQ(a.system.bodies[i].reduced.mass, b.system.bodies[i].reduced.mass);
    EXPECT_EQ(a.system.bodies[i].modal.omega, b.system.bodies[i].modal.omega);
    EXPECT_EQ(a.system.bodies[i].modal.rows, b.system.bodies[i].modal.rows);
    EXPECT_EQ(a.system.bodies[i].modal.damping.alpha, b.system.bodies[i].modal.damping.alpha);
  }
}

TEST(BodyCache, GivesTheModelThatIsMadeWithoutIt) {
  BodyCache cache;
  const ModelParameters parameters = small_model();
  cached_model(parameters, cache);
  expect_same(cached_model(parameters, cache), make_paper_model(parameters));
  EXPECT_EQ(cache.num_reductions(), 2);
}

TEST(BodyCache, ReducesOnlyWhatAKeyChanges) {
  BodyCache cache;
  ModelParameters parameters = small_model();
  cached_model(parameters, cache);
  parameters.contact->start = 0.05;
  parameters.contact->friction->numbers["coefficient"] = 0.1;
  parameters.drive->load = TimeCurve(-1.0);
  cached_model(parameters, cache);
  EXPECT_EQ(cache.num_reductions(), 2);
  auto& oblique = parameters.substructures["oblique"].get<BeamParameters>();
  oblique.thickness = 0.0016;
  expect_same(cached_model(parameters, cache), make_paper_model(parameters));
  EXPECT_EQ(cache.num_reductions(), 3);
  oblique.reduction.fixed_interface_modes = 5;
  cached_model(parameters, cache);
  EXPECT_EQ(cache.num_reductions(), 4);
}

TEST(BodyCache, DampingNeedsNoReductionButTakesEffect) {
  BodyCache cache;
  ModelParameters parameters = small_model();
  cached_model(parameters, cache);
  auto& cantilever = parameters.substructures["cantilever"].get<BeamParameters>();
  cantilever.damping.alpha = 7.0;
  cantilever.damping.beta = 1e-7;
  const Model model = cached_model(parameters, cache);
  EXPECT_EQ(cache.num_reductions(), 2);
  EXPECT_EQ(model.system.bodies[0].modal.damping.alpha, 7.0);
  EXPECT_EQ(model.system.bodies[0].reduced.damping.beta, 1e-7);
  expect_same(model, make_paper_model(parameters));
}

TEST(BodyCache, ForgetsWhatWasNotUsedForLongest) {
  BodyCache cache(2);
  ModelParameters parameters = small_model();
  cached_model(parameters, cache);
  auto& oblique = parameters.substructures["oblique"].get<BeamParameters>();
  oblique.thickness = 0.0016;
  cached_model(parameters, cache);  // the first oblique beam goes, the cantilever stays
  EXPECT_EQ(cache.num_reductions(), 3);
  cached_model(parameters, cache);
  EXPECT_EQ(cache.num_reductions(), 3);
  oblique.thickness = 0.0015;
  cached_model(parameters, cache);
  EXPECT_EQ(cache.num_reductions(), 4);
}

TEST(BodyCache, CapacityMustBePositive) {
  EXPECT_THAT(message_of<std::invalid_argument>([] { BodyCache cache(0); }),
              HasSubstr("BodyCache: the capacity is 0"));
}

TEST(ModeShape, AgreesWithTheRowsOfWatchedPoints) {
  const ModelParameters parameters = small_model();
  BodyCache cache;
  const Model model = cached_model(parameters, cache);
  Eigen::Index size = 0;
  for (const SystemBody& body : model.system.bodies) size += body.modal.size();
  const Eigen::VectorXcd mode = Eigen::VectorXcd::Random(size);
  Equilibrium equilibrium;
  equilibrium.state.geometry = ContactGeometry::undeformed;
  equilibrium.state.drive_displacement = 0.02;
  const auto shapes = mode_shape(model, equilibrium, mode, cache);
  ASSERT_EQ(shapes.size(), 2u);
  EXPECT_EQ(shapes[0].name, "cantilever");

  const SystemBody& cantilever = model.system.bodies[0];
  const BodyMatrices matrices = cache.matrices(*parameters.substructures.at("cantilever"));
  const int node = matrices.points.at("free_end");
  const Model::Point point = model.points.at(free_end);
  const std::complex<double> expected =
      cantilever.modal.rows.row(point.rows.y) * mode.head(cantilever.modal.size());
  EXPECT_NEAR(std::abs(shapes[0].displacement(node, 1) - expected), 0.0,
              1e-12 * std::abs(expected));
  // The clamp holds; the tip is at the start of the contact, moved by the drive.
  EXPECT_EQ(shapes[0].displacement.row(matrices.points.at("start")).norm(), 0.0);
  const BodyMatrices oblique = cache.matrices(*parameters.substructures.at("oblique"));
  EXPECT_NEAR(shapes[1].nodes(oblique.points.at("tip"), 0), 0.030 + 0.02, 1e-12);
}

TEST(ModeShape, LengthMustFitTheBodies) {
  const ModelParameters parameters = small_model();
  BodyCache cache;
  const Model model = cached_model(parameters, cache);
  EXPECT_THAT(message_of<std::invalid_argument>(
                  [&] { mode_shape(model, {}, Eigen::VectorXcd::Ones(3), cache); }),
              HasSubstr("mode_shape: the mode has 3 entries"));
}

}  // namespace
}  // namespace stridor
