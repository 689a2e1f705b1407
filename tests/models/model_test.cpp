#include "models/model.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "core/errors.hpp"
#include "solvers/integrators/make_propagator.hpp"
#include "substructures/bodies/beam.hpp"
#include "tests/support/message_of.hpp"
#include "tests/support/paper_model.hpp"

namespace stridor {
namespace {

using namespace test;

using ::testing::HasSubstr;

/// Expects make_model to refuse the parameters at this key with this in the message.
void expect_refusal(const ModelParameters& parameters, const std::string& key,
                    const std::string& message,
                    const std::vector<std::pair<PointName, std::string>>& observed = {}) {
  try {
    make_model(parameters, observed);
    ADD_FAILURE() << "not refused: " << key << ": " << message;
  } catch (const ConfigError& error) {
    EXPECT_EQ(error.problems().at(0).key, key);
    EXPECT_THAT(error.problems().at(0).message, HasSubstr(message));
  }
}

TEST(Model, PaperBeamsReduceToTheirPublishedSizes) {
  const Model model = make_paper_model(paper_model());
  ASSERT_EQ(model.system.bodies.size(), 2u);
  EXPECT_EQ(model.system.bodies[0].name, "cantilever");
  EXPECT_EQ(model.system.bodies[0].reduced.size(), 220);
  EXPECT_EQ(model.system.bodies[1].reduced.size(), 23);
  EXPECT_EQ(model.system.bodies[0].reduced.num_interface, 200);
  EXPECT_EQ(model.system.bodies[1].reduced.num_interface, 3);
  EXPECT_FALSE(model.system.bodies[0].follows_drive());
  EXPECT_TRUE(model.system.bodies[1].follows_drive());
}

TEST(Model, SlavePointIsPlacedOnTheMasterAtItsStart) {
  for (const double angle : {trailing_angle, leading_angle}) {
    const Model model = make_paper_model(paper_model(angle));
    const ContactPoint& contact = model.system.contacts.at(0);
    EXPECT_NEAR(contact.slave_position.x(), 0.030, 1e-15);
    EXPECT_NEAR(contact.slave_position.y(), 0.001, 1e-15);
    const MasterSurface& surface = model.system.surfaces.at(0);
    EXPECT_EQ(surface.num_segments(), 100);
    EXPECT_NEAR(surface.arc_length.back(), 0.1, 1e-15);
    const Segment segment = surface.undeformed_segment(contact.first_segment);
    const double xi = project(segment, contact.slave_position).xi;
    EXPECT_GE(xi, -1e-9);
    EXPECT_LE(xi, 1.0 + 1e-9);
  }
}

TEST(Model, SlavePointIsPlacedOnTheRoughSurface) {
  ModelParameters parameters = paper_model();
  parameters.contact->surface = SurfaceKind::smooth;
  parameters.contact->roughness = RoughnessParameters{1e-8, 1e-4, 5};
  const System system = make_paper_model(parameters).system;
  const MasterSurface& surface = system.surfaces[0];
  EXPECT_EQ(surface.kind, SurfaceKind::smooth);
  const double height = surface.roughness.at(0.030).value;
  EXPECT_GT(std::abs(height), 1e-10);
  EXPECT_NEAR(system.contacts[0].slave_position.y(), 0.001 + height, 1e-17);
  EXPECT_NEAR(Simulation(system, paper_time()).contact_place(0).gap, 0.0, 1e-17);
}

TEST(Model, RoughnessNeedsAMasterWithEndsAndALengthThatItsTableCanHold) {
  ModelParameters parameters = paper_model();
  parameters.contact->roughness = RoughnessParameters{1e-8, 0.9e-7, 5};
  expect_refusal(parameters, "contact.roughness.correlation_length",
                 "9e-08 m is too small for a master of 0.1 m, on which it takes 1e-07 m at least");
  parameters.contact->roughness->correlation_length = 1e-4;
  parameters.contact->master = "rigid";
  expect_refusal(parameters, "contact.roughness", "the master `rigid` has no end");
  // No height, no table.
  parameters = paper_model();
  parameters.contact->roughness = RoughnessParameters{0.0, 1e-12, 5};
  EXPECT_TRUE(make_paper_model(parameters).system.surfaces[0].roughness.is_smooth());
}

TEST(Model, InterfaceSpacingKeepsEveryKthNode) {
  ModelParameters parameters = paper_model();
  auto& cantilever = parameters.substructures["cantilever"].get<BeamParameters>();
  cantilever.interface.spacing = 0.005;
  const Model model = make_paper_model(parameters);
  EXPECT_EQ(model.system.surfaces[0].num_segments(), 20);
  EXPECT_EQ(model.system.bodies[0].reduced.num_interface, 40);
}

TEST(Model, InterfaceSpacingMustFitTheMesh) {
  ModelParameters parameters = paper_model();
  auto& cantilever = parameters.substructures["cantilever"].get<BeamParameters>();
  cantilever.interface.spacing = 0.0015;
  expect_refusal(parameters, "substructures.cantilever.interface.spacing",
                 "must be a whole multiple of the node distance 0.001 m");
  cantilever.interface.spacing = 0.003;
  expect_refusal(parameters, "substructures.cantilever.interface.spacing",
                 "divide the surface of 100 such intervals");
}

TEST(Model, ObservedPointOutsideTheInterfaceIsRecovered) {
  const Model model =
      make_model(paper_model(), {{{"oblique", "end_top"}, "k"}, {{"cantilever", "end"}, "k"}});
  EXPECT_EQ(model.points.size(), 2u);
  // On the guided end the horizontal motion is held: a row of zeros.
  const Model::Point guided = model.points.at({"oblique", "end_top"});
  EXPECT_EQ(model.system.bodies[1].reduced.rows.row(guided.rows.x).norm(), 0.0);
  const Model::Point interior = model.points.at({"cantilever", "end"});
  EXPECT_GT(model.system.bodies[0].reduced.rows.row(interior.rows.y).norm(), 0.0);
}

TEST(Model, UnknownNamesAreRefusedWithSuggestions) {
  ModelParameters parameters = paper_model();
  parameters.contact->master = "cantilevr.top";
  expect_refusal(parameters, "contact.master",
                 "there is no substructure 'cantilevr', did you mean 'cantilever'?");
  parameters = paper_model();
  parameters.contact->master = "cantilever.topp";
  expect_refusal(parameters, "contact.master",
                 "'cantilever' has no surface 'topp', did you mean 'top'?");
  parameters = paper_model();
  parameters.contact->slave = {"oblique.tipp"};
  expect_refusal(parameters, "contact.slave",
                 "'oblique' has no point or surface 'tipp', did you mean 'tip'?");
  parameters = paper_model();
  parameters.contact->slave = {"oblique"};
  expect_refusal(parameters, "contact.slave",
                 "'oblique' is not of the form <body>.<point or surface>");
  expect_refusal(paper_model(), "record.channels.0",
                 "'cantilever' has no point 'free_and', did you mean 'free_end'?",
                 {{{"cantilever", "free_and"}, "record.channels.0"}});
}

TEST(Model, StartOffTheMasterIsRefusedWithTheAllowedRange) {
  ModelParameters parameters = paper_model();
  parameters.contact->start = 0.2;
  expect_refusal(
      parameters, "contact.start",
      "0.2 m is off the master 'cantilever.top', which is 0.1 m long; allowed: 0 to 0.1 m");
}

TEST(Model, SecondSlavePointOffTheEndOfTheMasterIsRefused) {
  ModelParameters parameters = paper_model();
  parameters.substructures["oblique"].get<BeamParameters>().angle = 0.0;
  parameters.contact->slave = {"oblique.start_bottom", "oblique.end_bottom"};
  parameters.contact->start = 0.050;
  expect_refusal(parameters, "contact.start",
                 "slave point 2 starts off the end of the master 'cantilever.top'");
}

TEST(Model, SlavePointAboveTheMasterIsRefused) {
  ModelParameters parameters = paper_model();
  parameters.contact->slave = {"oblique.tip", "oblique.start_top"};
  expect_refusal(parameters, "contact.slave", "slave point 2 starts 0.0012990");
}

TEST(Model, SlaveAndMasterMustDiffer) {
  ModelParameters parameters = paper_model();
  parameters.contact->slave = {"cantilever.free_end"};
  expect_refusal(parameters, "contact.slave", "slave and master must be different bodies");
}

TEST(Model, PointsOfOnePairMustBelongToOneBody) {
  ModelParameters parameters = paper_model();
  parameters.substructures["third"] = paper_oblique(trailing_angle);
  parameters.contact->slave = {"oblique.tip", "third.tip"};
  expect_refusal(parameters, "contact.slave", "must belong to one body");
}

TEST(Model, SeveralPairsPlaceTheirBodies) {
  ModelParameters parameters = paper_model();
  parameters.substructures["second"] = paper_oblique(leading_angle);
  ContactParameters first = *parameters.contact;
  ContactParameters second = first;
  second.slave = {"second.tip"};
  second.start = 0.060;
  parameters.contact.reset();
  parameters.contacts = {{"one", first}, {"two", second}};
  const Model model = make_paper_model(parameters);
  ASSERT_EQ(model.system.contacts.size(), 2u);
  EXPECT_EQ(model.system.contacts[0].name, "one");
  EXPECT_NEAR(model.system.contacts[1].slave_position.x(), 0.060, 1e-15);
  Simulation simulation(model.system, paper_time());
  EXPECT_EQ(simulation.step_until(2000), StepOutcome::done) << simulation.failure();
}

TEST(Model, ABodyIsPlacedByOnePairOnly) {
  ModelParameters parameters = paper_model();
  ContactParameters first = *parameters.contact;
  ContactParameters second = first;
  second.start = 0.040;
  parameters.contact.reset();
  parameters.contacts = {{"one", first}, {"two", second}};
  expect_refusal(parameters, "contacts.two.start", "'oblique' is placed already");
}

TEST(Model, PairsInACircleAreRefused) {
  ModelParameters parameters = paper_model();
  ContactParameters first = *parameters.contact;
  ContactParameters second = first;
  second.slave = {"cantilever.free_end"};
  second.master = "oblique.top";
  parameters.contact.reset();
  parameters.contacts = {{"one", first}, {"two", second}};
  expect_refusal(parameters, "contacts.one.master", "form a circle");
}

TEST(Model, TooManyModesAreRefusedWithTheNumberThereIs) {
  ModelParameters parameters = paper_model();
  parameters.substructures["cantilever"].get<BeamParameters>().reduction.fixed_interface_modes =
      301;
  // 253 nodes, 3 of them clamped: 500 DoFs, 200 of them in the interface.
  expect_refusal(parameters, "substructures.cantilever.reduction.fixed_interface_modes",
                 "301 modes asked, but 'cantilever' has only 300 DoFs besides its interface");
}

TEST(Model, ABodyThatIsFreeToTurnIsRefused) {
  ModelParameters parameters = paper_model();
  parameters.substructures["oblique"].get<BeamParameters>().supports.end = Support::free;
  parameters.drive->velocity = TimeCurve(0.0);  // which no support follows any more
  expect_refusal(parameters, "substructures.oblique",
                 "cannot be reduced: the stiffness of the interior");
}

TEST(Model, ConstantsOfTheDriveRiseOverTheRamp) {
  const Model model = make_paper_model(paper_model());
  const Drive& drive = model.system.drives[0];
  EXPECT_EQ(drive.velocity.value(0.0), 0.0);
  EXPECT_EQ(drive.velocity.value(0.1), 0.030);
  EXPECT_EQ(drive.load.value(0.2), -0.20);
  EXPECT_NEAR(drive.displacement(1.0), 0.030 * 0.95, 1e-16);
  EXPECT_EQ(sliding_friction(model.system.contacts[0].friction, 0.03), 0.30);
  EXPECT_EQ(model.system.contacts[0].armed_from, 0.1);
}

/// The oblique beam on rigid ground, alone.
ModelParameters on_rigid_ground() {
  ModelParameters parameters = paper_model();
  parameters.substructures.erase("cantilever");
  parameters.contact->master = "rigid";
  return parameters;
}

TEST(Model, TheRigidMasterIsAnEndlessLineUnderTheSlave) {
  ModelParameters parameters = on_rigid_ground();
  parameters.contact->start = 7.25;  // no end to be off
  const Model model = make_model(parameters, {});
  const System& system = model.system;
  ASSERT_EQ(system.bodies.size(), 2u);
  EXPECT_EQ(system.bodies[1].name, "rigid");
  EXPECT_EQ(system.bodies[1].reduced.size(), 0);
  EXPECT_EQ(system.bodies[1].modal.size(), 0);
  EXPECT_FALSE(system.bodies[1].follows_drive());
  const MasterSurface& surface = system.surfaces.at(0);
  EXPECT_EQ(surface.name, "rigid");
  EXPECT_EQ(surface.body, 1);
  EXPECT_TRUE(surface.is_endless);
  const ContactPoint& contact = system.contacts.at(0);
  EXPECT_NEAR(contact.slave_position.x(), 7.25, 1e-15);
  EXPECT_NEAR(contact.slave_position.y(), 0.0, 1e-15);
  // The ground sets no limit to the step.
  EXPECT_EQ(step_limit(system).body, "oblique");
}

TEST(Model, RefusesAVelocityThatNothingFollows) {
  ModelParameters parameters = paper_model();
  SupportParameters& supports = parameters.substructures["oblique"].get<BeamParameters>().supports;
  for (Support* end : {&supports.start, &supports.end})
    if (*end == Support::guided) *end = Support::clamped;
  EXPECT_EQ(
      message_of<ConfigError>([&] { make_model(parameters, {}); }),
      "drive.velocity: moves nothing: no body has a support that is guided, and no master is "
      "named in drive.moves; give the body that is to slide a guided support, or move a rigid "
      "or half_space master");
  parameters.drive->velocity = TimeCurve(0.0);
  EXPECT_NO_THROW(make_model(parameters, {}));
}

TEST(Model, OnRigidGroundTheContactCarriesTheLoadInEveryForm) {
  ModelParameters parameters = on_rigid_ground();
  parameters.contact->assumption = ContactAssumption::film;
  parameters.contact->friction->numbers["coefficient"] = 0.0;
  auto& oblique = parameters.substructures["oblique"].get<BeamParameters>();
  oblique.damping.alpha = 2000.0;
  oblique.damping.alpha_start.reset();
  oblique.damping.hold = oblique.damping.fade = 0.0;
  parameters.drive->ramp = 1e-3;
  const Model model = make_model(parameters, {});
  double force = 0.0;
  for (const Coordinates form : {Coordinates::modal, Coordinates::craig_bampton_fused}) {
    Simulation simulation(model.system, paper_time(2e-7, form));
    ASSERT_EQ(simulation.step_until(150'000), StepOutcome::done) << simulation.failure();
    // 30 ms at 1000 1/s leave e^-30 of the start; the rest is rounding of displacements of a
    // millimetre over the compliance h² B_C M⁻¹ B_Eᵀ.
    EXPECT_NEAR(simulation.contact_force(0), 0.2, 1e-8);
    EXPECT_NEAR(simulation.contact_place(0).gap, 0.0, 1e-12);
    if (form == Coordinates::modal) force = simulation.contact_force(0);
    EXPECT_NEAR(simulation.contact_force(0), force, 1e-8);
    // The drive has gone on beyond the one metre that the line is drawn with, or would: it has
    // none.
    EXPECT_GT(simulation.contact_place(0).position, 0.030);
  }
}

TEST(Model, SlidingOnRigidGroundFindsNoEnd) {
  ModelParameters parameters = on_rigid_ground();
  parameters.drive->velocity = TimeCurve(1000.0);
  parameters.drive->ramp = 1e-3;
  parameters.contact->armed_from = 1.0;
  for (const double velocity : {1000.0, -1000.0}) {
    parameters.drive->velocity = TimeCurve(velocity);
    const Model model = make_model(parameters, {});
    Simulation simulation(model.system, paper_time());
    ASSERT_EQ(simulation.step_until(20'000), StepOutcome::done) << simulation.failure();
    // 4 ms at 1 m per ms, half a ramp less; the tip is bent by centimetres. The line is drawn from
    // 0 to 1 m.
    EXPECT_NEAR(simulation.contact_place(0).position, 0.030 + velocity * 3.5e-3, 0.3);
  }
}

TEST(Model, AnEdgeAndAPointOnRigidGroundAreContactsOfTheirPairs) {
  // Two pairs on the ground: the lower edge of a flat beam, and the tip of an oblique one.
  ModelParameters parameters = on_rigid_ground();
  BeamParameters flat = paper_oblique(0.0);
  flat.mesh.along = 3;
  flat.reduction.fixed_interface_modes = 5;
  flat.supports.end = Support::guided;
  parameters.substructures["flat"] = flat;
  ContactParameters edge = *parameters.contact;
  edge.slave = {"flat.bottom"};
  edge.start = 0.5;
  parameters.contacts = {{"edge", edge}, {"tip", *parameters.contact}};
  parameters.contact.reset();
  const Model model = make_model(parameters, {});
  const System& system = model.system;
  ASSERT_EQ(system.contacts.size(), 8u);
  EXPECT_EQ(system.contacts[0].name, "edge[0]");
  EXPECT_EQ(system.contacts[6].name, "edge[6]");
  EXPECT_EQ(system.contacts[7].name, "tip");
  for (const ContactPoint& contact : system.contacts)
    EXPECT_NEAR(contact.slave_position.y(), 0.0, 1e-15);
  EXPECT_NEAR(system.contacts[0].slave_position.x(), 0.5, 1e-15);
  EXPECT_NEAR(system.contacts[7].slave_position.x(), 0.030, 1e-15);
  // One rigid body carries both.
  ASSERT_EQ(system.bodies.size(), 3u);
  EXPECT_EQ(system.bodies[2].name, "rigid");
  EXPECT_EQ(system.surfaces[0].body, 2);
  EXPECT_EQ(system.surfaces[1].body, 2);
}

TEST(Model, APointOfASlaveOnRigidGroundMustLieOnIt) {
  ModelParameters parameters = on_rigid_ground();
  parameters.contact->slave = {"oblique.tip", "oblique.start_top"};
  expect_refusal(parameters, "contact.slave", "slave point 2 starts 0.0012990");
  expect_refusal(parameters, "contact.slave", "m away from the master 'rigid'");
}

TEST(Model, TheRigidMasterHasNoPointsOfItsOwn) {
  ModelParameters parameters = on_rigid_ground();
  parameters.contact->slave = {"rigid.tip"};
  expect_refusal(parameters, "contact.slave",
                 "there is no substructure 'rigid' (there are: oblique)");
  expect_refusal(on_rigid_ground(), "record.channels.0",
                 "there is no substructure 'rigid' (there are: oblique)",
                 {{{"rigid", "tip"}, "record.channels.0"}});
}

TEST(Model, ASubstructureMayNotTakeTheNameOfTheRigidMaster) {
  ModelParameters parameters = on_rigid_ground();
  parameters.substructures["rigid"] = paper_oblique();
  expect_refusal(parameters, "substructures.rigid", "'rigid' is the name of a master");
}

TEST(Model, FrictionLawsRiseWithTheRamp) {
  ModelParameters parameters = paper_model();
  parameters.contact->friction =
      FrictionParameters{&friction_law_type("stribeck"),
                         {{"static", 0.4}, {"dynamic", 0.3}, {"decay_velocity", 0.01}}};
  const Model model = make_paper_model(parameters);
  const ContactPoint& contact = model.system.contacts.at(0);
  EXPECT_EQ(contact.friction.static_coefficient, 0.4);
  EXPECT_EQ(sliding_friction(contact.friction, 0.01), 0.3 + (0.4 - 0.3) * std::exp(-1.0));
  EXPECT_EQ(contact.friction_rise.value(0.0), 0.0);
  EXPECT_EQ(contact.friction_rise.value(0.05), 0.5);
  EXPECT_EQ(contact.friction_rise.value(0.1), 1.0);
}

TEST(ModelParameters, ContactAndContactsTogetherAreRefused) {
  ModelParameters parameters = paper_model();
  parameters.contacts["other"] = *parameters.contact;
  std::vector<Problem> problems;
  for (const auto& check : ModelParameters::schema().checks) check(&parameters, problems);
  ASSERT_EQ(problems.size(), 1u);
  EXPECT_EQ(problems[0].key, "contacts");
  parameters.contacts.clear();
  parameters.contact.reset();
  problems.clear();
  for (const auto& check : ModelParameters::schema().checks) check(&parameters, problems);
  EXPECT_TRUE(problems.empty());  // bodies need not touch
}

TEST(ModelParameters, PairsMustAgreeOnSliding) {
  ModelParameters parameters = paper_model();
  ContactParameters frozen = *parameters.contact;
  frozen.sliding = SlidingMode::frozen;
  parameters.contacts = {{"one", *parameters.contact}, {"two", frozen}};
  parameters.contact.reset();
  std::vector<Problem> problems;
  for (const auto& check : ModelParameters::schema().checks) check(&parameters, problems);
  ASSERT_EQ(problems.size(), 1u);
  EXPECT_EQ(problems[0].key, "contacts.two.sliding");
}

}  // namespace
}  // namespace stridor
