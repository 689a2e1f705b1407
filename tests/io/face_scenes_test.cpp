// Discs with pads as scenes of bodies: the systems made of them against a second formulation.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <fstream>
#include <limits>
#include <string>
#include <tuple>
#include <vector>

#include "io/scene/scene.hpp"
#include "solvers/eigenvalues/dense_eigenvalues.hpp"
#include "solvers/eigenvalues/linear_pencil.hpp"
#include "solvers/equilibrium/equilibrium.hpp"
#include "solvers/equilibrium/linearise.hpp"
#include "tests/support/face_contact.hpp"
#include "tests/support/message_of.hpp"
#include "tests/support/program.hpp"
#include "tests/support/reference_brake.hpp"
#include "tests/support/sliding_state.hpp"
#include "tests/support/temporary_folder.hpp"

namespace stridor {
namespace {

using test::message_of;
using test::scene_path;
using ::testing::HasSubstr;

const std::string plate_text = R"(
  disc:
    type: annular_plate
    inner_radius: 80 mm
    outer_radius: 160 mm
    thickness: 12 mm
    material: {youngs_modulus: 210 GPa, poissons_ratio: 0.3, density: 7850}
    nodal_diameters: 6
    spin: 10 rad/s
    damping: {beta: 1.0e-7}
)";

const std::string rigid_pads = R"(
  upper: &pad
    type: lumped
    directions: [x, y, z]
    masses: {block: {mass: 0.25}}
    springs: {backing: {at: block, stiffness: {xx: 4.0e+7, yy: 1.0e+8, zz: 6.0e+7, xy: 2.0e+7}}}
    damping: {beta: 1.0e-7}
  lower: *pad
)";

/// The face of a pad begins at the end of its axis.
const std::string elastic_pads = R"(
  upper: &pad
    type: beam
    length: 60 mm
    thickness: 15 mm
    width: 40 mm
    angle: 0 deg
    across: rigid
    material: {youngs_modulus: 10 GPa, poissons_ratio: 0.3, density: 2500}
    mesh: {along: 12, through: 3}
    points:
      p0: {on: bottom, at: 60 mm}
      p1: {on: bottom, at: 45 mm}
      p2: {on: bottom, at: 30 mm}
      p3: {on: bottom, at: 15 mm}
      p4: {on: bottom, at: 0 mm}
    springs: {backing: {on: top, stiffness: {xx: 4.0e+7, yy: 1.0e+8, zz: 6.0e+7, xy: 2.0e+7}}}
    damping: {alpha: 0, beta: 1.0e-7}
    reduction: {fixed_interface_modes: 20}
  lower: *pad
)";

/// Contacts of both pads.
std::string contacts_text(const std::vector<std::string>& points, const std::string& normal,
                          double friction) {
  std::string text = "contacts:\n";
  for (const std::string pad : {"upper", "lower"}) {
    std::string slaves;
    for (const std::string& point : points) slaves += (slaves.empty() ? "" : ", ") + pad + "." + point;
    text += "  " + pad + ":\n    slave: [" + slaves + "]\n    master: disc." +
            (pad == "upper" ? "top" : "bottom") +
            "\n    assumption: film\n    start: {radius: 130 mm}\n    normal: " + normal +
            "\n    friction: {coefficient: " + std::to_string(friction) + "}\n";
  }
  return text;
}

struct FaceScene {
  explicit FaceScene(const std::string& text, const std::vector<std::string>& sets = {}) {
    const std::string path = (folder / "scene.yaml").string();
    std::ofstream(path) << "format: 2\nsubstructures:" << text;
    loaded = load_scene(path, sets);
    model = make_model(loaded.scene.model, {});
  }
  test::TemporaryFolder folder;
  LoadedScene loaded;
  Model model;
};

FaceScene rigid_scene(const std::string& normal, double friction,
                      const std::vector<std::string>& sets = {}) {
  return FaceScene(plate_text + rigid_pads + contacts_text({"block"}, normal, friction), sets);
}

/// The brake of these texts for the second formulation.
DiscModelParameters damped_brake() {
  DiscModelParameters brake = test::reference_brake(
      {"gyroscopic", "friction", "friction_damping", "geometric", "structural_damping"});
  brake.disc.damping.beta = brake.pads.damping.beta = 1e-7;
  return brake;
}

DiscModelParameters elastic_brake() {
  DiscModelParameters brake = damped_brake();
  brake.contact.preload.reset();
  brake.pads.mass.reset();
  brake.pads.elastic = ElasticPadParameters{0.06, 0.015, 0.04, {1e10, 0.3, 2500.0}, {12, 3}, {}};
  brake.pads.elastic->reduction.fixed_interface_modes = 20;
  brake.contact.offsets = {-0.03, -0.015, 0.0, 0.015, 0.03};
  brake.contact.friction.coefficient = 0.4;
  brake.contact.formulation = ContactFormulation::penalty;
  brake.contact.penalty = 5e8;
  return brake;
}

/// First coordinate of a body in those of the whole system.
Eigen::Index first_of(const System& system, int body) {
  Eigen::Index first = 0;
  for (int b = 0; b < body; ++b) first += system.bodies[static_cast<std::size_t>(b)].reduced.size();
  return first;
}

/// Bodies without contact, side by side in reduced coordinates.
LinearSystem free_bodies_of(const System& system) {
  const Eigen::Index size = first_of(system, static_cast<int>(system.bodies.size()));
  LinearSystem all;
  all.mass = all.velocity = all.position = Eigen::MatrixXd::Zero(size, size);
  all.gaps = all.forces = Eigen::MatrixXd::Zero(0, size);
  for (std::size_t b = 0; b < system.bodies.size(); ++b) {
    const ReducedBody& body = system.bodies[b].reduced;
    const Eigen::Index first = first_of(system, static_cast<int>(b));
    const auto block = [&](Eigen::MatrixXd& matrix) {
      return matrix.block(first, first, body.size(), body.size());
    };
    block(all.mass) = body.mass;
    block(all.position) = body.stiffness;
    block(all.velocity) = body.damping.alpha * body.mass + body.damping.beta * body.stiffness;
    if (body.coupled.is_empty()) continue;
    block(all.velocity) += body.coupled.velocity;
    block(all.position) += body.coupled.position;
  }
  return all;
}

/// A row of a body on all coordinates; zeros where the body does not move.
Eigen::VectorXd row_of(const System& system, int body, int row) {
  const Eigen::Index size = first_of(system, static_cast<int>(system.bodies.size()));
  Eigen::VectorXd whole = Eigen::VectorXd::Zero(size);
  const ReducedBody& reduced = system.bodies[static_cast<std::size_t>(body)].reduced;
  if (row >= 0) whole.segment(first_of(system, body), reduced.size()) = reduced.rows.row(row);
  return whole;
}

FaceContact contact_of(const System& system, const ContactPoint& point) {
  const FacePlace& face = point.face.value();
  FaceContact contact;
  const std::array<Eigen::VectorXd*, 5> rows{&contact.plate.w, &contact.plate.w_r,
                                             &contact.plate.w_phi, &contact.plate.w_r_phi,
                                             &contact.plate.w_phi_phi};
  for (std::size_t i = 0; i < rows.size(); ++i)
    *rows[i] = row_of(system, face.body, face.rows[i]);
  const Eigen::VectorXd x = row_of(system, point.slave_body, point.slave_rows.x);
  const Eigen::VectorXd y = row_of(system, point.slave_body, point.slave_rows.y);
  const Eigen::VectorXd z = row_of(system, point.slave_body, point.slave_rows.z);
  contact.pad_phi = std::cos(face.turned) * x - std::sin(face.turned) * z;
  contact.pad_r = std::cos(face.turned) * z + std::sin(face.turned) * x;
  contact.pad_z = face.side * y;
  contact.radius = face.radius;
  contact.half_thickness = face.half_thickness;
  contact.side = face.side;
  return contact;
}

/// Contacts of the system, those of the upper face first, as of DiscModel.
std::vector<FaceContact> contacts_of_faces(const System& system) {
  std::vector<FaceContact> contacts;
  for (const int side : {1, -1}) {
    for (const ContactPoint& point : system.contacts)
      if (point.face.value().side == side) contacts.push_back(contact_of(system, point));
  }
  return contacts;
}

std::vector<std::complex<double>> eigenvalues_of(const LinearSystem& system) {
  std::vector<std::complex<double>> all;
  for (const Eigenvalue& one : dense_eigenvalues(make_pencil(system))) all.push_back(one.s);
  return all;
}

/// Both are sorted by frequency; pairs of equal frequency are told apart by neither.
void expect_same_eigenvalues(const LinearSystem& found, const LinearSystem& expected,
                             double tolerance) {
  const auto a = eigenvalues_of(found);
  const auto b = eigenvalues_of(expected);
  ASSERT_EQ(a.size(), b.size());
  for (const auto& s : b) {
    double nearest = std::numeric_limits<double>::infinity();
    for (const auto& other : a) nearest = std::min(nearest, std::abs(other - s));
    EXPECT_LT(nearest, tolerance * std::abs(s)) << s;
  }
}

/// Coordinates of DiscModel with rigid pads (plate; upper r, φ, n; lower likewise) among those of the
/// scene (disc; lower x, y, z; upper).
Eigen::MatrixXd permutation(Eigen::Index plate) {
  Eigen::MatrixXd P = Eigen::MatrixXd::Zero(plate + 6, plate + 6);
  P.topLeftCorner(plate, plate).setIdentity();
  for (const Eigen::Index pad : {0, 1}) {
    const Eigen::Index from = plate + 3 * pad;     // upper, then lower
    const Eigen::Index to = plate + 3 * (1 - pad);  // lower, then upper
    P(to + 2, from) = 1.0;                          // r is z
    P(to, from + 1) = 1.0;                          // φ is x
    P(to + 1, from + 2) = 1.0;                      // n is y
  }
  return P;
}

/// Matrices differ by rounding of their entries.
void expect_same(const Eigen::MatrixXd& found, const Eigen::MatrixXd& expected, const char* what) {
  ASSERT_EQ(found.rows(), expected.rows()) << what;
  EXPECT_LE((found - expected).cwiseAbs().maxCoeff(), 1e-13 * expected.cwiseAbs().maxCoeff())
      << what;
}

TEST(FaceScenes, RigidPadsAreTheDiscModel) {
  const FaceScene scene = rigid_scene("{law: multiplier, preload: 3000}", 0.3);
  const System& system = scene.model.system;
  const DiscModel model = make_disc_model(damped_brake());
  const LinearSystem bodies = free_bodies_of(system);
  const Eigen::MatrixXd P = permutation(13);
  expect_same(P.transpose() * bodies.mass * P, model.bodies.mass, "mass");
  expect_same(P.transpose() * bodies.velocity * P, model.bodies.velocity, "velocity");
  expect_same(P.transpose() * bodies.position * P, model.bodies.position, "position");
  const std::vector<FaceContact> contacts = contacts_of_faces(system);
  ASSERT_EQ(contacts.size(), model.contacts.size());
  for (std::size_t i = 0; i < contacts.size(); ++i) {
    const FaceContact& a = contacts[i];
    const FaceContact& b = model.contacts[i];
    expect_same(P.transpose() * a.gap(), b.gap(), "n");
    expect_same(P.transpose() * a.friction(), b.friction(), "b");
    expect_same(P.transpose() * a.across(), b.across(), "a");
    expect_same(P.transpose() * a.turning(), b.turning(), "c");
    expect_same(P.transpose() * a.bending_forces() * a.normal_bending() * P,
                b.bending_forces() * b.normal_bending(), "A");
    expect_same(P.transpose() * a.bending_forces() * a.friction_bending() * P,
                b.bending_forces() * b.friction_bending(), "B");
  }
  EXPECT_NEAR(system.bodies[0].lowest_omitted / (2.0 * std::numbers::pi), model.highest_frequency,
              1e-9 * model.highest_frequency);
  expect_same_eigenvalues(
      linearise(bodies, contacts, model.law, prescribed_sliding_state(contacts, model.law, 3000.0)),
      model.system, 1e-9);
}

TEST(FaceScenes, PreloadsAreHeldByLoadsOfTheirOwn) {
  for (const std::string normal :
       {"{law: multiplier, preload: 3000}", "{law: penalty, stiffness: 1.0e+10, preload: 3000}"}) {
    const FaceScene scene = rigid_scene(normal, 0.45);
    const System& system = scene.model.system;
    const std::vector<FaceContact> contacts = contacts_of_faces(system);
    FaceContactLaw law;
    law.friction = 0.45;
    law.speed = 10.0;
    const FaceSlidingState state = prescribed_sliding_state(contacts, law, 3000.0);
    Eigen::VectorXd expected = Eigen::VectorXd::Zero(contacts.front().pad_r.size());
    for (std::size_t i = 0; i < contacts.size(); ++i)
      expected -= 3000.0 * unit_force(contacts[i], law, state.contacts[i]);
    Eigen::VectorXd held = Eigen::VectorXd::Zero(expected.size());
    for (std::size_t b = 0; b < system.bodies.size(); ++b) {
      const Eigen::VectorXd& load = system.bodies[b].held_load;
      held.segment(first_of(system, static_cast<int>(b)), load.size()) = load;
    }
    expect_same(held, expected, "held load");
    const bool is_penalty = system.contacts.front().penalty.has_value();
    for (const ContactPoint& contact : system.contacts)
      EXPECT_DOUBLE_EQ(contact.overlap, is_penalty ? 3e-7 : 0.0);
  }
}

/// Contacts of a system in the order of contacts_of_faces().
std::vector<std::size_t> order_of_faces(const System& system) {
  std::vector<std::size_t> order;
  for (const int side : {1, -1}) {
    for (std::size_t i = 0; i < system.contacts.size(); ++i)
      if (system.contacts[i].face.value().side == side) order.push_back(i);
  }
  return order;
}

TEST(FaceScenes, ElasticPadsUnderPistonsAreTheDiscModel) {
  const std::string text =
      plate_text + elastic_pads +
      contacts_text({"p0", "p1", "p2", "p3", "p4"}, "{law: penalty, stiffness: 5.0e+8}", 0.4);
  DiscModelParameters pressed = elastic_brake();
  pressed.pads.piston.emplace().force = 3000.0;
  DiscModelParameters displaced = elastic_brake();
  displaced.pads.piston.emplace().displacement = 4e-5;
  const auto by_force =
      std::tuple("{load: -3000, load_on: [upper.top, lower.top], ramp: 0}", &pressed);
  const auto by_displacement = std::tuple(
      "{displacement: -40 um, displaces: [upper.backing, lower.backing], ramp: 0}", &displaced);
  for (const auto& [piston, parameters] : {by_force, by_displacement}) {
    const FaceScene scene(text + "drives:\n  piston: " + std::string(piston) + "\n");
    const System& system = scene.model.system;
    const DiscModel expected = make_disc_model(*parameters);
    const LinearSystem bodies = free_bodies_of(system);
    expect_same_eigenvalues(bodies,
                            {expected.bodies.mass, expected.bodies.velocity,
                             expected.bodies.position, bodies.gaps, bodies.forces},
                            1e-9);
    const Equilibrium found = find_equilibrium(system, sliding_state(system, 0.0));
    ASSERT_EQ(found.status, EquilibriumStatus::converged) << found.failure;
    const std::vector<std::size_t> order = order_of_faces(system);
    ASSERT_EQ(order.size(), expected.state.contacts.size());
    for (std::size_t i = 0; i < order.size(); ++i) {
      const FaceContactPoint& point = expected.state.contacts[i];
      const ContactEquilibrium& contact = found.contacts[order[i]];
      EXPECT_EQ(contact.is_closed, point.is_closed);
      EXPECT_NEAR(contact.force, point.force, 1e-6) << piston << " " << i;  // of 1e3 N
    }
    // Newton's method ends at 1e-12 of the largest force.
    const auto eigenvalues = dense_eigenvalues(linearise(system, found));
    for (const auto& s : eigenvalues_of(expected.system)) {
      double nearest = std::numeric_limits<double>::infinity();
      for (const Eigenvalue& one : eigenvalues) nearest = std::min(nearest, std::abs(one.s - s));
      EXPECT_LT(nearest, 1e-8 * std::abs(s)) << piston << " " << s;
    }
  }
}

TEST(FaceScenes, TermsMayBeLeftOut) {
  const std::string text = plate_text + rigid_pads +
                           contacts_text({"block"}, "{law: multiplier, preload: 3000}", 0.3);
  const FaceScene scene(text + "terms: [friction]\n");
  const KeptTerms kept = kept_terms(scene.loaded.scene);
  EXPECT_TRUE(kept.friction);
  EXPECT_FALSE(kept.gyroscopic || kept.geometric || kept.friction_damping ||
               kept.structural_damping);
  ModelParameters parameters = scene.loaded.scene.model;
  for (auto& [name, body] : parameters.substructures)
    body->keep_terms({kept.gyroscopic, kept.structural_damping});
  const Model model = make_model(parameters, {});
  const ReducedBody& disc = model.system.bodies[0].reduced;
  EXPECT_TRUE(disc.coupled.is_empty());
  EXPECT_EQ(disc.damping.beta, 0.0);
  EXPECT_EQ(model.system.contacts.front().face->spin, 10.0);  // friction goes on
  EXPECT_THAT(message_of<ConfigError>([&] { FaceScene(text + "terms: [gyro]\n"); }),
              HasSubstr("there is no term 'gyro', did you mean 'gyroscopic'?"));
}

TEST(FaceScenes, RefusesWhatMeansNothingOnAFace) {
  const auto failure = [](const std::vector<std::string>& sets) {
    return message_of<ConfigError>(
        [&] { rigid_scene("{law: multiplier, preload: 3000}", 0.3, sets); });
  };
  EXPECT_THAT(failure({"contacts.upper.start.radius=0.17"}),
              HasSubstr("contacts.upper.start.radius: must lie between the edges of the plate, "
                        "0.08 and 0.16 m, got 0.17 m"));
  EXPECT_THAT(failure({"contacts.upper.start=0.1"}),
              HasSubstr("contacts.upper.start: must be {radius, angle} on 'disc.top'"));
  EXPECT_THAT(failure({"contacts.upper.sliding=frozen", "contacts.lower.sliding=frozen"}),
              HasSubstr("sliding: `frozen` holds what a drive moves at its place"));
  EXPECT_THAT(failure({"contacts.upper.assumption=subs_a"}),
              HasSubstr("assumption: must be subs_b or film"));
  EXPECT_THAT(failure({"contacts.upper.surface=smooth"}), HasSubstr("surface: is of a curve"));
  EXPECT_THAT(failure({"contacts.upper.master=disc.edge"}),
              HasSubstr("'disc' has no surface 'edge' (it has: bottom, top)"));
  EXPECT_THAT(failure({"contacts.upper.slave=lower.block"}),
              HasSubstr("'lower' is placed already by another contact, elsewhere"));
  EXPECT_THAT(message_of<ConfigError>([&] {
                load_scene(scene_path("beam_on_beam.yaml"), {"contact.start={radius: 1}"});
                const LoadedScene loaded =
                    load_scene(scene_path("beam_on_beam.yaml"), {"contact.start={radius: 1}"});
                make_model(loaded.scene.model, {});
              }),
              HasSubstr("contact.start: must be a length along the master"));
  EXPECT_THAT(message_of<ConfigError>([&] {
                const LoadedScene loaded = load_scene(scene_path("beam_on_beam.yaml"),
                                                      {"contact.normal={preload: 3}"});
                make_model(loaded.scene.model, {});
              }),
              HasSubstr("contact.normal.preload: is of a contact on the face of a plate"));
}

TEST(FaceScenes, PadsStandAroundTheirMiddleAndAboveTheFace) {
  const auto failure = [](const std::string& points, const std::string& slave,
                          const std::vector<std::string>& sets = {}) {
    return message_of<ConfigError>([&] {
      std::string pads = elastic_pads;
      pads.replace(pads.find("points:"), std::string("points:").size(), "points:" + points);
      FaceScene(plate_text + pads + contacts_text({slave}, "{preload: 1}", 0.3), sets);
    });
  };
  EXPECT_THAT(failure("\n      back: {on: top, at: 30 mm}", "back"),
              HasSubstr("'lower' starts inside the plate 'disc.bottom', on average 0.00"));
  EXPECT_THAT(failure("\n      q: {on: bottom, at: 61 mm}", "p0"),
              HasSubstr("points.q.at: 0.061 m lies beyond the surface 'bottom' of 0.06 m"));
  EXPECT_THAT(failure("", "start_face"), HasSubstr("which the first one lies on"));
  const FaceScene scene(plate_text + elastic_pads +
                            contacts_text({"p0", "p4"}, "{preload: 1}", 0.3),
                        {"contacts.upper.start.angle=0.5"});
  std::vector<double> angles;
  for (const ContactPoint& contact : scene.model.system.contacts)
    angles.push_back(contact.face->angle);
  // lower[0], lower[1], upper[0], upper[1]: 30 mm to either side at a radius of 130 mm.
  ASSERT_EQ(angles.size(), 4U);
  const double arc = 30.0 / 130.0;
  EXPECT_NEAR(angles[0], -arc, 1e-14);
  EXPECT_NEAR(angles[1], arc, 1e-14);
  EXPECT_NEAR(angles[2], 0.5 - arc, 1e-14);
  EXPECT_NEAR(angles[3], 0.5 + arc, 1e-14);
}

TEST(FaceScenes, ASectionMayBeANumberOrAList) {
  FaceScene scene(std::string("\n  block:\n    type: lumped\n    directions: [x, z]\n    masses: "
                              "{m: {mass: 2}}\n    springs: {s: {at: m, stiffness: 3 kN/m, "
                              "direction: [0, 0, 2]}}\n"));
  const Eigen::MatrixXd K = scene.model.system.bodies[0].reduced.stiffness;
  EXPECT_EQ(K, Eigen::Vector2d(0.0, 3000.0).asDiagonal().toDenseMatrix());
  // Written as it was read, and read back.
  EXPECT_THAT(scene.loaded.resolved(), HasSubstr("stiffness: 3000\n"));
  const LoadedScene again = load_resolved_scene(scene.loaded.resolved(), "resolved");
  EXPECT_EQ(again.resolved(), scene.loaded.resolved());
}

}  // namespace
}  // namespace stridor
