#include "substructures/bodies/mesh_spin.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <algorithm>
#include <complex>
#include <functional>
#include <numeric>
#include <vector>

#include "core/errors.hpp"
#include "substructures/bodies/annular_plate.hpp"
#include "substructures/elements/spin_matrices.hpp"
#include "substructures/reduction/craig_bampton.hpp"
#include "substructures/reduction/modal_body.hpp"
#include "tests/support/annulus_mesh.hpp"
#include "tests/support/message_of.hpp"

namespace stridor {
namespace {

using test::Annulus;
using test::annulus_body;
using test::message_of;
using testing::HasSubstr;

ElementSection steel() {
  return {ElasticLaw(IsotropicElasticity{2.1e11, 0.3}, PlaneState::none), 7850.0};
}

/// Held at its bore, without centrifugal stress.
MeshBodyParameters clamped_annulus(double speed) {
  MeshBodyParameters body = annulus_body({}, ElementShape::hex20);
  body.supports["hub"].on = {"bore"};
  body.spin = MeshSpinParameters{speed, {}, false};
  return body;
}

/// Lowest modes as the body cache makes them.
ModalBody modes_of(const MeshBodyParameters& parameters, Eigen::Index count) {
  const BodyMatrices body = parameters.make();
  const ReducedBody reduced = make_craig_bampton(body, {}, count, {});
  ModalBody modal = make_modal(reduced);
  modal.damping = parameters.damping;
  if (reduced.spin) {
    add_terms(spin_terms(*reduced.spin, body.spin->speed, parameters.damping).in(modal.shapes),
              modal.coupled);
  }
  return modal;
}

/// Eigenvalues with a frequency, by growing frequency.
std::vector<std::complex<double>> eigenvalues_of(const ModalBody& modal) {
  const Eigen::Index n = modal.size();
  Eigen::MatrixXd position = modal.omega.array().square().matrix().asDiagonal();
  Eigen::MatrixXd velocity = modal.mode_damping(modal.damping.alpha).asDiagonal();
  if (!modal.coupled.is_empty()) {
    velocity = modal.coupled.velocity;
    velocity.diagonal() = modal.mode_damping(modal.damping.alpha);
    position += modal.coupled.position;
  }
  Eigen::MatrixXd first_order = Eigen::MatrixXd::Zero(2 * n, 2 * n);
  first_order.topRightCorner(n, n).setIdentity();
  first_order.bottomLeftCorner(n, n) = -position;
  first_order.bottomRightCorner(n, n) = -velocity;
  std::vector<std::complex<double>> found;
  for (const std::complex<double> value : Eigen::VectorXcd(first_order.eigenvalues()))
    if (value.imag() > 0.0) found.push_back(value);
  std::sort(found.begin(), found.end(),
            [](const auto& a, const auto& b) { return a.imag() < b.imag(); });
  return found;
}

TEST(SpinMatrices, RigidMotionsHaveTheMomentsOfARigidRotor) {
  const Mesh mesh = test::annulus_mesh({0.03, 0.1, 0.06, {2, 12, 2}}, ElementShape::hex20);
  const MeshSections sections = one_section(mesh, steel());
  const MassProperties mass = mass_properties(mesh, sections);
  const SpinMatrices spin = assemble_spin(mesh, sections, {});
  const Eigen::MatrixXd R = rigid_motions(mesh);
  const Eigen::MatrixXd G = R.transpose() * (in_every_direction(spin.gyroscopic, 3) * R);
  const Eigen::MatrixXd S = R.transpose() * (in_every_direction(spin.convected, 3) * R);
  // 2 Ω G is the gyroscopic moment Ω J_z between tilts, and no translation has one.
  const double polar = mass.inertia(2, 2);
  Eigen::MatrixXd expected = Eigen::MatrixXd::Zero(6, 6);
  expected(3, 4) = 0.5 * polar;
  expected(4, 3) = -0.5 * polar;
  EXPECT_LT((G - expected).norm(), 1e-12 * polar);
  // ∂_φ of e_x x r is (0, 0, x), of e_z x r is (−x, −y, 0).
  Eigen::MatrixXd convected = Eigen::MatrixXd::Zero(6, 6);
  convected.diagonal() << 0.0, 0.0, 0.0, 0.5 * polar, 0.5 * polar, polar;
  EXPECT_LT((S - convected).norm(), 1e-12 * polar);
}

TEST(SpinMatrices, TheStressOfTheRotationHoldsARigidRotor) {
  // In all, a free rotor has no stiffness against rigid motions: K_σ balances the convected mass.
  MeshBodyParameters parameters = annulus_body({0.03, 0.1, 0.06, {2, 12, 2}}, ElementShape::hex20);
  parameters.spin = MeshSpinParameters{1.0, {}, true};
  const BodyMatrices body = parameters.make();
  const Mesh& mesh = *parameters.mesh;
  const Eigen::MatrixXd R = rigid_motions(mesh);
  const double polar = mass_properties(mesh, one_section(mesh, steel())).inertia(2, 2);
  const Eigen::MatrixXd left = R.transpose() * (body.spin->position * R);
  EXPECT_LT(left.norm(), 1e-8 * polar);
}

TEST(SpinMatrices, DerivativeAroundIsExactForLinearFields) {
  const Mesh mesh = test::annulus_mesh({}, ElementShape::hex20);
  const SparseMatrix around = derivative_around(mesh, {});
  const Eigen::VectorXd x = mesh.nodes.col(0);
  const Eigen::VectorXd y = mesh.nodes.col(1);
  EXPECT_LT((around * x + y).norm(), 1e-12 * y.norm());
  EXPECT_LT((around * y - x).norm(), 1e-12 * x.norm());
}

TEST(MeshSpin, WavesTurnWithTheBody) {
  // Out of the plane no Coriolis force acts: n nodal diameters have ω ± n Ω.
  constexpr double speed = 40.0;
  constexpr int num_values = 7;  // n = 0, 1, 1, 2, 2, 3, 3
  const std::vector<std::complex<double>> rest = eigenvalues_of(modes_of(clamped_annulus(0.0), 24));
  const std::vector<std::complex<double>> spun =
      eigenvalues_of(modes_of(clamped_annulus(speed), 24));
  AnnularPlateParameters plate{0.08, 0.16, 0.012, {2.1e11, 0.3, 7850.0}, 3, 1, 8};
  const AnnularPlate thin(plate);
  std::vector<std::pair<double, int>> order;  // ω and n of the thin plate
  for (Eigen::Index i = 0; i < num_values; ++i)
    order.emplace_back(thin.omega()(i), static_cast<int>((i + 1) / 2));
  std::sort(order.begin(), order.end());
  for (std::size_t i = 0; i < num_values;) {
    const int n = order[i].second;
    const double omega = rest[i].imag();
    // That of the plate to what so few elements and the shear of so thick a plate leave.
    EXPECT_NEAR(omega, order[i].first, 0.08 * order[i].first);
    if (n == 0) {
      EXPECT_NEAR(spun[i].imag(), omega, 1e-4 * speed) << i;
      ++i;
      continue;
    }
    EXPECT_NEAR(rest[i + 1].imag(), omega, 1e-6 * omega) << n << " nodal diameters";
    EXPECT_NEAR((spun[i + 1].imag() - spun[i].imag()) / (2.0 * speed), n, 0.01 * n);
    EXPECT_NEAR(0.5 * (spun[i + 1].imag() + spun[i].imag()), omega, 2e-3 * speed);
    i += 2;
  }
}

TEST(MeshSpin, TheStressOfTheRotationStiffensAsInTheThinPlate) {
  constexpr double speed = 200.0;
  const Annulus annulus{0.05, 0.15, 0.002, {8, 24, 1}};
  MeshBodyParameters body = annulus_body(annulus, ElementShape::hex20);
  body.supports["hub"].on = {"bore"};
  const auto square_of_umbrella = [&](double spin) {
    body.spin = MeshSpinParameters{spin, {}, true};
    const ModalBody modal = modes_of(body, 12);
    // The third one: at rest the umbrella is just above the pair of one nodal diameter, of which rotation takes
    // one wave below it and the other above that of two nodal diameters.
    const double omega = eigenvalues_of(modal)[2].imag();
    return omega * omega;
  };
  const auto square_of_plate = [](double spin) {
    const double omega =
        AnnularPlate({0.05, 0.15, 0.002, {2.1e11, 0.3, 7850.0}, 0, 1, 8}, spin).omega()(0);
    return omega * omega;
  };
  const double expected = (square_of_plate(speed) - square_of_plate(0.0)) / (speed * speed);
  const double found = (square_of_umbrella(speed) - square_of_umbrella(0.0)) / (speed * speed);
  EXPECT_NEAR(found, expected, 0.02 * expected);
}

TEST(MeshSpin, DampingTurnsWithTheMaterial) {
  // Either wave of a pair decays by β ω²/2: damping that rested would take ω (ω ± n Ω).
  constexpr double speed = 300.0;
  constexpr double beta = 1e-6;
  MeshBodyParameters body = clamped_annulus(speed);
  body.damping.beta = beta;
  body.damping.alpha = 20.0;
  const auto values = eigenvalues_of(modes_of(body, 24));
  const auto rest = eigenvalues_of(modes_of(clamped_annulus(0.0), 24));
  for (std::size_t i = 0; i < 7; ++i) {
    const auto nearest = std::min_element(rest.begin(), rest.begin() + 7, [&](auto a, auto b) {
      // Of a wave of n nodal diameters at ω ± n Ω the one at ω.
      const auto decay = [&](std::complex<double> s) {
        return 0.5 * (body.damping.alpha + beta * s.imag() * s.imag());
      };
      return std::abs(decay(a) + values[i].real()) < std::abs(decay(b) + values[i].real());
    });
    const double omega = nearest->imag();
    EXPECT_NEAR(-values[i].real(), 0.5 * (body.damping.alpha + beta * omega * omega),
                0.005 * 0.5 * beta * omega * omega)
        << i;
  }
  body.keep_terms({true, false});
  EXPECT_TRUE(body.make().spin->around.size() > 0);
  EXPECT_TRUE(make_craig_bampton(body.make(), {}, 4, {}).spin->elastic.size() == 0);
}

TEST(MeshSpin, OneReductionServesAllSpeeds) {
  MeshBodyParameters body = clamped_annulus(1.0);
  const BodyMatrices slow = body.make();
  body.spin->speed = 100.0;
  const BodyMatrices fast = body.make();
  EXPECT_EQ((slow.spin->gyroscopic - fast.spin->gyroscopic).norm(), 0.0);
  EXPECT_EQ((slow.spin->position - fast.spin->position).norm(), 0.0);
  EXPECT_EQ((slow.stiffness - fast.stiffness).norm(), 0.0);
}

TEST(Roundness, FindsHolesAndEccentricity) {
  const Mesh smooth = test::annulus_mesh({0.05, 0.15, 0.01, {2, 24, 1}}, ElementShape::hex20);
  EXPECT_EQ(roundness(smooth, one_section(smooth, steel()), {}).num_sectors, 0);
  const Mesh mesh = test::annulus_mesh({0.05, 0.15, 0.01, {2, 24, 1}}, ElementShape::hex8);
  const MeshSections sections = one_section(mesh, steel());
  // Straight edges make a polygon of it.
  EXPECT_EQ(roundness(mesh, sections, {}).num_sectors, 24);
  EXPECT_LT(roundness(mesh, sections, {}).eccentricity, 1e-12);
  AxisOfRevolution beside;
  beside.point.x() = 0.01;
  const Roundness off = roundness(mesh, sections, beside);
  EXPECT_NEAR(off.eccentricity, 0.01, 1e-9);
  EXPECT_EQ(off.num_sectors, 1);
  // Elements of the inner and of the outer ring are left out.
  const auto holed = [&](std::size_t each_inner, std::size_t each_outer) {
    Mesh left;
    left.nodes = mesh.nodes;
    left.node_labels = mesh.node_labels;
    for (std::size_t e = 0; e < mesh.num_elements(); ++e) {
      const std::size_t sector = e / 2;
      if (sector % (e % 2 == 0 ? each_inner : each_outer) == 0) continue;
      left.add_element(mesh.shapes[e], mesh.nodes_of(e), mesh.element_labels[e]);
    }
    return roundness(left, one_section(left, steel()), {});
  };
  EXPECT_EQ(holed(8, 100).num_sectors, 1);  // the first sector alone has a hole outside
  const Roundness three = holed(8, 8);
  EXPECT_EQ(three.num_sectors, 3);
  EXPECT_TRUE(three.without_sectors().empty());
  // Three and four holes have nothing in common, and it takes both to say so.
  const Roundness both = holed(8, 6);
  EXPECT_EQ(both.num_sectors, 1);
  const std::vector<int> spoiling = both.without_sectors();
  ASSERT_GE(spoiling.size(), 2u);
  EXPECT_LE(std::accumulate(spoiling.begin(), spoiling.end(), 0, std::gcd<int, int>), 2);
  EXPECT_GE(std::accumulate(spoiling.begin(), spoiling.end() - 1, 0, std::gcd<int, int>), 3);
}

TEST(MeshSpin, RefusesWhatIsNotAlikeAroundItsAxis) {
  const auto message = [](const auto& change) {
    MeshBodyParameters body = clamped_annulus(10.0);
    change(body);
    return message_of<ConfigError>([&] { body.make(); });
  };
  using P = MeshBodyParameters;
  EXPECT_THAT(message([](P& body) { body.spin->about.point = {0.02, 0.0, 0.0}; }),
              HasSubstr("0.02 m off the axis"));
  EXPECT_THAT(message([](P& body) { body.spin->about.direction = {1.0, 0.0, 0.0}; }),
              HasSubstr("goes with 2 times the angle"));
  EXPECT_THAT(message([](P& body) { body.supports["hub"].held = {"x", "z"}; }),
              HasSubstr("supports.hub.held"));
  EXPECT_THAT(message([](P& body) { body.guided = MeshGuideParameters{{"rim"}}; }),
              HasSubstr("guided"));
  EXPECT_THAT(message([](P& body) {
                body.springs["bearing"] = {"rim", {}};
                body.springs["bearing"].stiffness.xx = 1e6;
              }),
              HasSubstr("springs.bearing.stiffness"));
  EXPECT_THAT(message([](P& body) {
                MeshBoxParameters box{{0.0, 0.0, -1.0}, {1.0, 1.0, 1.0}};
                body.surfaces["corner"].box = box;
                body.supports["clamp"].on = {"corner"};
              }),
              HasSubstr("supports.clamp.on"));
  EXPECT_THAT(message([](P& body) {
                body.material = {};
                body.material.density = 7850.0;
                body.material.orthotropic =
                    OrthotropicParameters{{2e11, 1e11, 1e11}, {0.3, 0.3, 0.3}, {5e10, 5e10, 5e10}};
              }),
              HasSubstr("is not alike around the axis"));
}

TEST(MeshSpin, AFrozenBodyOfAnyShapeHasTheMatricesOfOneAtRest) {
  using P = MeshBodyParameters;
  // None of these could spin as seen from space.
  for (const auto& change :
       std::vector<std::function<void(P&)>>{[](P& body) {
                                              body.spin->about.point = {0.02, 0.0, 0.0};
                                            },
                                            [](P& body) {
                                              body.supports["hub"].held = {"x", "z"};
                                            },
                                            [](P& body) {
                                              body.springs["bearing"] = {"rim", {}};
                                              body.springs["bearing"].stiffness.xx = 1e6;
                                            }}) {
    P body = clamped_annulus(10.0);
    change(body);
    P rest = body;
    rest.spin.reset();
    EXPECT_THROW(body.make(), ConfigError);
    body.spin->sliding = SpinSliding::frozen;
    const BodyMatrices frozen = body.make();
    const BodyMatrices still = rest.make();
    ASSERT_TRUE(frozen.spin);
    EXPECT_EQ(frozen.spin->speed, 10.0);
    EXPECT_EQ(frozen.spin->point, body.spin->about.axis(Eigen::Matrix2d::Identity()).point);
    EXPECT_EQ(frozen.spin->gyroscopic.size(), 0);
    EXPECT_EQ(frozen.spin->position.size(), 0);
    EXPECT_EQ((frozen.stiffness - still.stiffness).norm(), 0.0);
    EXPECT_EQ((frozen.mass - still.mass).norm(), 0.0);
    std::vector<Problem> problems;
    body.damping.beta = 1e-6;
    for (const auto& check : P::schema().checks) check(&body, problems);
    EXPECT_TRUE(problems.empty());  // its springs rest as it does
  }
  P guided = clamped_annulus(10.0);
  guided.spin->sliding = SpinSliding::frozen;
  guided.guided = MeshGuideParameters{{"rim"}};
  EXPECT_THAT(message_of<ConfigError>([&] { guided.make(); }), HasSubstr("guided"));
}

TEST(MeshSpin, DampingOfTheBodyDoesNotTurnItsSprings) {
  MeshBodyParameters body = clamped_annulus(10.0);
  body.springs["bearing"] = {"rim", {}};
  body.springs["bearing"].stiffness.xx = body.springs["bearing"].stiffness.yy = 1e6;
  body.damping.beta = 1e-6;
  std::vector<Problem> problems;
  for (const auto& check : MeshBodyParameters::schema().checks) check(&body, problems);
  ASSERT_EQ(problems.size(), 1u);
  EXPECT_EQ(problems[0].key, "damping.beta");
}

TEST(Roundness, WeighsStiffnessBesidesMass) {
  const Mesh mesh = test::annulus_mesh({}, ElementShape::hex20);
  MeshSections sections = one_section(mesh, steel());
  ElementSection soft = steel();
  soft.law = ElasticLaw(IsotropicElasticity{1e11, 0.3}, PlaneState::none);
  sections.sections.push_back(soft);
  for (std::size_t e = 0; e < mesh.num_elements() / 2; ++e) sections.of_element[e] = 1;
  EXPECT_EQ(roundness(mesh, sections, {}).num_sectors, 1);
}

TEST(Roundness, TakesTetrahedraOfADiscForOne) {
  const Mesh mesh = test::annulus_mesh({0.03, 0.16, 0.02, {4, 48, 1}}, ElementShape::tet10);
  EXPECT_EQ(roundness(mesh, one_section(mesh, steel()), {}).num_sectors, 0);
}

TEST(MeshSpin, MaterialAxesAroundTheAxisAreAlike) {
  MeshBodyParameters body = clamped_annulus(10.0);
  body.material = {};
  body.material.density = 7850.0;
  body.material.orthotropic =
      OrthotropicParameters{{2e11, 1e11, 1e11}, {0.3, 0.3, 0.3}, {5e10, 5e10, 5e10}};
  body.material.axes = MaterialAxesParameters{};
  body.material.axes->around = AxisParameters{};
  EXPECT_NO_THROW(body.make());
}

}  // namespace
}  // namespace stridor
