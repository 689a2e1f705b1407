#include "substructures/bodies/mesh_spin.hpp"

#include <fmt/format.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <complex>
#include <map>
#include <span>
#include <utility>
#include <vector>

#include "core/errors.hpp"
#include "substructures/bodies/mesh_constraints.hpp"
#include "substructures/bodies/named_mesh.hpp"
#include "substructures/elements/mesh_surfaces.hpp"
#include "substructures/elements/spin_matrices.hpp"
#include "substructures/matrices/sparse_cholesky.hpp"

namespace stridor {
namespace {

/// D of elasticity in axes turned by R.
Eigen::MatrixXd turned_law(const Eigen::MatrixXd& law, const Eigen::Matrix3d& R) {
  constexpr std::array<std::pair<int, int>, 6> pairs{
      {{0, 0}, {1, 1}, {2, 2}, {0, 1}, {1, 2}, {2, 0}}};
  // Stress turns as σ' = R σ Rᵀ; T is that on xx, yy, zz, xy, yz, zx, and D' = T D Tᵀ.
  Eigen::MatrixXd T(6, 6);
  for (int row = 0; row < 6; ++row) {
    for (int column = 0; column < 6; ++column) {
      const auto [i, j] = pairs[static_cast<std::size_t>(row)];
      const auto [k, l] = pairs[static_cast<std::size_t>(column)];
      T(row, column) = R(i, k) * R(j, l);
      if (k != l) T(row, column) += R(i, l) * R(j, k);
    }
  }
  return T * law * T.transpose();
}

class MeshSpin {
 public:
  MeshSpin(const MeshBodyParameters& parameters, const NamedMesh& named,
           const MeshConstraints& constraints)
      : parameters_(parameters),
        named_(named),
        constraints_(constraints),
        keys_(*parameters.spin),
        axis_(keys_.about.axis(named.turn)),
        sections_(named.sections()) {}

  void check() const {
    if (named_.dimension != 3)
      throw ConfigError(Refusal::not_of_revolution, "spin",
                        "is of a body with volumes; a planar mesh does not spin");
    refuse_guide();
    if (is_frozen()) return;
    check_shape();
    check_materials();
    refuse_attachments();
    for (const auto& [name, support] : parameters_.supports) check_support(name, support);
    for (const auto& [name, spring] : parameters_.springs) check_spring(name, spring);
  }

  SpinTerms make(const BodyMatrices& body) const {
    SpinTerms spin;
    spin.speed = keys_.speed;
    spin.direction = axis_.direction;
    spin.point = axis_.point;
    spin.turns_damping = parameters_.terms().damping;
    if (!parameters_.terms().rotation || is_frozen()) return spin;
    const SparseMatrix A = constraints_.matrix();
    const SparseMatrix transposed = A.transpose();
    const auto projected = [&](const SparseMatrix& between_nodes) -> SparseMatrix {
      return transposed * in_every_direction(between_nodes, 3) * A;
    };
    SpinMatrices matrices = assemble_spin(named_.mesh, sections_, axis_);
    spin.gyroscopic = projected(matrices.gyroscopic);
    SparseMatrix position = -matrices.convected;
    if (keys_.centrifugal)
      position += stress_stiffness(named_.mesh, sections_, widening(body, A));
    spin.position = projected(position);
    spin.around = home_rows() * in_every_direction(derivative_around(named_.mesh, axis_), 3) * A;
    return spin;
  }

 private:
  bool is_frozen() const { return keys_.sliding == SpinSliding::frozen; }

  void check_shape() const {
    const Roundness shape = roundness(named_.mesh, sections_, axis_);
    const std::vector<int> spoiling = shape.without_sectors();
    if (spoiling.empty()) return;
    std::string shares;
    for (const int m : spoiling) {
      shares += fmt::format("{}{:.2g} % goes with {} times the angle", shares.empty() ? "" : ", ",
                            100.0 * shape.harmonics[static_cast<std::size_t>(m - 1)], m);
    }
    throw ConfigError(
        Refusal::not_of_revolution, "spin",
        fmt::format(
            "is of a body of revolution, or of one whose parts all repeat themselves the same "
            "three "
            "times or more around its axis; of mass or stiffness of this one {}, "
            "and its centre is {:.3g} m off the axis. Seen from space its matrices would "
            "change all the time. Give the axis by `about`; or take it as it stands, with "
            "`sliding: frozen`, of which only the surface moves; or let it be the master of "
            "sliding contacts that a drive moves",
            shares, shape.eccentricity));
  }

  void check_materials() const {
    std::vector<bool> is_seen(sections_.sections.size(), false);
    for (std::size_t element = 0; element < named_.mesh.num_elements(); ++element) {
      const auto section = static_cast<std::size_t>(sections_.of_element[element]);
      if (is_seen[section]) continue;
      is_seen[section] = true;
      Eigen::Vector3d place = Eigen::Vector3d::Zero();
      const std::span<const int> nodes = named_.mesh.nodes_of(element);
      for (const int node : nodes)
        place += named_.mesh.nodes.row(node).transpose() / static_cast<double>(nodes.size());
      for (const double angle : {0.5, 1.3}) {
        const Eigen::Matrix3d R = Eigen::AngleAxisd(angle, axis_.direction).toRotationMatrix();
        const Eigen::Vector3d beyond = axis_.point + R * (place - axis_.point);
        const Eigen::MatrixXd here = law_at(section, place);
        const Eigen::MatrixXd there = law_at(section, beyond);
        constexpr double rounding = 1e-9;
        if ((turned_law(here, R) - there).norm() <= rounding * here.norm()) continue;
        throw ConfigError(Refusal::not_of_revolution, section == 0 ? "material" : "materials",
                          "is not alike around the axis of `spin`; let its axes be `around` that");
      }
    }
  }

  Eigen::MatrixXd law_at(std::size_t section, const Eigen::Vector3d& place) const {
    const ElementSection& of = sections_.sections[section];
    return of.law_at ? of.law_at(place) : of.law.matrix();
  }

  void refuse_attachments() const {
    const auto refuse = [](const char* key) {
      throw ConfigError(Refusal::not_of_revolution, key,
                        "turns with the body, of which only what is alike all around the axis of "
                        "`spin` can be seen from space; leave it out");
    };
    if (!parameters_.masses.empty()) refuse("masses");
    if (!parameters_.rigid_regions.empty()) refuse("rigid_regions");
  }

  void refuse_guide() const {
    if (parameters_.guided)
      throw ConfigError(Refusal::not_of_revolution, "guided",
                        "moves the body with a drive, but it spins in its place; give it "
                        "supports");
  }

  bool is_alike_around(const Eigen::Matrix3d& matrix) const {
    const Eigen::Matrix3d R = Eigen::AngleAxisd(1.0, axis_.direction).toRotationMatrix();
    constexpr double rounding = 1e-9;
    return (R * matrix - matrix * R).norm() <= rounding * matrix.norm();
  }

  void check_support(const std::string& name, const MeshSupportParameters& support) const {
    constexpr std::array<const char*, 3> names{"x", "y", "z"};
    const std::string key = "supports." + name;
    if (support.about) {
      const AxisOfRevolution about = support.about->axis(named_.turn);
      const Eigen::Vector3d from = about.point - axis_.point;
      constexpr double rounding = 1e-9;
      if (about.direction.cross(axis_.direction).norm() > rounding ||
          from.cross(axis_.direction).norm() > rounding * extent_of(named_.mesh))
        throw ConfigError(Refusal::not_of_revolution, key + ".about",
                          "is another axis than that of `spin`");
    } else if (!support.held.empty()) {
      Eigen::Matrix3d held = Eigen::Matrix3d::Zero();
      for (Eigen::Index i = 0; i < 3; ++i) {
        const auto& words = support.held;
        if (std::find(words.begin(), words.end(), names[static_cast<std::size_t>(i)]) != words.end())
          held(i, i) = 1.0;
      }
      if (!is_alike_around(held))
        throw ConfigError(Refusal::not_of_revolution, key + ".held",
                          "is not alike all around the axis of `spin`: hold both "
                          "directions across it, or neither, or hold radial, "
                          "tangential and axial ones");
    }
    // Whether its nodes lie all around.
    const Eigen::Vector3d first = axis_.direction.unitOrthogonal();
    const Eigen::Vector3d second = axis_.direction.cross(first);
    std::complex<double> once = 0.0;
    std::complex<double> twice = 0.0;
    double num_nodes = 0.0;
    for (const int node : named_.nodes_on(support.on, key + ".on")) {
      const Eigen::Vector3d from = named_.mesh.nodes.row(node).transpose() - axis_.point;
      const std::complex<double> across(from.dot(first), from.dot(second));
      if (std::abs(across) == 0.0) continue;
      const std::complex<double> turn = across / std::abs(across);
      once += turn;
      twice += turn * turn;
      num_nodes += 1.0;
    }
    constexpr double uneven = 0.2;
    if (std::abs(once) <= uneven * num_nodes && std::abs(twice) <= uneven * num_nodes) return;
    throw ConfigError(Refusal::not_of_revolution, key + ".on",
                      "is a part of the body that turns with it; a body that spins is "
                      "held all around its axis, or not at all");
  }

  void check_spring(const std::string& name, const SurfaceSpringParameters& spring) const {
    const std::string key = "springs." + name;
    if (!named_.mesh.surfaces.contains(spring.on))
      throw ConfigError(Refusal::not_of_revolution, key + ".on",
                        "must be a surface that goes all around the axis of `spin`");
    const Eigen::Vector3d along =
        spring.direction ? spring.direction->unit() : Eigen::Vector3d::UnitX();
    if (!is_alike_around(spring_matrix(spring.stiffness, along)))
      throw ConfigError(Refusal::not_of_revolution, key + ".stiffness",
                        "must be the same in all directions across the axis of `spin`");
  }

  /// Displacements of all nodes by the rotation, for Ω = 1 rad/s.
  Eigen::VectorXd widening(const BodyMatrices& body, const SparseMatrix& A) const {
    const Eigen::VectorXd load =
        A.transpose() * centrifugal_load(named_.mesh, sections_, axis_);
    // The load is in equilibrium, so what is held of a free body does not matter.
    std::vector<int> position(static_cast<std::size_t>(load.size()), 0);
    for (const int dof : constraints_.determinate) position[static_cast<std::size_t>(dof)] = -1;
    int count = 0;
    for (int& at : position)
      if (at == 0) at = count++;
    std::vector<Eigen::Triplet<double>> entries;
    for (Eigen::Index column = 0; column < body.stiffness.outerSize(); ++column) {
      for (SparseMatrix::InnerIterator entry(body.stiffness, column); entry; ++entry) {
        const int row = position[static_cast<std::size_t>(entry.row())];
        const int to = position[static_cast<std::size_t>(column)];
        if (row >= 0 && to >= 0) entries.emplace_back(row, to, entry.value());
      }
    }
    SparseMatrix stiffness(count, count);
    stiffness.setFromTriplets(entries.begin(), entries.end());
    Eigen::VectorXd loads(count);
    for (std::size_t dof = 0; dof < position.size(); ++dof)
      if (position[dof] >= 0) loads(position[dof]) = load(static_cast<Eigen::Index>(dof));
    const Eigen::VectorXd found =
        SparseCholesky(stiffness, "the stiffness of the body that spins").solve(loads);
    Eigen::VectorXd dofs = Eigen::VectorXd::Zero(load.size());
    for (std::size_t dof = 0; dof < position.size(); ++dof)
      if (position[dof] >= 0) dofs(static_cast<Eigen::Index>(dof)) = found(position[dof]);
    return A * dofs;
  }

  /// P with P A = 1: every DoF from the displacements of the node whose own it is.
  SparseMatrix home_rows() const {
    const auto num_dofs = static_cast<std::size_t>(constraints_.num_dofs);
    std::vector<bool> is_found(num_dofs, false);
    std::vector<Eigen::Triplet<double>> entries;
    const std::size_t num_nodes = constraints_.rows.size() / 3;
    for (std::size_t node = 0; node < num_nodes; ++node) {
      std::map<int, std::array<double, 3>> weights;
      for (std::size_t i = 0; i < 3; ++i)
        for (const DofWeight& dof : constraints_.rows[3 * node + i])
          weights[dof.dof][i] += dof.weight;
      for (const auto& [dof, of_node] : weights) {
        const double square =
            of_node[0] * of_node[0] + of_node[1] * of_node[1] + of_node[2] * of_node[2];
        constexpr double rounding = 1e-9;
        if (is_found[static_cast<std::size_t>(dof)] || std::abs(square - 1.0) > rounding) continue;
        is_found[static_cast<std::size_t>(dof)] = true;
        for (std::size_t i = 0; i < 3; ++i)
          if (of_node[i] != 0.0)
            entries.emplace_back(dof, static_cast<int>(3 * node + i), of_node[i]);
      }
    }
    if (std::find(is_found.begin(), is_found.end(), false) != is_found.end())
      throw ConfigError(Refusal::wrong_mesh, "ties",
                        "leave a displacement that belongs to no node, of which a body that spins "
                        "must have none");
    SparseMatrix home(constraints_.num_dofs, static_cast<Eigen::Index>(constraints_.rows.size()));
    home.setFromTriplets(entries.begin(), entries.end());
    return home;
  }

  const MeshBodyParameters& parameters_;
  const NamedMesh& named_;
  const MeshConstraints& constraints_;
  const MeshSpinParameters& keys_;
  AxisOfRevolution axis_;
  MeshSections sections_;
};

}  // namespace

const Schema& MeshSpinParameters::schema() {
  using P = MeshSpinParameters;
  static const Schema keys =
      SchemaOf<P>("mesh_spin")
          .real("speed", &P::speed,
                {.doc = "Angular velocity about the axis, right-handed.", .unit = "rad s-1"})
          .section("about", &P::about,
                   {.doc = "The axis; default: z of the mesh.", .optional = true})
          .choice("sliding", &P::sliding,
                  {{"moving", SpinSliding::moving}, {"frozen", SpinSliding::frozen}},
                  {.doc = "moving: a body of revolution, seen from space; frozen: a body of any "
                          "shape stands as its mesh has it, and only its surface moves past what "
                          "touches it, as of a disc that turns slowly.",
                   .optional = true})
          .flag("centrifugal", &P::centrifugal,
                {.doc =
                     "Whether the stress of the rotation stiffens the body; a frozen one has none.",
                 .optional = true});
  return keys;
}

void add_mesh_spin(const MeshBodyParameters& parameters, const NamedMesh& mesh,
                   const MeshConstraints& constraints, const SparseMatrix& viscous,
                   BodyMatrices& body) {
  const MeshSpin spin(parameters, mesh, constraints);
  spin.check();
  body.spin = spin.make(body);
  body.spin->viscous = viscous;
}

void warn_of_sectors(const MeshBodyParameters& parameters, std::vector<Problem>& warnings) {
  if (!parameters.spin || !parameters.mesh || parameters.spin->sliding == SpinSliding::frozen)
    return;
  const NamedMesh named(parameters);
  if (named.dimension != 3) return;
  const Roundness shape =
      roundness(named.mesh, named.sections(), parameters.spin->about.axis(named.turn));
  if (shape.num_sectors <= 2) return;
  warnings.push_back({Refusal::not_of_revolution, "spin",
                      fmt::format("is of a body that repeats itself {} times around its axis: seen "
                                  "from space it is taken as it stands, which is right for motions "
                                  "with fewer than {} nodal diameters",
                                  shape.num_sectors, (shape.num_sectors + 1) / 2)});
}

}  // namespace stridor
