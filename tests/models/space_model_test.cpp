// Bodies in space that slide on each other and on rigid planes.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <complex>
#include <limits>

#include "core/errors.hpp"
#include "models/model.hpp"
#include "solvers/eigenvalues/dense_eigenvalues.hpp"
#include "solvers/equilibrium/linearise.hpp"
#include "solvers/transient/simulation.hpp"
#include "tests/support/box_mesh.hpp"
#include "tests/support/message_of.hpp"

namespace stridor {
namespace {

using test::Box;
using test::message_of;
using ::testing::HasSubstr;

constexpr double load = 200.0, speed = 0.2, coefficient = 0.3;

const Box block_box{{0.1, 0.02, 0.02}, {10, 2, 1}, {0.0, -0.02, 0.0}};
const Box pad_box{{0.02, 0.01, 0.01}, {2, 2, 1}, {0.02, 0.0, 0.005}};

/// A pad, guided at its top and pressed down, on a block that is held at its bottom.
ModelParameters pad_on_block(ElementShape shape = ElementShape::hex8) {
  ModelParameters scene;
  MeshBodyParameters block = test::box_body(block_box, test::brick_mesh(block_box, shape));
  block.supports["ground"].on = {"bottom"};
  block.reduction.emplace().fixed_interface_modes = 6;
  block.damping.beta = 1e-6;
  MeshBodyParameters pad = test::box_body(pad_box, test::brick_mesh(pad_box, shape));
  pad.guided.emplace().on = {"top"};
  pad.reduction.emplace().fixed_interface_modes = 4;
  pad.damping.beta = 1e-6;
  scene.substructures["block"] = block;
  scene.substructures["pad"] = pad;
  ContactParameters& contact = scene.contacts["sole"];
  contact.slave = {"pad.bottom"};
  contact.master = "block.top";
  contact.assumption = ContactAssumption::film;
  contact.friction.emplace().numbers["coefficient"] = coefficient;
  DriveParameters& drive = scene.drive.emplace();
  drive.velocity = TimeCurve(speed);
  drive.load = TimeCurve(-load);
  drive.ramp = 0.0;
  return scene;
}

ModelParameters pad_on_plane() {
  ModelParameters scene = pad_on_block();
  scene.substructures.erase("block");
  scene.contacts["sole"].master = rigid_master;
  return scene;
}

struct Sum {
  double normal = 0.0, along = 0.0, across = 0.0;
};

Sum sum_of(const Equilibrium& equilibrium) {
  Sum sum;
  for (const ContactEquilibrium& contact : equilibrium.contacts) {
    sum.normal += contact.force;
    sum.along += contact.friction_force;
    sum.across += contact.friction_across;
  }
  return sum;
}

TEST(SpaceModel, ASlidingPadCarriesItsLoadAndFrictionOpposesIt) {
  for (const bool is_on_plane : {true, false}) {
    const Model model = make_model(is_on_plane ? pad_on_plane() : pad_on_block(), {});
    ASSERT_EQ(model.system.contacts.size(), 6u);
    const Equilibrium equilibrium =
        find_equilibrium(model.system, sliding_state(model.system, 0.0));
    ASSERT_EQ(equilibrium.status, EquilibriumStatus::converged) << equilibrium.failure;
    const Sum sum = sum_of(equilibrium);
    EXPECT_NEAR(sum.normal, load, 1e-6 * load);
    // Normals of the deformed block are turned by its slopes.
    const double slopes = is_on_plane ? 1e-12 : 1e-4;
    EXPECT_NEAR(sum.along, -coefficient * load, slopes * load);
    EXPECT_NEAR(sum.across, 0.0, slopes * load);
  }
}

TEST(SpaceModel, SmallMotionAboutTheEquilibriumStaysThere) {
  Model model = make_model(pad_on_block(), {});
  // Held in place, so that the equilibrium of the start is that of the run.
  for (Drive& drive : model.system.drives) drive.is_frozen = true;
  const Equilibrium equilibrium = find_equilibrium(model.system, sliding_state(model.system, 0.0));
  ASSERT_EQ(equilibrium.status, EquilibriumStatus::converged) << equilibrium.failure;
  apply_initial_motion(model.system, equilibrium);
  for (const auto integrator : {Integrator::exact, Integrator::central_difference}) {
    TimeParameters time;
    time.integrator = integrator;
    time.step = integrator == Integrator::exact ? 2e-7 : 2e-8;
    time.end = 1.0;
    Simulation simulation(model.system, time);
    ASSERT_EQ(simulation.step_until(500), StepOutcome::done) << simulation.failure();
    for (int i = 0; i < simulation.num_contacts(); ++i) {
      const ContactEquilibrium& expected = equilibrium.contacts[static_cast<std::size_t>(i)];
      EXPECT_NEAR(simulation.contact_force(i), expected.force, 1e-3 * load) << i;
      EXPECT_NEAR(simulation.friction_force(i), expected.friction_force, 1e-3 * load) << i;
    }
  }
}

/// Coordinates of all bodies in an equilibrium.
Eigen::VectorXd coordinates(const Equilibrium& equilibrium) {
  std::vector<double> all;
  for (const Eigen::VectorXd& body : equilibrium.displacement)
    all.insert(all.end(), body.begin(), body.end());
  return Eigen::Map<const Eigen::VectorXd>(all.data(), static_cast<Eigen::Index>(all.size()));
}

// (Ω² + Sᵀ G S) δq + Sᵀ B_Eᵀ δλ = δf, B_C S δq = 0 is how the equilibrium moves with the load. Nine
// nodes on facets have more ports than the bodies have modes, which then are the ports; with the
// bodies as they are the contacts keep their own.
TEST(SpaceModel, HundredsOfPortsMoveInTheModesOfTheBodies) {
  for (const bool gives_way : {true, false}) {
    for (const bool has_few_modes : {true, false}) {
      ModelParameters scene = pad_on_block();
      for (auto& [name, body] : scene.substructures)
        if (has_few_modes) body.get<MeshBodyParameters>().interface.modes = 15;
      if (gives_way) {
        scene.contacts["sole"].normal.law = &normal_law_type("penalty");
        scene.contacts["sole"].normal.numbers["stiffness"] = 2e7;
      }
      System system = make_model(scene, {}).system;
      EquilibriumState state = sliding_state(system, 0.0);
      const Equilibrium equilibrium = find_equilibrium(system, state);
      ASSERT_EQ(equilibrium.status, EquilibriumStatus::converged) << equilibrium.failure;
      const Pencil pencil = linearise(system, equilibrium);
      const Eigen::Index n = pencil.num_modes();
      const Eigen::Index k = pencil.num_constraints();
      const auto num_closed =
          std::count_if(equilibrium.contacts.begin(), equilibrium.contacts.end(),
                        [](const ContactEquilibrium& contact) { return contact.is_closed; });
      EXPECT_GE(num_closed, 6);
      EXPECT_EQ(k, gives_way ? 0 : num_closed);
      EXPECT_EQ(pencil.num_ports() == n, has_few_modes);
      EXPECT_NO_THROW(check_pencil(pencil));
      Eigen::MatrixXd matrix = Eigen::MatrixXd::Zero(n + k, n + k);
      matrix.diagonal().head(n) = pencil.omega.array().square();
      ASSERT_GT(pencil.port_stiffness.size(), 0);
      matrix.topLeftCorner(n, n) += pencil.ports.transpose() * pencil.port_stiffness * pencil.ports;
      matrix.topRightCorner(n, k) = pencil.ports.transpose() * pencil.equilibrium.transpose();
      matrix.bottomLeftCorner(k, n) = pencil.compatibility * pencil.ports;
      const auto moved = [&](double by) {
        state.drives[0].load = -load + by;
        const Equilibrium found = find_equilibrium(system, state);
        EXPECT_EQ(found.status, EquilibriumStatus::converged) << found.failure;
        return coordinates(found);
      };
      const double step = 1e-3 * load;
      const Eigen::VectorXd slope = (moved(step) - moved(-step)) / (2.0 * step);
      // The load acts on the pad alone, by its guided row: Ω² q is what contacts leave of it.
      Eigen::VectorXd right_side = Eigen::VectorXd::Zero(n + k);
      const auto pad = static_cast<std::size_t>(system.contacts.front().slave_body);
      Eigen::Index first = 0;
      for (std::size_t b = 0; b < pad; ++b) first += system.bodies[b].modal.size();
      const ModalBody& modal = system.bodies[pad].modal;
      right_side.segment(first, modal.size()) =
          modal.rows.row(system.bodies[pad].loads.front().row);
      const Eigen::VectorXd tangent = matrix.partialPivLu().solve(right_side).head(n);
      // Central difference, whose error is (step/load)² times the curvature.
      EXPECT_LT((tangent - slope).norm(), 1e-5 * slope.norm()) << gives_way << has_few_modes;
    }
  }
}

/// Slides far over a block: force, resumption and energy on the way.
TEST(SpaceModel, SlidesOverManyFacetsAndResumesBitIdentically) {
  ModelParameters scene = pad_on_block();
  scene.contacts["sole"].slave = {"pad.toe"};
  scene.substructures["pad"].get<MeshBodyParameters>().points["toe"].at = {0.03, 0.0, 0.01};
  scene.drive->velocity = TimeCurve(20.0);
  const Model model = make_model(scene, {});
  TimeParameters time;
  time.step = 2e-8;
  time.end = 1.0;
  Simulation straight(model.system, time, Accounts::energy);
  ASSERT_EQ(straight.step_until(20000), StepOutcome::done) << straight.failure();
  const State state = straight.save();
  ASSERT_EQ(straight.step_until(100000), StepOutcome::done) << straight.failure();
  // From 0.03 on by 20 m/s · 2 ms, over four facets of 0.01.
  EXPECT_NEAR(straight.contact_place(0).position, 0.03 + 0.04, 2e-4);
  EXPECT_LT(straight.energy()->relative_error(), 1e-9);
  EXPECT_GT(straight.energy()->balance().friction_loss, 0.0);
  Simulation resumed(model.system, time, Accounts::energy);
  resumed.load(state);
  ASSERT_EQ(resumed.step_until(100000), StepOutcome::done);
  EXPECT_EQ(straight.contact_force(0), resumed.contact_force(0));
  EXPECT_EQ(straight.friction_across(0), resumed.friction_across(0));
  EXPECT_EQ(straight.energy()->balance().friction_loss, resumed.energy()->balance().friction_loss);
  // On to the edge.
  Simulation lost(model.system, time);
  EXPECT_EQ(lost.step_until(400000), StepOutcome::master_lost);
  EXPECT_THAT(lost.failure(), HasSubstr("has left the edge of the surface"));
}

/// A slice, held along z, on a rigid plane, against the same as a planar body under plane strain. Its
/// edge has three nodes, so that forces which are even along it are among those of its contacts.
TEST(SpaceModel, ASliceHeldAcrossHasTheEigenvaluesOfThePlanarScene) {
  const Box pad{{0.02, 0.01, 0.01}, {1, 1, 1}, {0.013, 0.0, 0.0}};
  const auto scene_of = [&](bool is_spatial) {
    ModelParameters scene;
    MeshBodyParameters body = test::box_body(
        pad, is_spatial ? test::brick_mesh(pad, ElementShape::hex20) : test::slice_mesh(pad));
    body.guided.emplace().on = {"top"};
    body.damping.beta = 1e-8;
    body.reduction.reset();  // all modes: nothing is lost
    body.points["near"].at = {0.013, 0.0};
    if (is_spatial) {
      Mesh mesh = *body.mesh;
      for (int n = 0; n < static_cast<int>(mesh.num_nodes()); ++n)
        mesh.node_sets["all"].push_back(n);
      body.mesh = std::make_shared<const Mesh>(mesh);
      body.supports["slice"].on = {"all"};
      body.supports["slice"].held = {"z"};
      body.points["near"].at = {0.013, 0.0, 0.0};
      body.points["middle"].at = {0.013, 0.0, 0.005};
      body.points["far"].at = {0.013, 0.0, 0.01};
    }
    scene.substructures["pad"] = body;
    ContactParameters& contact = scene.contacts["toe"];
    contact.slave = {"pad.near"};
    if (is_spatial) contact.slave = {"pad.near", "pad.middle", "pad.far"};
    contact.master = rigid_master;
    contact.assumption = ContactAssumption::subs_b;
    if (!is_spatial) contact.start = 0.013;
    contact.friction.emplace().numbers["coefficient"] = coefficient;
    DriveParameters& drive = scene.drive.emplace();
    drive.velocity = TimeCurve(speed);
    drive.load = TimeCurve(-load);
    return scene;
  };
  const auto eigenvalues_of = [&](bool is_spatial, double& force) {
    const Model model = make_model(scene_of(is_spatial), {});
    const Equilibrium equilibrium =
        find_equilibrium(model.system, sliding_state(model.system, 0.001));
    EXPECT_EQ(equilibrium.status, EquilibriumStatus::converged) << equilibrium.failure;
    force = 0.0;
    for (const ContactEquilibrium& contact : equilibrium.contacts) force += contact.force;
    std::vector<std::complex<double>> found;
    for (const Eigenvalue& one : dense_spectrum(linearise(model.system, equilibrium)).eigenvalues)
      if (one.s.imag() > 0.0) found.push_back(one.s);
    return found;
  };
  double planar_force = 0.0, force = 0.0;
  const auto planar = eigenvalues_of(false, planar_force);
  const auto spatial = eigenvalues_of(true, force);
  EXPECT_NEAR(force, planar_force, 1e-8 * planar_force);
  ASSERT_GE(planar.size(), 10u);
  for (std::size_t i = 0; i < 10; ++i) {
    double nearest = std::numeric_limits<double>::infinity();
    for (const std::complex<double>& s : spatial) nearest = std::min(nearest, std::abs(s - planar[i]));
    // Rounding of the stiffness, 1e-16 of its largest eigenvalue, some 1e4 times that of these.
    EXPECT_LT(nearest, 1e-7 * std::abs(planar[i])) << i;
  }
}

TEST(SpaceModel, RefusesWhatMeansNothingInSpace) {
  const auto message = [](ModelParameters scene) {
    return message_of<ConfigError>([&] { make_model(scene, {}); });
  };
  const auto changed = [&](auto&& change) {
    ModelParameters scene = pad_on_block();
    change(scene.contacts["sole"]);
    return message(std::move(scene));
  };
  EXPECT_THAT(changed([](ContactParameters& c) { c.assumption = ContactAssumption::subs_a; }),
              HasSubstr("contacts.sole.assumption: must be subs_b or film in space"));
  EXPECT_THAT(changed([](ContactParameters& c) { c.start = 0.01; }),
              HasSubstr("contacts.sole.start: must be {at: [x, y, z]}"));
  EXPECT_THAT(changed([](ContactParameters& c) { c.normal.numbers["preload"] = 3.0; }),
              HasSubstr("contacts.sole.normal.preload"));
  EXPECT_THAT(changed([](ContactParameters& c) { c.start.at = {0.5, 0.0, 0.005}; }),
              HasSubstr("is beside the surface 'block.top'"));
  EXPECT_THAT(changed([](ContactParameters& c) { c.master = "block.lid"; }),
              HasSubstr("'block' has no surface 'lid'"));
  EXPECT_THAT(changed([](ContactParameters& c) { c.slave = {"pad.sole"}; }),
              HasSubstr("'pad' has no point or surface 'sole'"));
  EXPECT_THAT(changed([](ContactParameters& c) { c.slave = {"pad.top"}; }),
              HasSubstr("starts on the inner side of its master"));
  ModelParameters upside_down = pad_on_plane();
  upside_down.contacts["sole"].plane.emplace().normal = {0.0, -1.0, 0.0};
  EXPECT_THAT(message(upside_down), HasSubstr("turn plane.normal towards the slave"));
}

TEST(SpaceModel, GapsUpToTheAdjustmentAreTakenAsClosed) {
  ModelParameters scene = pad_on_block();
  constexpr double gap = 1e-5;
  scene.contacts["sole"].start.at = {0.02, gap, 0.005};
  const Model apart = make_model(scene, {});
  EXPECT_EQ(apart.system.contacts.front().overlap, 0.0);
  scene.contacts["sole"].adjust = 2e-5;
  const Model closed = make_model(scene, {});
  for (const ContactPoint& contact : closed.system.contacts)
    EXPECT_NEAR(contact.overlap, gap, 1e-15);
}

}  // namespace
}  // namespace stridor
