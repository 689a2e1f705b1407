// Frequencies of bodies in closed form, and the order in which those of elements approach them.

#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <Eigen/SparseCholesky>
#include <array>
#include <cmath>
#include <functional>
#include <numbers>
#include <string>
#include <vector>

#include "substructures/elements/assembly.hpp"
#include "tests/support/element_meshes.hpp"

namespace stridor {
namespace {

using std::numbers::pi;
constexpr double convergence_modulus = 71e9;
constexpr double convergence_ratio = 0.33;
constexpr double convergence_density = 2770.0;

ElementSection convergence_section(PlaneState state, Integration integration) {
  return {ElasticLaw(IsotropicElasticity{convergence_modulus, convergence_ratio}, state),
          convergence_density, 0.01, integration};
}

double shear_speed() {
  return std::sqrt(convergence_modulus / (2.0 * (1.0 + convergence_ratio)) / convergence_density);
}

/// Of waves in a volume or in plane stress.
double pressure_speed(PlaneState state) {
  const double nu = convergence_ratio;
  const double modulus = state == PlaneState::stress
                             ? convergence_modulus / (1.0 - nu * nu)
                             : convergence_modulus * (1.0 - nu) / ((1.0 + nu) * (1.0 - 2.0 * nu));
  return std::sqrt(modulus / convergence_density);
}

/// Whether a displacement in a direction at a place is held.
using Held = std::function<bool(const Eigen::Vector3d& place, int direction)>;

/// Lowest ω, rad/s, by inverse iteration.
double lowest_omega(const Mesh& mesh, const ElementSection& section, const Held& held) {
  const int dimension = mesh.dimension();
  const MeshMatrices matrices = assemble_mesh(mesh, one_section(mesh, section));
  std::vector<int> free_dof(static_cast<std::size_t>(matrices.mass.rows()), -1);
  int count = 0;
  for (int node = 0; node < mesh.nodes.rows(); ++node)
    for (int i = 0; i < dimension; ++i)
      if (!held(mesh.nodes.row(node).transpose(), i))
        free_dof[static_cast<std::size_t>(dimension * node + i)] = count++;
  const auto only_free = [&](const SparseMatrix& all) {
    std::vector<Eigen::Triplet<double>> entries;
    for (int column = 0; column < all.outerSize(); ++column) {
      for (SparseMatrix::InnerIterator entry(all, column); entry; ++entry) {
        const int a = free_dof[static_cast<std::size_t>(entry.row())];
        const int b = free_dof[static_cast<std::size_t>(column)];
        if (a >= 0 && b >= 0) entries.emplace_back(a, b, entry.value());
      }
    }
    SparseMatrix part(count, count);
    part.setFromTriplets(entries.begin(), entries.end());
    return part;
  };
  const SparseMatrix stiffness = only_free(matrices.stiffness);
  const SparseMatrix mass = only_free(matrices.mass);
  const Eigen::SimplicialLDLT<SparseMatrix::Base> factor(stiffness);
  EXPECT_EQ(factor.info(), Eigen::Success);
  Eigen::VectorXd shape = Eigen::VectorXd::LinSpaced(count, 1.0, 2.0);
  double value = 0.0;
  for (int iteration = 0; iteration < 500; ++iteration) {
    shape = factor.solve(mass * shape);
    shape /= std::sqrt(shape.dot(mass * shape));
    const double next = shape.dot(stiffness * shape);
    const bool is_done = std::abs(next - value) < 1e-13 * next;
    value = next;
    if (is_done) break;
  }
  return std::sqrt(value);
}

bool is_at(double coordinate, double place) {
  return std::abs(coordinate - place) < 1e-9;
}

/// Lowest antisymmetric wave of wave number k in a plate of half thickness h (Rayleigh, Lamb): with
/// p² = k² − ω²/c_p² and q² = k² − ω²/c_s², 4 k² p q tanh(q h) = (k² + q²)² tanh(p h).
double bending_omega(double wave_number, double half_thickness, double pressure, double shear) {
  const auto residual = [&](double omega) {
    const double k2 = wave_number * wave_number;
    const double p = std::sqrt(k2 - omega * omega / (pressure * pressure));
    const double q = std::sqrt(k2 - omega * omega / (shear * shear));
    return 4.0 * k2 * p * q * std::tanh(q * half_thickness) -
           (k2 + q * q) * (k2 + q * q) * std::tanh(p * half_thickness);
  };
  // Below the wave of a half space; ω = 0 and ω = c_s k solve the equation as well.
  double low = 1e-3 * shear * wave_number, high = 0.96 * shear * wave_number;
  const bool sign = residual(low) > 0.0;
  EXPECT_NE(sign, residual(high) > 0.0);
  for (int k = 0; k < 200; ++k) {
    const double middle = 0.5 * (low + high);
    ((residual(middle) > 0.0) == sign ? low : high) = middle;
  }
  return 0.5 * (low + high);
}

/// Relative errors of a frequency on grids of n and 2n cells.
struct Refinement {
  double coarse = 0.0, fine = 0.0;
  double order() const { return std::log2(coarse / fine); }
};

/// @param cells of the coarser grid
Refinement refine(ElementShape shape, Integration integration, const std::array<int, 3>& cells,
                  const Eigen::Vector3d& size, double exact, const Held& held) {
  const PlaneState state = facts_of(shape).dimension == 2 ? PlaneState::stress : PlaneState::none;
  const auto error = [&](int factor) {
    const Mesh mesh =
        test::box_mesh(shape, {factor * cells[0], factor * cells[1], factor * cells[2]}, size);
    return lowest_omega(mesh, convergence_section(state, integration), held) / exact - 1.0;
  };
  return {error(1), error(2)};
}

struct Kind {
  ElementShape shape;
  Integration integration = Integration::full;
};

std::vector<Kind> kinds_of(int dimension) {
  std::vector<Kind> kinds;
  for (const ElementShape shape : test::element_shapes)
    if (facts_of(shape).dimension == dimension) kinds.push_back({shape});
  kinds.push_back(
      {dimension == 2 ? ElementShape::quad8 : ElementShape::hex20, Integration::reduced});
  return kinds;
}

/// The error of an eigenvalue is the square of that of its shape in energy: h^2 with linear and h^4
/// with quadratic functions. The next terms still matter on grids this coarse.
void expect_order(const Kind& kind, const Refinement& refinement, const char* what) {
  const double expected = test::is_quadratic(kind.shape) ? 4.0 : 2.0;
  const char* reduced = kind.integration == Integration::reduced ? ", reduced" : "";
  SCOPED_TRACE(std::string(facts_of(kind.shape).name) + reduced);
  EXPECT_NEAR(refinement.order(), expected, 0.4);
  testing::Test::RecordProperty(std::string(what) + "." + facts_of(kind.shape).name + reduced,
                                std::to_string(refinement.order()));
}

TEST(ElementConvergence, BlockBetweenSmoothWalls) {
  // Normal displacements are held, so shear waves of wave number k = π (1/a, 1/b) are its lowest
  // motion: ω = c_s |k|. In boxes with reduced integration the errors of such waves cancel; their
  // order, above 7, is not that of the element.
  for (const int dimension : {2, 3}) {
    const Eigen::Vector3d size{1.0, 0.9, 0.5};
    const double exact = shear_speed() * pi * std::hypot(1.0 / size.x(), 1.0 / size.y());
    const Held held = [&](const Eigen::Vector3d& place, int direction) {
      return is_at(place(direction), 0.0) || is_at(place(direction), size(direction));
    };
    for (const Kind& kind : kinds_of(dimension)) {
      if (kind.integration == Integration::reduced) continue;
      const int n = test::is_quadratic(kind.shape) ? 4 : 6;
      expect_order(kind, refine(kind.shape, kind.integration, {n, n, 2}, size, exact, held),
                   "block");
    }
  }
}

TEST(ElementConvergence, BendingBeam) {
  // Half of a beam on two supports that hold it across: symmetric at x = 0, u_y = 0 at x = a.
  const Eigen::Vector3d size{2.0, 0.5, 1.0};
  const double exact = bending_omega(pi / (2.0 * size.x()), 0.5 * size.y(),
                                     pressure_speed(PlaneState::stress), shear_speed());
  const Held held = [&](const Eigen::Vector3d& place, int direction) {
    return direction == 0 ? is_at(place.x(), 0.0) : is_at(place.x(), size.x());
  };
  for (const Kind& kind : kinds_of(2)) {
    const int n = test::is_quadratic(kind.shape) ? 2 : 8;
    expect_order(kind, refine(kind.shape, kind.integration, {4 * n, n, 1}, size, exact, held),
                 "beam");
  }
}

TEST(ElementConvergence, BendingPlate) {
  // A quarter of a plate on supports that hold its edges across and along themselves: symmetric at
  // x = 0 and y = 0.
  const Eigen::Vector3d size{1.0, 1.2, 0.4};
  const double exact =
      bending_omega(0.5 * pi * std::hypot(1.0 / size.x(), 1.0 / size.y()), 0.5 * size.z(),
                    pressure_speed(PlaneState::none), shear_speed());
  const Held held = [&](const Eigen::Vector3d& place, int direction) {
    const bool at_x = is_at(place.x(), size.x());
    const bool at_y = is_at(place.y(), size.y());
    if (direction == 0) return is_at(place.x(), 0.0) || at_y;
    if (direction == 1) return is_at(place.y(), 0.0) || at_x;
    return at_x || at_y;
  };
  for (const Kind& kind : kinds_of(3)) {
    const int n = test::is_quadratic(kind.shape) ? 4 : 6;
    expect_order(kind, refine(kind.shape, kind.integration, {n, n, n / 2}, size, exact, held),
                 "plate");
  }
}

}  // namespace
}  // namespace stridor
