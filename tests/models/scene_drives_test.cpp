// What the drives of a scene move, load and displace.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <functional>
#include <map>
#include <string>
#include <utility>

#include "models/model.hpp"
#include "solvers/equilibrium/equilibrium.hpp"
#include "solvers/transient/simulation.hpp"
#include "substructures/bodies/beam.hpp"
#include "substructures/bodies/lumped_body.hpp"
#include "tests/support/message_of.hpp"
#include "tests/support/paper_model.hpp"

namespace stridor {
namespace {

using test::message_of;
using ::testing::HasSubstr;

/// A bar on a spring spread over its upper side, which holds it in all directions, with all of its
/// modes: without contacts it has no interface that would make statics exact.
BeamParameters sprung_bar() {
  BeamParameters bar;
  bar.length = 0.06;
  bar.thickness = 0.015;
  bar.width = 0.04;
  bar.material = {10e9, 0.3, 2500.0};
  bar.mesh.along = 4;
  bar.mesh.through = 1;
  bar.reduction.fixed_interface_modes = 46;
  SurfaceSpringParameters spring;
  spring.on = "top";
  spring.stiffness.xx = 4e7;
  spring.stiffness.yy = 1e8;
  bar.springs["backing"] = spring;
  return bar;
}

ModelParameters bar_under(const DriveParameters& piston) {
  ModelParameters model;
  model.substructures["bar"] = sprung_bar();
  model.drives["piston"] = piston;
  return model;
}

Model model_of_bar(const DriveParameters& piston) {
  return make_model(bar_under(piston), {{{"bar", "start_bottom"}, "record.channels.0"},
                                        {{"bar", "end_bottom"}, "record.channels.1"}});
}

DriveParameters pushing(double force, const char* on) {
  DriveParameters drive;
  drive.load = TimeCurve(force);
  drive.load_on = {on};
  return drive;
}

DriveParameters lifting(double displacement, const char* spring) {
  DriveParameters drive;
  drive.displacement = TimeCurve(displacement);
  drive.displaces = {spring};
  return drive;
}

/// Displacement in y of a point in equilibrium.
double settled(const Model& model, const char* point) {
  const Equilibrium rest = find_equilibrium(model.system, sliding_state(model.system, 0.0));
  EXPECT_EQ(rest.status, EquilibriumStatus::converged) << rest.failure;
  const Model::Point& at = model.points.at({"bar", point});
  return model.system.bodies[0].modal.rows.row(at.rows.y) * rest.displacement[0];
}

TEST(SceneDrives, ALoadOnASurfaceIsTheWholeForceOnIt) {
  const Model model = model_of_bar(pushing(-3000.0, "bar.top"));
  const SystemBody& body = model.system.bodies[0];
  ASSERT_EQ(body.loads.size(), 1);
  // All forces act where the spring is, which gives way by F/k on average; the load is spread as the
  // spring is, so that the bar sinks as a whole.
  EXPECT_NEAR(settled(model, "start_bottom"), -3e-5, 1e-11);
  EXPECT_NEAR(settled(model, "end_bottom"), -3e-5, 1e-11);
  // Held by the spring alone, a load on the other side bends the bar and presses it together, but
  // the mean over the spring stays.
  const Model below = make_model(bar_under(pushing(-3000.0, "bar.bottom")), {});
  ASSERT_EQ(below.system.bodies[0].loads.size(), 1);
  const Equilibrium rest = find_equilibrium(below.system, sliding_state(below.system, 0.0));
  const Model lifted = make_model(bar_under(lifting(1.0, "bar.backing")), {});
  const SystemBody& by_spring = lifted.system.bodies[0];
  const double force = by_spring.modal.rows.row(by_spring.loads[0].row) * rest.displacement[0];
  EXPECT_NEAR(force, -3000.0, 1e-6);
}

TEST(SceneDrives, ALoadOnASurfaceLeavesTheReductionAsItIs) {
  ModelParameters free = bar_under(pushing(-3000.0, "bar.top"));
  free.substructures["bar"].get<BeamParameters>().reduction.fixed_interface_modes = 20;
  const Model loaded = make_model(free, {{{"bar", "start_bottom"}, "record.channels.0"},
                                         {{"bar", "end_bottom"}, "record.channels.1"}});
  free.drives.clear();
  const Model alone = make_model(free, {{{"bar", "start_bottom"}, "record.channels.0"},
                                        {{"bar", "end_bottom"}, "record.channels.1"}});
  const ReducedBody& a = loaded.system.bodies[0].reduced;
  const ReducedBody& b = alone.system.bodies[0].reduced;
  EXPECT_EQ(a.num_interface, b.num_interface);
  EXPECT_EQ(a.mass, b.mass);
  EXPECT_EQ(a.stiffness, b.stiffness);
}

TEST(SceneDrives, ADisplacedSpringCarriesTheBodyAlong) {
  const Model model = model_of_bar(lifting(4e-5, "bar.backing"));
  ASSERT_EQ(model.system.bodies[0].loads.size(), 1);
  EXPECT_EQ(model.system.bodies[0].loads[0].by, BodyLoad::By::shift);
  EXPECT_NEAR(settled(model, "start_bottom"), 4e-5, 1e-13);
  EXPECT_NEAR(settled(model, "end_bottom"), 4e-5, 1e-13);
}

/// A mass between two springs to ground along y.
LumpedParameters sprung_mass() {
  LumpedParameters mass;
  mass.directions = {"y"};
  mass.masses["mass"] = {2.0, {}};
  for (const auto& [name, stiffness] : {std::pair("below", 300.0), std::pair("above", 100.0)}) {
    LumpedSpringParameters& spring = mass.springs[name];
    spring.at = {"mass"};
    spring.stiffness.yy = stiffness;
  }
  return mass;
}

TEST(SceneDrives, TheForceOfADisplacedSpringIsItsStiffnessTimesThat) {
  ModelParameters model;
  model.substructures["body"] = sprung_mass();
  model.drives["lift"] = lifting(0.02, "body.above");
  const Model made = make_model(model, {{{"body", "mass"}, "record.channels.0"}});
  const SystemBody& body = made.system.bodies[0];
  EXPECT_DOUBLE_EQ(body.reduced.rows(body.loads.at(0).row, 0), 100.0);
  const Equilibrium rest = find_equilibrium(made.system, sliding_state(made.system, 0.0));
  // 100 (0.02 − u) = 300 u.
  EXPECT_NEAR(body.modal.shapes(0, 0) * rest.displacement[0](0), 0.005, 1e-16);
}

/// The beams of the paper with drives in the place of the drive.
ModelParameters driven_by(const std::map<std::string, DriveParameters>& drives) {
  ModelParameters model = test::paper_model();
  model.drive.reset();
  model.drives = drives;
  return model;
}

DriveParameters paper_drive_of(double velocity, double load) {
  DriveParameters drive;
  drive.velocity = TimeCurve(velocity);
  drive.load = TimeCurve(load);
  drive.ramp = 0.1;
  return drive;
}

TEST(SceneDrives, TheOnlyOneByNameIsTheDrive) {
  const Model named = make_model(driven_by({{"feed", paper_drive_of(0.03, -0.2)}}), {});
  const Model single = make_model(test::paper_model(), {});
  Simulation a(named.system, test::paper_time());
  Simulation b(single.system, test::paper_time());
  ASSERT_EQ(a.step_until(2000), StepOutcome::done);
  ASSERT_EQ(b.step_until(2000), StepOutcome::done);
  EXPECT_EQ(a.save(), b.save());
}

TEST(SceneDrives, FrictionRisesWithTheDriveThatMovesABodyElseWithOneThatLoadsIt) {
  DriveParameters feed = paper_drive_of(0.03, 0.0);
  feed.ramp = 0.2;
  const Model moved = make_model(
      driven_by({{"a", paper_drive_of(0.0, -0.2)}, {"feed", feed}}), {});
  EXPECT_EQ(moved.system.contacts[0].friction_rise.constant_from(), 0.2);
  EXPECT_EQ(moved.system.contacts[0].armed_from, 0.2);
  DriveParameters still = paper_drive_of(0.0, -0.2);
  still.ramp = 0.3;
  DriveParameters elsewhere = pushing(1.0, "cantilever.free_end");
  elsewhere.ramp = 0.4;
  const Model loaded = make_model(driven_by({{"a", elsewhere}, {"b", still}}), {});
  EXPECT_EQ(loaded.system.contacts[0].friction_rise.constant_from(), 0.3);
}

/// The oblique beam and the cantilever on guided supports of their own, the latter on a spring.
ModelParameters beams_against_each_other(double of_oblique, double of_cantilever) {
  DriveParameters feed = paper_drive_of(of_oblique, -0.2);
  feed.ramp = 1e-3;
  feed.moves = feed.load_on = {"oblique"};
  DriveParameters table = paper_drive_of(of_cantilever, 0.0);
  table.ramp = 1e-3;
  table.moves = {"cantilever"};
  ModelParameters model = driven_by({{"feed", feed}, {"table", table}});
  auto& cantilever = model.substructures["cantilever"].get<BeamParameters>();
  cantilever.supports.start = Support::guided;
  SurfaceSpringParameters spring;
  spring.on = "start_top";
  spring.stiffness.yy = 1e5;
  cantilever.springs["table"] = spring;
  model.contact->armed_from = 1.0;
  return model;
}

TEST(SceneDrives, BeamsMayFollowDifferentOnes) {
  const Model model = make_model(beams_against_each_other(0.3, -0.2), {});
  EXPECT_EQ(model.system.bodies[0].drive, 1);
  EXPECT_EQ(model.system.bodies[1].drive, 0);
  EXPECT_TRUE(model.system.bodies[0].loads.empty());
  EXPECT_EQ(model.system.driven_motion(model.system.contacts[0]).end_velocity(), 0.5);
  Simulation simulation(model.system, test::paper_time(), Accounts::energy);
  ASSERT_EQ(simulation.step_until(20'000), StepOutcome::done) << simulation.failure();
  // 4 ms at 0.5 m/s less half a ramp; friction bends the tip by about a tenth of a millimetre, and it
  // still swings.
  EXPECT_NEAR(simulation.contact_place(0).position, 0.030 + 0.5 * 3.5e-3, 2.5e-4);
  EXPECT_LT(simulation.energy()->relative_error(), 1e-12);
  // A common velocity of both is not felt.
  const Model faster = make_model(beams_against_each_other(0.5, 0.0), {});
  const Equilibrium a = find_equilibrium(model.system, sliding_state(model.system, 0.003));
  const Equilibrium b = find_equilibrium(faster.system, sliding_state(faster.system, 0.005));
  ASSERT_EQ(a.status, EquilibriumStatus::converged) << a.failure;
  ASSERT_EQ(b.status, EquilibriumStatus::converged) << b.failure;
  EXPECT_NEAR(a.contacts[0].slip_velocity, b.contacts[0].slip_velocity, 1e-15);
  EXPECT_NEAR(a.contacts[0].position, b.contacts[0].position, 1e-12);
  EXPECT_NEAR(a.contacts[0].force, b.contacts[0].force, 1e-10);
}

TEST(SceneDrives, SeveralLoadsOfOneBodyAdd) {
  DriveParameters feed = paper_drive_of(0.03, -0.2);
  feed.load_on = {"guided", "oblique.end_top"};
  const Model model = make_model(driven_by({{"feed", feed}}), {});
  EXPECT_EQ(model.system.bodies[1].loads.size(), 2);
  feed.load_on = {"oblique"};
  EXPECT_EQ(make_model(driven_by({{"feed", feed}}), {}).system.bodies[1].loads.size(), 1);
}

std::string refusal(const std::map<std::string, DriveParameters>& drives,
                    const std::function<void(ModelParameters&)>& change = {}) {
  ModelParameters model = driven_by(drives);
  if (change) change(model);
  return message_of<ConfigError>([&] { make_model(model, {}); });
}

TEST(SceneDrives, RefuseWhatIsNotThere) {
  DriveParameters drive = paper_drive_of(0.03, -0.2);
  drive.moves = {"obliqe"};
  EXPECT_THAT(refusal({{"feed", drive}}),
              HasSubstr("drives.feed.moves.0: there is no 'obliqe' to move, did you mean "
                        "'oblique'? (there are: guided, oblique, contact.master)"));
  drive.moves = {"cantilever"};
  EXPECT_THAT(refusal({{"feed", drive}}),
              HasSubstr("drives.feed.moves.0: 'cantilever' has no guided support"));
  drive.moves = {};
  drive.load_on = {"cantilever.tpo"};
  EXPECT_THAT(refusal({{"feed", drive}}),
              HasSubstr("drives.feed.load_on.0: 'cantilever' has no point, surface or load 'tpo', did "
                        "you mean 'top'?"));
  drive.load_on = {"cantilever.top", "cantilever.top"};
  EXPECT_THAT(refusal({{"feed", drive}}),
              HasSubstr("drives.feed.load_on.1: 'cantilever.top' is named already"));
  drive.load_on = {"cantilever.start_face"};
  EXPECT_THAT(refusal({{"feed", drive}}),
              HasSubstr("'cantilever.start_face' is held in y, so that no load moves it"));
  drive.load_on = {"cantilever"};
  EXPECT_THAT(refusal({{"feed", drive}}),
              HasSubstr("drives.feed.load_on.0: 'cantilever' has no guided support"));
}

TEST(SceneDrives, RefuseSpringsThatAreNotThere) {
  EXPECT_THAT(refusal({{"lift", lifting(1e-3, "bar.backin")}},
                      [](ModelParameters& model) { model.substructures["bar"] = sprung_bar(); }),
              HasSubstr("drives.lift.displaces.0: 'bar' has no spring to ground 'backin', did you "
                        "mean 'backing'? (it has: backing)"));
  EXPECT_THAT(refusal({{"lift", lifting(1e-3, "cantilever.top")}}),
              HasSubstr("'cantilever' has no spring to ground 'top' (it has: none)"));
}

TEST(SceneDrives, RefuseTwoThatMoveOneBody) {
  const std::map<std::string, DriveParameters> both{{"a", paper_drive_of(0.03, 0.0)},
                                                    {"b", paper_drive_of(0.01, 0.0)}};
  EXPECT_THAT(refusal(both),
              HasSubstr("drives.b.moves: 'oblique' follows drives.a already, and a body follows "
                        "one drive"));
  std::map<std::string, DriveParameters> named = both;
  for (auto& [name, drive] : named) drive.moves = {"contact.master"};
  EXPECT_THAT(refusal(named,
                      [](ModelParameters& model) {
                        model.contact->master = rigid_master;
                        model.substructures.erase("cantilever");
                      }),
              HasSubstr("drives.b.moves.0: 'contact.master' is moved by drives.a already"));
}

TEST(SceneDrives, RefuseAVelocityThatNothingFollows) {
  DriveParameters belt = paper_drive_of(0.03, 0.0);
  belt.moves = {"oblique"};
  DriveParameters idle = paper_drive_of(0.03, 0.0);
  EXPECT_THAT(refusal({{"belt", belt}, {"idle", idle}}), HasSubstr("drives.idle.moves: 'oblique'"));
  EXPECT_THAT(refusal({{"belt", belt}},
                      [](ModelParameters& model) {
                        model.substructures["oblique"].get<BeamParameters>().supports.end =
                            Support::clamped;
                      }),
              HasSubstr("drives.belt.moves.0: 'oblique' has no guided support"));
}

}  // namespace
}  // namespace stridor
