#include "substructures/elements/shape_functions.hpp"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <random>
#include <stdexcept>
#include <vector>

#include "substructures/elements/quadrature.hpp"
#include "tests/support/constants.hpp"
#include "tests/support/message_of.hpp"

namespace stridor {
namespace {

using test::eps;
using test::message_of;

constexpr std::array<ElementShape, 10> all_shapes{
    ElementShape::tri3,   ElementShape::tri6,   ElementShape::quad4, ElementShape::quad8,
    ElementShape::tet4,   ElementShape::tet10,  ElementShape::hex8,  ElementShape::hex20,
    ElementShape::wedge6, ElementShape::wedge15};
constexpr std::array<SideShape, 6> all_sides{SideShape::line2, SideShape::line3, SideShape::tri3,
                                             SideShape::tri6,  SideShape::quad4, SideShape::quad8};

/// Shape functions have at most twelve factors of order one.
constexpr double few_operations = 32.0;

/// Points within every shape: not negative and of a sum below 1.
std::vector<Eigen::Vector3d> inner_points() {
  std::mt19937 random(7);
  std::uniform_real_distribution<double> uniform(0.0, 1.0 / 3.0);
  std::vector<Eigen::Vector3d> points;
  for (int k = 0; k < 20; ++k)
    points.push_back({uniform(random), uniform(random), uniform(random)});
  return points;
}

template <class Shape>
void expect_one_at_own_node(Shape shape) {
  const auto nodes = natural_nodes(shape);
  for (Eigen::Index node = 0; node < nodes.rows(); ++node) {
    const ShapeFunctions functions = shape_functions(shape, nodes.row(node).transpose());
    ASSERT_EQ(functions.values.size(), nodes.rows());
    for (Eigen::Index k = 0; k < nodes.rows(); ++k)
      EXPECT_NEAR(functions.values(k), k == node ? 1.0 : 0.0, few_operations * eps);
  }
}

TEST(ShapeFunctions, AreOneAtTheirNodeAndZeroAtTheOthers) {
  for (const ElementShape shape : all_shapes) {
    SCOPED_TRACE(facts_of(shape).name);
    EXPECT_EQ(natural_nodes(shape).rows(), facts_of(shape).num_nodes);
    expect_one_at_own_node(shape);
  }
  for (const SideShape shape : all_sides) {
    EXPECT_EQ(natural_nodes(shape).rows(), num_nodes_of(shape));
    expect_one_at_own_node(shape);
  }
}

/// Σ N = 1, Σ ∂N = 0, Σ N x = x and ∂(Σ N x) = 1: what patch tests rest on.
template <class Shape>
void expect_linear_fields(Shape shape) {
  const auto nodes = natural_nodes(shape);
  for (const Eigen::Vector3d& point : inner_points()) {
    const ShapeFunctions functions = shape_functions(shape, point);
    const Eigen::Index dimension = functions.derivatives.cols();
    EXPECT_NEAR(functions.values.sum(), 1.0, few_operations * eps);
    for (Eigen::Index i = 0; i < dimension; ++i) {
      EXPECT_NEAR(functions.derivatives.col(i).sum(), 0.0, few_operations * eps);
      EXPECT_NEAR(functions.values.dot(nodes.col(i)), point(i), few_operations * eps);
      for (Eigen::Index j = 0; j < dimension; ++j)
        EXPECT_NEAR(functions.derivatives.col(i).dot(nodes.col(j)), i == j ? 1.0 : 0.0,
                    few_operations * eps);
    }
  }
}

TEST(ShapeFunctions, GiveLinearFieldsExactly) {
  for (const ElementShape shape : all_shapes) {
    SCOPED_TRACE(facts_of(shape).name);
    expect_linear_fields(shape);
  }
  for (const SideShape shape : all_sides) expect_linear_fields(shape);
}

template <class Shape>
void expect_natural_derivatives(Shape shape) {
  // Central differences of polynomials of degree 4 at most are wrong by h²/6 of the third
  // derivative, below 4, and by the rounding eps/h.
  constexpr double h = 1e-5;
  for (const Eigen::Vector3d& point : inner_points()) {
    const ShapeFunctions functions = shape_functions(shape, point);
    for (Eigen::Index i = 0; i < functions.derivatives.cols(); ++i) {
      Eigen::Vector3d ahead = point, behind = point;
      ahead(i) += h;
      behind(i) -= h;
      const auto difference =
          (shape_functions(shape, ahead).values - shape_functions(shape, behind).values).eval();
      EXPECT_LE((difference / (2.0 * h) - functions.derivatives.col(i)).cwiseAbs().maxCoeff(),
                4.0 / 6.0 * h * h + few_operations * eps / h);
    }
  }
}

TEST(ShapeFunctions, DerivativesAreThoseOfTheValues) {
  for (const ElementShape shape : all_shapes) {
    SCOPED_TRACE(facts_of(shape).name);
    expect_natural_derivatives(shape);
  }
  for (const SideShape shape : all_sides) expect_natural_derivatives(shape);
}

TEST(ShapeFunctions, OfAnElementAreThoseOfItsSideOnIt) {
  // At a point of a side the functions of its nodes are those of the side, the others zero.
  for (const ElementShape shape : all_shapes) {
    SCOPED_TRACE(facts_of(shape).name);
    const auto nodes = natural_nodes(shape);
    for (const SideNodes& side : facts_of(shape).sides) {
      const SideShape side_shape = shape_of(side);
      EXPECT_EQ(dimension_of(side_shape), facts_of(shape).dimension - 1);
      for (const Eigen::Vector3d& point : inner_points()) {
        const ShapeFunctions on_side = shape_functions(side_shape, point);
        Eigen::Vector3d place = Eigen::Vector3d::Zero();
        for (int k = 0; k < side.count; ++k) {
          place +=
              on_side.values(k) * nodes.row(side.nodes[static_cast<std::size_t>(k)]).transpose();
        }
        auto values = shape_functions(shape, place).values;
        for (int k = 0; k < side.count; ++k)
          values(side.nodes[static_cast<std::size_t>(k)]) -= on_side.values(k);
        EXPECT_LE(values.cwiseAbs().maxCoeff(), few_operations * eps);
      }
    }
  }
}

TEST(ShapeFunctions, NumbersOfNodesOfNoSideThrow) {
  EXPECT_EQ(message_of<std::invalid_argument>([] {
              shape_of(SideNodes{5, 5, {}});
            }),
            "shape_of: no side has such numbers of corners and nodes");
}

double factorial(int n) {
  return n < 2 ? 1.0 : n * factorial(n - 1);
}

/// ∫ ξ^p over [−1, 1].
double line_moment(int p) {
  return p % 2 == 1 ? 0.0 : 2.0 / (p + 1);
}

/// ∫ ξ^p η^q ζ^r over a shape.
double natural_moment(ElementShape shape, int p, int q, int r) {
  using enum ElementShape;
  switch (shape) {
    case tri3:
    case tri6:
      return factorial(p) * factorial(q) / factorial(p + q + 2);
    case quad4:
    case quad8:
      return line_moment(p) * line_moment(q);
    case tet4:
    case tet10:
      return factorial(p) * factorial(q) * factorial(r) / factorial(p + q + r + 3);
    case hex8:
    case hex20:
      return line_moment(p) * line_moment(q) * line_moment(r);
    case wedge6:
    case wedge15:
      break;
  }
  return factorial(p) * factorial(q) / factorial(p + q + 2) * line_moment(r);
}

enum class Degrees { total, each, wedge };

/// Largest difference from the integrals of all monomials up to a degree: of the sum of exponents,
/// of each exponent, or of the sum of two and of the third.
double quadrature_error(ElementShape shape, const std::vector<IntegrationPoint>& rule,
                        Degrees degrees, int degree, int through = 0) {
  const int third = facts_of(shape).dimension == 2 ? 0
                    : degrees == Degrees::wedge    ? through
                                                   : degree;
  double error = 0.0;
  for (int p = 0; p <= degree; ++p) {
    for (int q = 0; q <= degree; ++q) {
      for (int r = 0; r <= third; ++r) {
        if (degrees == Degrees::total && p + q + r > degree) continue;
        if (degrees == Degrees::wedge && p + q > degree) continue;
        double sum = 0.0;
        for (const auto& [place, weight] : rule)
          sum += weight * std::pow(place.x(), p) * std::pow(place.y(), q) * std::pow(place.z(), r);
        error = std::max(error, std::abs(sum - natural_moment(shape, p, q, r)));
      }
    }
  }
  return error;
}

TEST(Quadrature, IsExactForThePolynomialsOfItsDegreeAndNoMore) {
  struct Case {
    ElementShape shape;
    const std::vector<IntegrationPoint>& rule;
    std::size_t num_points;
    Degrees degrees;
    int degree, through;
  };
  using enum ElementShape;
  const auto stiffness = [](ElementShape shape) -> const std::vector<IntegrationPoint>& {
    return stiffness_points(shape, Integration::full);
  };
  const auto reduced = [](ElementShape shape) -> const std::vector<IntegrationPoint>& {
    return stiffness_points(shape, Integration::reduced);
  };
  for (const Case& of : {Case{tri3, stiffness(tri3), 1, Degrees::total, 1, 0},
                         {tri6, stiffness(tri6), 3, Degrees::total, 2, 0},
                         {quad4, stiffness(quad4), 4, Degrees::each, 3, 0},
                         {quad8, stiffness(quad8), 9, Degrees::each, 5, 0},
                         {quad8, reduced(quad8), 4, Degrees::each, 3, 0},
                         {tet4, stiffness(tet4), 1, Degrees::total, 1, 0},
                         {tet10, stiffness(tet10), 4, Degrees::total, 2, 0},
                         {hex8, stiffness(hex8), 8, Degrees::each, 3, 0},
                         {hex20, stiffness(hex20), 27, Degrees::each, 5, 0},
                         {hex20, reduced(hex20), 8, Degrees::each, 3, 0},
                         {wedge6, stiffness(wedge6), 6, Degrees::wedge, 2, 3},
                         {wedge15, stiffness(wedge15), 9, Degrees::wedge, 2, 5},
                         {tri3, mass_points(tri3), 3, Degrees::total, 2, 0},
                         {tri6, mass_points(tri6), 6, Degrees::total, 4, 0},
                         {quad4, mass_points(quad4), 4, Degrees::each, 3, 0},
                         {quad8, mass_points(quad8), 9, Degrees::each, 5, 0},
                         {tet4, mass_points(tet4), 4, Degrees::total, 2, 0},
                         {tet10, mass_points(tet10), 15, Degrees::total, 5, 0},
                         {hex8, mass_points(hex8), 8, Degrees::each, 3, 0},
                         {hex20, mass_points(hex20), 27, Degrees::each, 5, 0},
                         {wedge6, mass_points(wedge6), 6, Degrees::wedge, 2, 3},
                         {wedge15, mass_points(wedge15), 18, Degrees::wedge, 4, 5}}) {
    SCOPED_TRACE(facts_of(of.shape).name);
    EXPECT_EQ(of.rule.size(), of.num_points);
    EXPECT_LE(quadrature_error(of.shape, of.rule, of.degrees, of.degree, of.through),
              few_operations * eps);
    EXPECT_GT(quadrature_error(of.shape, of.rule, of.degrees, of.degree + 1, of.through), 1e-6);
    double size = 0.0;
    for (const IntegrationPoint& point : of.rule) {
      EXPECT_GT(point.weight, 0.0);
      size += point.weight;
    }
    EXPECT_NEAR(size, natural_size(of.shape), few_operations * eps);
  }
}

TEST(Quadrature, OfShapesWithoutAReducedOneIsTheFullOne) {
  for (const ElementShape shape : all_shapes) {
    const bool is_reduced = stiffness_points(shape, Integration::reduced).size() <
                            stiffness_points(shape, Integration::full).size();
    EXPECT_EQ(is_reduced, shape == ElementShape::quad8 || shape == ElementShape::hex20);
  }
}

TEST(Quadrature, OfSidesGivesTheirSizeAndTheSharesOfAnEvenLoad) {
  // Shares of a line: 1/2, or Simpson's; of a triangle 1/3, or 0 and 1/3; of a square 1/4, or
  // −1/12 and 1/3.
  const std::array<double, 6> of_corner{1.0 / 2.0, 1.0 / 6.0, 1.0 / 3.0,
                                        0.0,       1.0 / 4.0, -1.0 / 12.0};
  const std::array<double, 6> of_middle{0.0, 4.0 / 6.0, 0.0, 1.0 / 3.0, 0.0, 1.0 / 3.0};
  for (std::size_t k = 0; k < all_sides.size(); ++k) {
    const SideShape shape = all_sides[k];
    const auto nodes = natural_nodes(shape);
    Eigen::VectorXd shares = Eigen::VectorXd::Zero(nodes.rows());
    for (const auto& [place, weight] : side_points(shape))
      shares += weight / natural_size(shape) * shape_functions(shape, place).values;
    const Eigen::Index corners = k < 2 ? 2 : k < 4 ? 3 : 4;
    for (Eigen::Index node = 0; node < nodes.rows(); ++node)
      EXPECT_NEAR(shares(node), node < corners ? of_corner[k] : of_middle[k], few_operations * eps);
  }
}

}  // namespace
}  // namespace stridor
