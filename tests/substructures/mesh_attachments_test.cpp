#include "substructures/bodies/mesh_attachments.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <cmath>
#include <complex>
#include <numbers>
#include <numeric>

#include "core/errors.hpp"
#include "substructures/bodies/annular_plate.hpp"
#include "substructures/bodies/mesh_body.hpp"
#include "substructures/bodies/mesh_constraints.hpp"
#include "substructures/elements/assembly.hpp"
#include "substructures/elements/mesh_surfaces.hpp"
#include "substructures/reduction/craig_bampton.hpp"
#include "substructures/reduction/modal_body.hpp"
#include "tests/support/element_meshes.hpp"
#include "tests/support/full_model.hpp"
#include "tests/support/message_of.hpp"

namespace stridor {
namespace {

using test::message_of;
using testing::HasSubstr;

Mesh grid(const std::array<int, 3>& cells, const Eigen::Vector3d& size, ElementShape shape) {
  const ElementShape linear = test::linear_shape(shape);
  Mesh mesh = test::linear_grid(
      cells, size, facts_of(shape).dimension == 2, [&](int, int, int) { return linear; },
      [](int, int, int) { return true; });
  if (test::is_quadratic(shape)) mesh = test::with_middles(mesh);
  mesh.node_labels.resize(mesh.num_nodes());
  std::iota(mesh.node_labels.begin(), mesh.node_labels.end(), 1);
  return mesh;
}

/// Both meshes side by side, with element sets "lower" and "upper".
Mesh joined(const Mesh& lower, const Mesh& upper) {
  Mesh mesh = lower;
  mesh.nodes.conservativeResize(lower.nodes.rows() + upper.nodes.rows(), 3);
  mesh.nodes.bottomRows(upper.nodes.rows()) = upper.nodes;
  for (std::size_t e = 0; e < upper.num_elements(); ++e) {
    std::vector<int> nodes(upper.nodes_of(e).begin(), upper.nodes_of(e).end());
    for (int& node : nodes) node += static_cast<int>(lower.num_nodes());
    mesh.add_element(upper.shapes[e], nodes, static_cast<std::int64_t>(mesh.num_elements()) + 1);
  }
  for (int e = 0; e < static_cast<int>(mesh.num_elements()); ++e)
    mesh.element_sets[e < static_cast<int>(lower.num_elements()) ? "lower" : "upper"].push_back(e);
  mesh.node_labels.resize(mesh.num_nodes());
  std::iota(mesh.node_labels.begin(), mesh.node_labels.end(), 1);
  return mesh;
}

/// Sides of a set of elements in a plane n·x = offset.
std::vector<ElementSide> sides_at(const Mesh& mesh, const std::string& set,
                                  const Eigen::Vector3d& n, double offset) {
  MeshRegion region;
  region.plane = MeshRegion::Plane{n, offset};
  std::vector<ElementSide> sides;
  for (const ElementSide& side : sides_within(mesh, stridor::outer_sides(mesh), region, 0.02)) {
    const auto& elements = mesh.element_sets.at(set);
    if (std::binary_search(elements.begin(), elements.end(), side.element)) sides.push_back(side);
  }
  return sides;
}

/// A block on a block of half as many elements along every direction, tied on the plane between.
MeshBodyParameters tied_blocks(ElementShape shape) {
  const bool is_planar = facts_of(shape).dimension == 2;
  const Eigen::Vector3d across = is_planar ? Eigen::Vector3d::UnitY() : Eigen::Vector3d::UnitZ();
  const Eigen::Vector3d size{2.0, 1.0, 0.8};
  const Mesh lower = grid({2, 1, 1}, size, shape);
  Mesh upper = grid({4, 2, 2}, size, shape);
  const double height = across.dot(size);
  upper.nodes.rowwise() += height * across.transpose();
  Mesh mesh = joined(lower, upper);
  mesh.surfaces["slave"] = sides_at(mesh, "upper", across, height);
  mesh.surfaces["master"] = sides_at(mesh, "lower", across, height);
  MeshBodyParameters body;
  if (is_planar) body.thickness = 0.3;
  body.material = {2e11, 0.3, 7800.0};
  body.ties["seam"] = {"slave", "master", {}, false};
  body.mesh = std::make_shared<const Mesh>(mesh);
  return body;
}

/// DoFs of a field of displacements that the constraints can have.
Eigen::VectorXd dofs_of(const BodyMatrices& body, const Mesh& mesh,
                        const Eigen::Matrix3d& gradient) {
  Eigen::VectorXd q = Eigen::VectorXd::Zero(body.num_dofs());
  for (int node = 0; node < static_cast<int>(mesh.num_nodes()); ++node) {
    const Eigen::Vector3d u = gradient * mesh.nodes.row(node).transpose();
    for (std::size_t i = 0; i < 3; ++i) {
      const DofSum sum = body.displacement(node, i);
      if (sum.size() == 1 && sum.front().weight == 1.0)
        q(sum.front().dof) = u(static_cast<Eigen::Index>(i));
    }
  }
  return q;
}

// A linear field is in equilibrium at every node that is not on the outside, those of the seam
// included: the finer faces divide the coarser ones, so that forces pass exactly.
TEST(MeshTie, PassesThePatchTestWhereTheSlaveDividesTheMaster) {
  for (const ElementShape shape :
       {ElementShape::quad4, ElementShape::quad8, ElementShape::hex8, ElementShape::hex20}) {
    const MeshBodyParameters parameters = tied_blocks(shape);
    const BodyMatrices body = parameters.make();
    const Mesh& mesh = *parameters.mesh;
    const bool is_planar = facts_of(shape).dimension == 2;
    Eigen::Matrix3d gradient;
    gradient << 1.0, 0.4, 0.2, -0.3, 0.7, 0.5, 0.6, -0.2, -0.9;
    gradient *= 1e-3;
    if (is_planar) gradient.row(2).setZero(), gradient.col(2).setZero();
    const Eigen::VectorXd q = dofs_of(body, mesh, gradient);
    // Tied nodes take part in the field by themselves.
    for (const int node : nodes_of(mesh, mesh.surfaces.at("slave"))) {
      const Eigen::Vector3d u = gradient * mesh.nodes.row(node).transpose();
      for (std::size_t i = 0; i < (is_planar ? 2u : 3u); ++i) {
        double found = 0.0;
        for (const DofWeight& dof : body.displacement(node, i)) found += dof.weight * q(dof.dof);
        EXPECT_NEAR(found, u(static_cast<Eigen::Index>(i)), 1e-15);
      }
    }
    const Eigen::VectorXd force = body.stiffness * q;
    std::vector<bool> is_outside(mesh.num_nodes(), false);
    for (const ElementSide& side : stridor::outer_sides(mesh)) {
      const auto& seam = mesh.surfaces;
      const auto in = [&](const char* name) {
        return std::binary_search(seam.at(name).begin(), seam.at(name).end(), side);
      };
      if (in("slave") || in("master")) continue;
      for (const int node : nodes_of(mesh, side)) is_outside[static_cast<std::size_t>(node)] = true;
    }
    int num_inside = 0;
    for (int node = 0; node < static_cast<int>(mesh.num_nodes()); ++node) {
      if (is_outside[static_cast<std::size_t>(node)] || body.dependent.contains(node)) continue;
      for (std::size_t i = 0; i < (is_planar ? 2u : 3u); ++i) {
        EXPECT_NEAR(force(body.displacement(node, i).front().dof), 0.0,
                    1e-12 * force.cwiseAbs().maxCoeff())
            << facts_of(shape).name << ", node " << node;
        ++num_inside;
      }
    }
    EXPECT_GT(num_inside, 0);
  }
}

// Nodes off the faces are moved onto them, so that no rotation strains the seam.
TEST(MeshTie, LeavesRigidMotionsWithoutForce) {
  MeshBodyParameters parameters = tied_blocks(ElementShape::hex8);
  Mesh mesh = *parameters.mesh;
  const auto slaves = nodes_of(mesh, mesh.surfaces.at("slave"));
  mesh.nodes(slaves[3], 2) += 0.01;
  mesh.nodes(slaves[5], 2) -= 0.01;
  parameters.mesh = std::make_shared<const Mesh>(mesh);
  const BodyMatrices body = parameters.make();
  EXPECT_EQ(body.kept.size(), 6u);
  const Eigen::VectorXd squares =
      test::dense_spectrum(Eigen::MatrixXd(body.stiffness), Eigen::MatrixXd(body.mass));
  EXPECT_LE(squares.head(6).cwiseAbs().maxCoeff(), 1e-11 * squares(squares.size() - 1));
  EXPECT_GT(squares(6), 1e-6 * squares(squares.size() - 1));
}

TEST(MeshTie, RefusesWhatDoesNotMeet) {
  MeshBodyParameters body = tied_blocks(ElementShape::quad4);
  Mesh apart = *body.mesh;
  for (const int node : nodes_of(apart, apart.surfaces.at("slave"))) apart.nodes(node, 1) += 0.3;
  body.mesh = std::make_shared<const Mesh>(apart);
  EXPECT_THAT(message_of<ConfigError>([&] { body.make(); }), HasSubstr("ties.seam: node"));
  body.ties["seam"].partial = true;
  EXPECT_THAT(message_of<ConfigError>([&] { body.make(); }), HasSubstr("ties.seam: ties nothing"));
  body = tied_blocks(ElementShape::quad4);
  body.ties["back"] = {"master", "slave", {}, false};
  EXPECT_THAT(message_of<ConfigError>([&] { body.make(); }),
              HasSubstr("is a master and a slave; let one side lead"));
  body = tied_blocks(ElementShape::quad4);
  body.ties["seam"].master = "mister";
  EXPECT_THAT(message_of<ConfigError>([&] { body.make(); }),
              HasSubstr("ties.seam.master: there is no surface 'mister', did you mean 'master'?"));
}

/// A block in space, held nowhere.
MeshBodyParameters block() {
  MeshBodyParameters body;
  body.material = {2e11, 0.3, 7800.0};
  Mesh mesh = grid({3, 2, 2}, {0.3, 0.1, 0.05}, ElementShape::hex20);
  mesh.node_sets["all"].resize(mesh.num_nodes());
  std::iota(mesh.node_sets["all"].begin(), mesh.node_sets["all"].end(), 0);
  body.mesh = std::make_shared<const Mesh>(mesh);
  body.surfaces["end"].plane = MeshPlaneParameters{{1, 0, 0}, 0.3};
  body.surfaces["root"].plane = MeshPlaneParameters{{1, 0, 0}, 0.0};
  return body;
}

// All of a block in one region: its mass is that of the rigid body, and no stiffness is left.
TEST(RigidRegion, OfAWholeBodyHasItsInertia) {
  MeshBodyParameters parameters = block();
  parameters.rigid_regions["hub"] = {{"all"}, {0.15, 0.05, 0.025}};
  parameters.masses["sensor"] = {"hub", 0.5, {1e-3, 2e-3, 3e-3}};
  const BodyMatrices body = parameters.make();
  ASSERT_EQ(body.num_dofs(), 6);
  const double mass = 7800.0 * 0.3 * 0.1 * 0.05;
  Eigen::VectorXd expected(6);
  expected << mass + 0.5, mass + 0.5, mass + 0.5, mass / 12.0 * (0.1 * 0.1 + 0.05 * 0.05) + 1e-3,
      mass / 12.0 * (0.3 * 0.3 + 0.05 * 0.05) + 2e-3, mass / 12.0 * (0.3 * 0.3 + 0.1 * 0.1) + 3e-3;
  EXPECT_LE((Eigen::MatrixXd(body.mass) - Eigen::MatrixXd(expected.asDiagonal())).norm(),
            1e-12 * expected.norm());
  EXPECT_LE(Eigen::MatrixXd(body.stiffness).norm(), 1e-9 * 2e11 * 0.3);
  EXPECT_EQ(body.displacement(body.points.at("hub"), 1).front().dof, 1);
  EXPECT_EQ(body.displacement(body.points.at("hub_rotation"), 2).front().dof, 5);
  // Its motions are those of a support, too.
  parameters.supports["bearing"] = {{"hub"}, {"x", "y", "z", "rx", "ry"}};
  EXPECT_EQ(parameters.make().num_dofs(), 1);
}

// A cantilever with a moment at its rigid end: θ = M L/(E I); ν = 0, so that the root is no matter.
TEST(RigidRegion, TakesMomentsAtItsRotation) {
  MeshBodyParameters parameters = block();
  parameters.material = {2e11, 0.0, 7800.0};
  parameters.supports["root"] = {{"root"}, {}};
  parameters.rigid_regions["tip"] = {{"end"}, {}};
  const BodyMatrices body = parameters.make();
  const int rotation = body.displacement(body.points.at("tip_rotation"), 2).front().dof;
  Eigen::VectorXd load = Eigen::VectorXd::Zero(body.num_dofs());
  load(rotation) = 10.0;
  const Eigen::VectorXd answer = Eigen::MatrixXd(body.stiffness).ldlt().solve(load);
  const double inertia = 0.05 * std::pow(0.1, 3) / 12.0;
  EXPECT_NEAR(answer(rotation), 10.0 * 0.3 / (2e11 * inertia), 1e-9 * answer(rotation));
  EXPECT_TRUE(body.kept.empty());
}

// A turn by a small angle about an axis off the surface is what the mean rotation is.
TEST(MeanRotation, OfARigidMotionIsItsAngle) {
  MeshBodyParameters parameters = block();
  parameters.points["face"].mean_of = "end";
  parameters.points["face"].rotation = true;
  const BodyMatrices body = parameters.make();
  const Eigen::Vector3d angle{0.3, -0.2, 0.5};
  Eigen::VectorXd q = Eigen::VectorXd::Zero(body.num_dofs());
  for (int node = 0; node < static_cast<int>(parameters.mesh->num_nodes()); ++node) {
    const Eigen::Vector3d u =
        angle.cross(parameters.mesh->nodes.row(node).transpose() - Eigen::Vector3d(0.1, 0.7, -0.2));
    for (std::size_t i = 0; i < 3; ++i)
      q(body.displacement(node, i).front().dof) = u(static_cast<Eigen::Index>(i));
  }
  for (std::size_t i = 0; i < 3; ++i) {
    double found = 0.0;
    for (const DofWeight& dof : body.displacement(body.points.at("face_rotation"), i))
      found += dof.weight * q(dof.dof);
    EXPECT_NEAR(found, angle(static_cast<Eigen::Index>(i)), 1e-12);
  }
}

/// A sector of a ring from radius 1 to 2, from 20° to 80°, as quad8; "inner" is its bore, "first"
/// and "last" its cuts.
MeshBodyParameters ring_sector(int along, int across) {
  Mesh mesh = grid({across, along, 1}, {1.0, 1.0, 1.0}, ElementShape::quad8);
  for (Eigen::Index node = 0; node < mesh.nodes.rows(); ++node) {
    const double radius = 1.0 + mesh.nodes(node, 0);
    const double angle = std::numbers::pi / 9.0 + std::numbers::pi / 3.0 * mesh.nodes(node, 1);
    mesh.nodes.row(node) << radius * std::cos(angle), radius * std::sin(angle), 0.0;
  }
  MeshBodyParameters body;
  body.thickness = 0.1;
  body.material = {2e11, 0.3, 7800.0};
  body.mesh = std::make_shared<const Mesh>(mesh);
  body.surfaces["inner"].cylinder = MeshCylinderParameters{{}, {}, 1.0};
  for (const auto& [name, degrees] : {std::pair("first", 20.0), std::pair("last", 80.0)}) {
    const double angle = degrees * std::numbers::pi / 180.0;
    body.surfaces[name].plane = MeshPlaneParameters{{-std::sin(angle), std::cos(angle)}, 0.0};
  }
  body.supports["cuts"] = {{"first", "last"}, {"tangential"}};
  body.loads["pressure"] = {{"inner"}, {}};
  return body;
}

/// Mean radial displacement of the bore under a pressure.
double bore_opening(const MeshBodyParameters& parameters, double pressure) {
  const BodyMatrices body = parameters.make();
  Eigen::VectorXd load = Eigen::VectorXd::Zero(body.num_dofs());
  // A load of 1 N is spread over the area.
  const double area = *parameters.thickness * std::numbers::pi / 3.0;
  for (const DofWeight& dof : body.loads.at("pressure"))
    load(dof.dof) = pressure * area * dof.weight;
  const Eigen::VectorXd q = Eigen::MatrixXd(body.stiffness).ldlt().solve(load);
  double sum = 0.0;
  int count = 0;
  for (int node = 0; node < static_cast<int>(parameters.mesh->num_nodes()); ++node) {
    const Eigen::Vector2d place = body.nodes.row(node).head<2>().transpose();
    if (std::abs(place.norm() - 1.0) > 1e-9) continue;
    for (std::size_t i = 0; i < 2; ++i)
      for (const DofWeight& dof : body.displacement(node, i))
        sum += dof.weight * q(dof.dof) * place(static_cast<Eigen::Index>(i));
    ++count;
  }
  return sum / count;
}

// Lamé, plane strain: u = (1 + ν)/E p a²/(b² − a²) ((1 − 2ν) r + b²/r). Quadratic elements of a
// sixth of the thickness have an error of the fourth power of that, about 1e-4.
TEST(CylindricalSupport, AndPressureAreThoseOfLame) {
  MeshBodyParameters ring = ring_sector(8, 6);
  ring.plane = PlaneState::strain;
  const double expected = 1.3 / 2e11 * 1e6 / 3.0 * (0.4 + 4.0);
  EXPECT_NEAR(bore_opening(ring, 1e6), expected, 3e-4 * expected);
  // The body may be turned as it likes.
  ring.angle = 0.7;
  EXPECT_NEAR(bore_opening(ring, 1e6), expected, 3e-4 * expected);
}

// Lekhnitskii, plane stress: stresses σ_r, σ_θ ~ r^(±k − 1) with k² = E_θ/E_r.
TEST(CylindricalAxes, OfAnOrthotropicRingAreThoseOfLekhnitskii) {
  MeshBodyParameters ring = ring_sector(8, 6);
  constexpr double radial = 10e9;
  constexpr double hoop = 40e9;
  constexpr double nu = 0.1;  // ν_rθ
  ring.material = {};
  ring.material.density = 1600.0;
  ring.material.orthotropic =
      OrthotropicParameters{{radial, hoop, 12e9}, {nu, 0.2, 0.15}, {4e9, 3e9, 5e9}};
  ring.material.axes.emplace().around.emplace();
  const double k = std::sqrt(hoop / radial);
  const double outer = std::pow(2.0, 2.0 * k);
  const double pressure = 1e5;
  const double hoop_stress = k * pressure / (outer - 1.0) * (1.0 + outer);
  const double expected = hoop_stress / hoop + nu / radial * pressure;
  EXPECT_NEAR(bore_opening(ring, pressure), expected, 2e-3 * expected);
  ring.angle = -0.4;
  EXPECT_NEAR(bore_opening(ring, pressure), expected, 2e-3 * expected);
}

TEST(MaterialAxes, ByAngleAndByVectorsAreTheSame) {
  MeshMaterialParameters material;
  material.density = 1.0;
  material.orthotropic = OrthotropicParameters{{4e9, 2e9, 1e9}, {0.3, 0.2, 0.1}, {1e9, 2e9, 3e9}};
  material.axes.emplace().angle = 0.5;
  const Eigen::Matrix2d turn = Eigen::Rotation2Dd(0.2).toRotationMatrix();
  const auto by_angle = material.section(PlaneState::none, turn, 1.0).law.matrix();
  material.axes = MaterialAxesParameters{};
  material.axes->first = {2.0 * std::cos(0.5), 2.0 * std::sin(0.5), 0.0};
  material.axes->second = {0.0, 1.0, 0.0};
  const auto by_vectors = material.section(PlaneState::none, turn, 1.0).law.matrix();
  EXPECT_LE((by_angle - by_vectors).norm(), 1e-12 * by_angle.norm());
  const ElasticLaw turned(OrthotropicElasticity{{4e9, 2e9, 1e9}, {0.3, 0.2, 0.1}, {1e9, 2e9, 3e9}},
                          PlaneState::none,
                          Eigen::AngleAxisd(0.7, Eigen::Vector3d::UnitZ()).toRotationMatrix());
  EXPECT_LE((by_angle - turned.matrix()).norm(), 1e-12 * by_angle.norm());
}

// Damping of both halves together is that of the body; of one half it is its share alone.
TEST(MaterialDamping, IsThatOfItsElements) {
  MeshBodyParameters parameters = tied_blocks(ElementShape::quad4);
  parameters.materials["upper"] = parameters.material;
  parameters.materials["upper"].damping = MaterialDampingParameters{3.0, 2e-6};
  const BodyMatrices half = parameters.make();
  parameters.material.damping = MaterialDampingParameters{3.0, 2e-6};
  const BodyMatrices whole = parameters.make();
  const SparseMatrix rest = whole.velocity - 3.0 * whole.mass - 2e-6 * whole.stiffness;
  EXPECT_LE(rest.norm(), 1e-13 * whole.velocity.norm());
  EXPECT_EQ(whole.circulatory.nonZeros(), 0);
  parameters.materials["upper"].damping.reset();
  const SparseMatrix other = parameters.make().velocity;
  const SparseMatrix sum = half.velocity + other - whole.velocity;
  EXPECT_LE(sum.norm(), 1e-13 * whole.velocity.norm());
  EXPECT_GT(half.velocity.norm(), 0.1 * whole.velocity.norm());
}

// A loss factor of all of a body gives every mode c = η ω and couples none, whatever is kept of it.
TEST(LossFactor, OfAWholeBodyDampsEveryModeAlike) {
  MeshBodyParameters parameters = block();
  parameters.supports["root"] = {{"root"}, {}};
  parameters.material.loss_factor = 0.02;
  const BodyMatrices body = parameters.make();
  const ModalBody modal = make_modal(make_craig_bampton(body, {}, 12, {}));
  const Eigen::MatrixXd expected = 0.02 * Eigen::MatrixXd(modal.omega.asDiagonal());
  EXPECT_LE((modal.coupled.velocity - expected).norm(), 1e-8 * expected.norm());
  EXPECT_TRUE(modal.coupled.position.isZero(0.0));
}

// To first order in η the complex stiffness has s = iω (1 + iη/2) with η = φᵀ(Σ η K)φ/ω²: the
// modes of a half-damped body, from the complex eigenvalues of the full matrices.
TEST(LossFactor, OfAPartGivesTheDampingOfTheComplexStiffness) {
  MeshBodyParameters parameters = tied_blocks(ElementShape::quad8);
  parameters.surfaces["floor"].plane = MeshPlaneParameters{{0, 1}, 0.0};
  parameters.supports["floor"] = {{"floor"}, {}};
  parameters.materials["upper"] = parameters.material;
  constexpr double loss = 1e-3;
  parameters.materials["upper"].loss_factor = loss;
  const BodyMatrices body = parameters.make();
  const ModalBody modal = make_modal(make_craig_bampton(body, {}, 6, {}));
  Eigen::MatrixXcd complex = Eigen::MatrixXd(body.stiffness).cast<std::complex<double>>();
  complex.imag() = Eigen::MatrixXd(body.loss_stiffness);
  const Eigen::MatrixXcd pencil =
      Eigen::MatrixXd(body.mass)
          .llt()
          .solve(Eigen::MatrixXd::Identity(body.num_dofs(), body.num_dofs()))
          .cast<std::complex<double>>() *
      complex;
  Eigen::VectorXcd squares =
      Eigen::ComplexEigenSolver<Eigen::MatrixXcd>(pencil, false).eigenvalues();
  std::sort(squares.begin(), squares.end(),
            [](const auto& a, const auto& b) { return a.real() < b.real(); });
  for (Eigen::Index mode = 0; mode < 6; ++mode) {
    const double growth = (std::complex<double>(0.0, 1.0) * std::sqrt(squares(mode))).real();
    // The second order: loss squared.
    EXPECT_NEAR(-0.5 * modal.coupled.velocity(mode, mode), growth, 10.0 * loss * std::abs(growth));
    EXPECT_LT(growth, 0.0);
  }
}

TEST(MeshBody, DampersAndLoadsActWhereTheyAre) {
  MeshBodyParameters parameters = block();
  parameters.points["tip"].at = {0.3, 0.1, 0.05};
  parameters.springs["strut"].on = "tip";
  parameters.springs["strut"].stiffness.yy = 1e4;
  parameters.springs["strut"].damping.emplace().yy = 70.0;
  parameters.loads["pull"] = {{"end"}, {0.0, 0.0, 2.0}};
  const BodyMatrices body = parameters.make();
  const int dof = body.displacement(body.points.at("tip"), 1).front().dof;
  EXPECT_EQ(body.velocity.nonZeros(), 1);
  EXPECT_EQ(body.velocity.coeff(dof, dof), 70.0);
  double sum = 0.0;
  for (const DofWeight& weight : body.loads.at("pull")) sum += weight.weight;
  EXPECT_NEAR(sum, 1.0, 1e-12);
  EXPECT_THAT(message_of<ConfigError>([&] {
                parameters.loads["pull"].on = {"ends"};
                parameters.make();
              }),
              HasSubstr("loads.pull.on: there is no surface 'ends', did you mean 'end'?"));
}

TEST(MeshBody, AttachmentsThatDoNotFitAreRefusedWithTheirKeys) {
  const auto refusal = [](const auto& change) {
    MeshBodyParameters body = block();
    change(body);
    return message_of<ConfigError>([&] { body.make(); });
  };
  EXPECT_THAT(refusal([](auto& b) {
                b.rigid_regions["a"] = {{"end"}, {}};
                b.rigid_regions["b"] = {{"all"}, {}};
              }),
              HasSubstr("rigid_regions.b.on: node"));
  EXPECT_THAT(refusal([](auto& b) {
                b.rigid_regions["a"] = {{"end"}, {}};
                b.supports["s"] = {{"all"}, {"x"}};
              }),
              HasSubstr("is in the rigid region 'a'; hold 'a' itself"));
  EXPECT_THAT(refusal([](auto& b) {
                b.supports["s"] = {{"end"}, {"rx"}};
              }),
              HasSubstr("supports.s.held: 'end' is no rigid region, so that it has no rotations"));
  EXPECT_THAT(refusal([](auto& b) {
                b.supports["s"] = {{"root"}, {"radial"}};
              }),
              HasSubstr("is on the line, where nothing is radial"));
  EXPECT_THAT(refusal([](auto& b) {
                b.masses["m"] = {"tip", 1.0, {}};
              }),
              HasSubstr("masses.m.on: there is no point or rigid region 'tip'"));
  EXPECT_THAT(refusal([](auto& b) {
                b.points["tip"].at = {0.3, 0.1, 0.05};
                b.masses["m"] = {"tip", 1.0, {1.0, 1.0, 1.0}};
              }),
              HasSubstr("masses.m.inertia: is of a rigid region; 'tip' is a point"));
  EXPECT_THAT(refusal([](auto& b) {
                b.material = {};
                b.material.density = 1.0;
                b.material.orthotropic =
                    OrthotropicParameters{{1e9, 1e9, 1e9}, {0.9, 0.9, 0.9}, {1e9, 1e9, 1e9}};
              }),
              HasSubstr("material.orthotropic: is not positive definite"));
}

// A free body is reduced by itself: six DoFs stay, and its lowest frequencies are those of the
// whole to the error of the truncation.
TEST(MeshBody, ThatIsFreeCanBeReduced) {
  const BodyMatrices body = block().make();
  ASSERT_EQ(body.kept.size(), 6u);
  const ModalBody modal = make_modal(make_craig_bampton(body, body.kept, 40, {}));
  const Eigen::VectorXd squares =
      test::dense_spectrum(Eigen::MatrixXd(body.stiffness), Eigen::MatrixXd(body.mass));
  EXPECT_EQ((modal.omega.array() == 0.0).count(), 6);
  for (Eigen::Index mode = 6; mode < 16; ++mode)
    EXPECT_NEAR(modal.omega(mode), std::sqrt(squares(mode)), 1e-3 * modal.omega(mode));
}

// A sixth of a disc whose cuts are planes of symmetry has the modes of 0, 3, 6 ... diameters of the
// whole one. A thin plate leaves out shear and rotary inertia, some (h/(b − a))² = 4e-4 of them;
// the elements, ten to a half wave, add less than 1 %.
TEST(MeshBody, SectorOfADiscHasTheFrequenciesOfAnAnnularPlate) {
  constexpr double thickness = 0.02;
  Mesh mesh = grid({16, 10, 1}, {1.0, 1.0, thickness}, ElementShape::hex20);
  for (Eigen::Index node = 0; node < mesh.nodes.rows(); ++node) {
    const double radius = 1.0 + mesh.nodes(node, 0);
    const double angle = std::numbers::pi / 3.0 * mesh.nodes(node, 1);
    mesh.nodes.row(node).head<2>() << radius * std::cos(angle), radius * std::sin(angle);
  }
  MeshBodyParameters body;
  body.material = {2e11, 0.3, 7800.0};
  body.mesh = std::make_shared<const Mesh>(mesh);
  body.surfaces["hub"].cylinder = MeshCylinderParameters{{}, {}, 1.0};
  body.surfaces["first"].plane = MeshPlaneParameters{{0, 1, 0}, 0.0};
  body.surfaces["last"].plane = MeshPlaneParameters{{-std::sqrt(0.75), 0.5, 0.0}, 0.0};
  body.supports["clamp"] = {{"hub"}, {}};
  body.supports["symmetry"] = {{"first", "last"}, {"tangential"}};
  const ModalBody modal = make_modal(make_craig_bampton(body.make(), {}, 3, {}));
  const AnnularPlate plate(
      AnnularPlateParameters{1.0, 2.0, thickness, {2e11, 0.3, 7800.0}, 3, 1, 8});
  EXPECT_NEAR(modal.omega(0), plate.omega()(0), 1e-2 * plate.omega()(0));
  EXPECT_NEAR(modal.omega(1), plate.omega()(5), 1e-2 * plate.omega()(5));
}

}  // namespace
}  // namespace stridor
