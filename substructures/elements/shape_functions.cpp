#include "substructures/elements/shape_functions.hpp"

#include <array>
#include <cmath>
#include <span>
#include <stdexcept>
#include <utility>
#include <vector>

namespace stridor {
namespace {

enum class ShapeFamily { cube, simplex, wedge };
enum class ShapeOrder { linear, quadratic };

/// A line, quadrilateral or hexahedron; a triangle or tetrahedron; or a wedge.
struct NaturalShape {
  ShapeFamily family;
  int dimension;
  ShapeOrder order;

  int num_corners() const {
    if (family == ShapeFamily::wedge) return 6;
    return family == ShapeFamily::cube ? 1 << dimension : dimension + 1;
  }
};

using Corner = std::array<double, 3>;
using Edge = std::pair<int, int>;

constexpr std::array<Corner, 8> cube_corners{{{-1, -1, -1},
                                              {1, -1, -1},
                                              {1, 1, -1},
                                              {-1, 1, -1},
                                              {-1, -1, 1},
                                              {1, -1, 1},
                                              {1, 1, 1},
                                              {-1, 1, 1}}};
constexpr std::array<Edge, 12> cube_edges{{{0, 1},
                                           {1, 2},
                                           {2, 3},
                                           {3, 0},
                                           {4, 5},
                                           {5, 6},
                                           {6, 7},
                                           {7, 4},
                                           {0, 4},
                                           {1, 5},
                                           {2, 6},
                                           {3, 7}}};
constexpr std::array<Corner, 4> simplex_corners{{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}}};
constexpr std::array<Edge, 6> simplex_edges{{{0, 1}, {1, 2}, {2, 0}, {0, 3}, {1, 3}, {2, 3}}};
constexpr std::array<Corner, 6> wedge_corners{
    {{0, 0, -1}, {1, 0, -1}, {0, 1, -1}, {0, 0, 1}, {1, 0, 1}, {0, 1, 1}}};
constexpr std::array<Edge, 9> wedge_edges{
    {{0, 1}, {1, 2}, {2, 0}, {3, 4}, {4, 5}, {5, 3}, {0, 3}, {1, 4}, {2, 5}}};

/// Edges whose middles are nodes, in their order.
std::span<const Edge> edges_of(const NaturalShape& shape) {
  if (shape.order == ShapeOrder::linear) return {};
  constexpr std::array<std::size_t, 4> of_cube{0, 1, 4, 12};
  constexpr std::array<std::size_t, 4> of_simplex{0, 1, 3, 6};
  const auto dimension = static_cast<std::size_t>(shape.dimension);
  switch (shape.family) {
    case ShapeFamily::cube:
      return std::span(cube_edges).first(of_cube[dimension]);
    case ShapeFamily::simplex:
      return std::span(simplex_edges).first(of_simplex[dimension]);
    case ShapeFamily::wedge:
      break;
  }
  return wedge_edges;
}

Corner corner_of(const NaturalShape& shape, int corner) {
  const auto k = static_cast<std::size_t>(corner);
  Corner place = shape.family == ShapeFamily::cube      ? cube_corners[k]
                 : shape.family == ShapeFamily::simplex ? simplex_corners[k]
                                                        : wedge_corners[k];
  for (auto i = static_cast<std::size_t>(shape.dimension); i < 3; ++i) place[i] = 0.0;
  return place;
}

NaturalShape natural(ElementShape shape) {
  using enum ElementShape;
  switch (shape) {
    case tri3:
      return {ShapeFamily::simplex, 2, ShapeOrder::linear};
    case tri6:
      return {ShapeFamily::simplex, 2, ShapeOrder::quadratic};
    case quad4:
      return {ShapeFamily::cube, 2, ShapeOrder::linear};
    case quad8:
      return {ShapeFamily::cube, 2, ShapeOrder::quadratic};
    case tet4:
      return {ShapeFamily::simplex, 3, ShapeOrder::linear};
    case tet10:
      return {ShapeFamily::simplex, 3, ShapeOrder::quadratic};
    case hex8:
      return {ShapeFamily::cube, 3, ShapeOrder::linear};
    case hex20:
      return {ShapeFamily::cube, 3, ShapeOrder::quadratic};
    case wedge6:
      return {ShapeFamily::wedge, 3, ShapeOrder::linear};
    case wedge15:
      break;
  }
  return {ShapeFamily::wedge, 3, ShapeOrder::quadratic};
}

NaturalShape natural(SideShape shape) {
  using enum SideShape;
  switch (shape) {
    case line2:
      return {ShapeFamily::cube, 1, ShapeOrder::linear};
    case line3:
      return {ShapeFamily::cube, 1, ShapeOrder::quadratic};
    case tri3:
      return {ShapeFamily::simplex, 2, ShapeOrder::linear};
    case tri6:
      return {ShapeFamily::simplex, 2, ShapeOrder::quadratic};
    case quad4:
      return {ShapeFamily::cube, 2, ShapeOrder::linear};
    case quad8:
      break;
  }
  return {ShapeFamily::cube, 2, ShapeOrder::quadratic};
}

Eigen::Matrix<double, Eigen::Dynamic, 3> nodes_of(const NaturalShape& shape) {
  const std::span<const Edge> edges = edges_of(shape);
  const int corners = shape.num_corners();
  Eigen::Matrix<double, Eigen::Dynamic, 3> nodes(corners + static_cast<int>(edges.size()), 3);
  for (int k = 0; k < corners; ++k) {
    const Corner place = corner_of(shape, k);
    nodes.row(k) << place[0], place[1], place[2];
  }
  Eigen::Index middle = corners;
  for (const auto& [first, second] : edges)
    nodes.row(middle++) = 0.5 * (nodes.row(first) + nodes.row(second));
  return nodes;
}

/// A function of one coordinate and its derivative.
struct Factor {
  double value, slope;
};

/// Corners: Π (1 + a_i ξ_i)/2, with quadratic functions times Σ a_i ξ_i − (d − 1); the middle of an
/// edge along coordinate m: (1 − ξ_m²) Π (1 + a_i ξ_i)/2 over the others.
void fill_cube(const NaturalShape& shape, const Eigen::Vector3d& point, ShapeFunctions& functions) {
  const int dimension = shape.dimension;
  const auto nodes = nodes_of(shape);
  for (int k = 0; k < nodes.rows(); ++k) {
    const bool is_corner = k < shape.num_corners();
    std::array<Factor, 3> factors{};
    double sum = 1.0 - dimension;
    for (int i = 0; i < dimension; ++i) {
      const double a = nodes(k, i);
      const double at = point(i);
      factors[static_cast<std::size_t>(i)] =
          a == 0.0 ? Factor{1.0 - at * at, -2.0 * at} : Factor{0.5 * (1.0 + a * at), 0.5 * a};
      sum += a * at;
    }
    const bool has_sum = is_corner && shape.order == ShapeOrder::quadratic;
    double product = 1.0;
    for (int i = 0; i < dimension; ++i) product *= factors[static_cast<std::size_t>(i)].value;
    functions.values(k) = has_sum ? product * sum : product;
    for (int i = 0; i < dimension; ++i) {
      double slope = 1.0;
      for (int j = 0; j < dimension; ++j) {
        const Factor& factor = factors[static_cast<std::size_t>(j)];
        slope *= i == j ? factor.slope : factor.value;
      }
      functions.derivatives(k, i) = has_sum ? slope * sum + product * nodes(k, i) : slope;
    }
  }
}

/// Barycentric coordinates λ of a triangle or tetrahedron; their derivatives are ±1 or 0.
struct Barycentric {
  std::array<double, 4> lambda{};

  Barycentric(int dimension, const Eigen::Vector3d& point) {
    lambda[0] = 1.0;
    for (int i = 0; i < dimension; ++i) {
      lambda[0] -= point(i);
      lambda[static_cast<std::size_t>(i + 1)] = point(i);
    }
  }
  double operator[](int k) const { return lambda[static_cast<std::size_t>(k)]; }
  static double slope(int k, int coordinate) {
    if (k == 0) return -1.0;
    return k == coordinate + 1 ? 1.0 : 0.0;
  }
};

/// Corners: λ, or λ (2λ − 1) with quadratic functions; the middle of an edge: 4 λ_a λ_b.
void fill_simplex(const NaturalShape& shape, const Eigen::Vector3d& point,
                  ShapeFunctions& functions) {
  const Barycentric lambda(shape.dimension, point);
  const bool is_quadratic = shape.order == ShapeOrder::quadratic;
  for (int k = 0; k <= shape.dimension; ++k) {
    functions.values(k) = is_quadratic ? lambda[k] * (2.0 * lambda[k] - 1.0) : lambda[k];
    const double slope = is_quadratic ? 4.0 * lambda[k] - 1.0 : 1.0;
    for (int i = 0; i < shape.dimension; ++i)
      functions.derivatives(k, i) = slope * Barycentric::slope(k, i);
  }
  Eigen::Index middle = shape.num_corners();
  for (const auto& [a, b] : edges_of(shape)) {
    functions.values(middle) = 4.0 * lambda[a] * lambda[b];
    for (int i = 0; i < shape.dimension; ++i) {
      functions.derivatives(middle, i) =
          4.0 * (Barycentric::slope(a, i) * lambda[b] + lambda[a] * Barycentric::slope(b, i));
    }
    ++middle;
  }
}

/// With s = ∓1 on the base and the top: corners λ (1 + s ζ)/2, with quadratic functions times
/// 2λ − 2 + s ζ; middles of the edges of base and top 2 λ_a λ_b (1 + s ζ), of the others λ (1 −
/// ζ²).
void fill_wedge(const NaturalShape& shape, const Eigen::Vector3d& point,
                ShapeFunctions& functions) {
  const Barycentric lambda(2, point);
  const double zeta = point.z();
  const bool is_quadratic = shape.order == ShapeOrder::quadratic;
  for (int k = 0; k < 6; ++k) {
    const int in_base = k % 3;
    const double s = k < 3 ? -1.0 : 1.0;
    const double height = 1.0 + s * zeta;
    const double at = lambda[in_base];
    const double factor = is_quadratic ? 2.0 * at - 2.0 + s * zeta : 1.0;
    functions.values(k) = 0.5 * at * height * factor;
    const double slope = 0.5 * height * (is_quadratic ? factor + 2.0 * at : 1.0);
    for (int i = 0; i < 2; ++i)
      functions.derivatives(k, i) = slope * Barycentric::slope(in_base, i);
    functions.derivatives(k, 2) = 0.5 * at * s * (is_quadratic ? factor + height : 1.0);
  }
  Eigen::Index middle = 6;
  for (const auto& [first, second] : edges_of(shape)) {
    const int a = first % 3;
    const int b = second % 3;
    if (a == b) {
      functions.values(middle) = lambda[a] * (1.0 - zeta * zeta);
      for (int i = 0; i < 2; ++i)
        functions.derivatives(middle, i) = (1.0 - zeta * zeta) * Barycentric::slope(a, i);
      functions.derivatives(middle, 2) = -2.0 * zeta * lambda[a];
    } else {
      const double s = first < 3 ? -1.0 : 1.0;
      const double height = 1.0 + s * zeta;
      functions.values(middle) = 2.0 * lambda[a] * lambda[b] * height;
      for (int i = 0; i < 2; ++i) {
        functions.derivatives(middle, i) =
            2.0 * height *
            (Barycentric::slope(a, i) * lambda[b] + lambda[a] * Barycentric::slope(b, i));
      }
      functions.derivatives(middle, 2) = 2.0 * s * lambda[a] * lambda[b];
    }
    ++middle;
  }
}

ShapeFunctions functions_of(const NaturalShape& shape, const Eigen::Vector3d& point) {
  const Eigen::Index nodes =
      shape.num_corners() + static_cast<Eigen::Index>(edges_of(shape).size());
  ShapeFunctions functions;
  functions.values.resize(nodes);
  functions.derivatives.resize(nodes, shape.dimension);
  switch (shape.family) {
    case ShapeFamily::cube:
      fill_cube(shape, point, functions);
      break;
    case ShapeFamily::simplex:
      fill_simplex(shape, point, functions);
      break;
    case ShapeFamily::wedge:
      fill_wedge(shape, point, functions);
      break;
  }
  return functions;
}

double size_of_shape(const NaturalShape& shape) {
  if (shape.family == ShapeFamily::wedge) return 1.0;
  if (shape.family == ShapeFamily::cube) return std::ldexp(1.0, shape.dimension);
  return shape.dimension == 2 ? 1.0 / 2.0 : 1.0 / 6.0;
}

}  // namespace

SideShape shape_of(const SideNodes& side) {
  if (side.num_corners == 2 && side.count == 2) return SideShape::line2;
  if (side.num_corners == 2 && side.count == 3) return SideShape::line3;
  if (side.num_corners == 3 && side.count == 3) return SideShape::tri3;
  if (side.num_corners == 3 && side.count == 6) return SideShape::tri6;
  if (side.num_corners == 4 && side.count == 4) return SideShape::quad4;
  if (side.num_corners == 4 && side.count == 8) return SideShape::quad8;
  throw std::invalid_argument("shape_of: no side has such numbers of corners and nodes");
}

int dimension_of(SideShape shape) {
  return natural(shape).dimension;
}

int num_nodes_of(SideShape shape) {
  const NaturalShape facts = natural(shape);
  return facts.num_corners() + static_cast<int>(edges_of(facts).size());
}

ShapeFunctions shape_functions(ElementShape shape, const Eigen::Vector3d& point) {
  return functions_of(natural(shape), point);
}

ShapeFunctions shape_functions(SideShape shape, const Eigen::Vector3d& point) {
  return functions_of(natural(shape), point);
}

Eigen::Matrix<double, Eigen::Dynamic, 3> natural_nodes(ElementShape shape) {
  return nodes_of(natural(shape));
}

Eigen::Matrix<double, Eigen::Dynamic, 3> natural_nodes(SideShape shape) {
  return nodes_of(natural(shape));
}

double natural_size(ElementShape shape) {
  return size_of_shape(natural(shape));
}

double natural_size(SideShape shape) {
  return size_of_shape(natural(shape));
}

}  // namespace stridor
