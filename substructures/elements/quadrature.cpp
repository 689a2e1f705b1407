#include "substructures/elements/quadrature.hpp"

#include <array>
#include <cmath>

namespace stridor {
namespace {

using Rule = std::vector<IntegrationPoint>;

/// Gauss points of [−1, 1]: exact to degree 2 n − 1.
Rule gauss_line(int num_points) {
  const auto point = [](double place, double weight) {
    return IntegrationPoint{{place, 0.0, 0.0}, weight};
  };
  if (num_points == 1) return {point(0.0, 2.0)};
  if (num_points == 2) return {point(-std::sqrt(1.0 / 3.0), 1.0), point(std::sqrt(1.0 / 3.0), 1.0)};
  return {point(-std::sqrt(0.6), 5.0 / 9.0), point(0.0, 8.0 / 9.0),
          point(std::sqrt(0.6), 5.0 / 9.0)};
}

/// Product of a rule of the first coordinates with one of a line for coordinate `direction`.
Rule times_line(const Rule& base, const Rule& line, Eigen::Index direction) {
  Rule product;
  for (const IntegrationPoint& a : base) {
    for (const IntegrationPoint& b : line) {
      product.push_back({a.place, a.weight * b.weight});
      product.back().place(direction) = b.place.x();
    }
  }
  return product;
}

Rule gauss_cube(int dimension, int num_points) {
  const Rule line = gauss_line(num_points);
  Rule rule = line;
  for (Eigen::Index direction = 1; direction < dimension; ++direction)
    rule = times_line(rule, line, direction);
  return rule;
}

/// The points of a triangle of barycentric coordinates (a, a, 1 − 2a).
void add_triangle_orbit(double a, double weight, Rule& rule) {
  rule.push_back({{a, a, 0.0}, weight});
  rule.push_back({{1.0 - 2.0 * a, a, 0.0}, weight});
  rule.push_back({{a, 1.0 - 2.0 * a, 0.0}, weight});
}

/// Degree 1 (1 point), 2 (3 points) or 4 (6 points).
Rule triangle(int degree) {
  Rule rule;
  if (degree == 1) {
    rule.push_back({{1.0 / 3.0, 1.0 / 3.0, 0.0}, 0.5});
  } else if (degree == 2) {
    add_triangle_orbit(1.0 / 6.0, 1.0 / 6.0, rule);
  } else {
    // The two orbits of degree 4 in closed form.
    const double root = std::sqrt(38.0 - 44.0 * std::sqrt(0.4));
    const double spread = std::sqrt(213125.0 - 53320.0 * std::sqrt(10.0));
    const double middle = 8.0 - std::sqrt(10.0);
    add_triangle_orbit((middle + root) / 18.0, 0.5 * (620.0 + spread) / 3720.0, rule);
    add_triangle_orbit((middle - root) / 18.0, 0.5 * (620.0 - spread) / 3720.0, rule);
  }
  return rule;
}

/// The points of a tetrahedron of barycentric coordinates (a, a, a, 1 − 3a).
void add_tetrahedron_orbit(double a, double weight, Rule& rule) {
  const double b = 1.0 - 3.0 * a;
  for (const Eigen::Vector3d& place : {Eigen::Vector3d{a, a, a}, {b, a, a}, {a, b, a}, {a, a, b}})
    rule.push_back({place, weight / 6.0});
}

/// Degree 1 (1 point), 2 (4 points) or 5 (15 points).
Rule tetrahedron(int degree) {
  Rule rule;
  if (degree == 1) {
    rule.push_back({{0.25, 0.25, 0.25}, 1.0 / 6.0});
  } else if (degree == 2) {
    add_tetrahedron_orbit((5.0 - std::sqrt(5.0)) / 20.0, 0.25, rule);
  } else {
    const double root = std::sqrt(15.0);
    rule.push_back({{0.25, 0.25, 0.25}, 16.0 / 135.0 / 6.0});
    add_tetrahedron_orbit((7.0 - root) / 34.0, (2665.0 + 14.0 * root) / 37800.0, rule);
    add_tetrahedron_orbit((7.0 + root) / 34.0, (2665.0 - 14.0 * root) / 37800.0, rule);
    const double a = (5.0 - root) / 20.0;
    const double b = 0.5 - a;
    for (const Eigen::Vector3d& place :
         {Eigen::Vector3d{a, a, b}, {a, b, a}, {b, a, a}, {a, b, b}, {b, a, b}, {b, b, a}})
      rule.push_back({place, 20.0 / 378.0 / 6.0});
  }
  return rule;
}

Rule wedge(int triangle_degree, int num_through) {
  return times_line(triangle(triangle_degree), gauss_line(num_through), 2);
}

Rule make_stiffness_points(ElementShape shape, Integration integration) {
  using enum ElementShape;
  const int gauss = integration == Integration::full ? 3 : 2;
  switch (shape) {
    case tri3:
      return triangle(1);
    case tri6:
      return triangle(2);
    case quad4:
      return gauss_cube(2, 2);
    case quad8:
      return gauss_cube(2, gauss);
    case tet4:
      return tetrahedron(1);
    case tet10:
      return tetrahedron(2);
    case hex8:
      return gauss_cube(3, 2);
    case hex20:
      return gauss_cube(3, gauss);
    case wedge6:
      return wedge(2, 2);
    case wedge15:
      break;
  }
  return wedge(2, 3);
}

Rule make_mass_points(ElementShape shape) {
  using enum ElementShape;
  switch (shape) {
    case tri3:
      return triangle(2);
    case tri6:
      return triangle(4);
    case quad4:
      return gauss_cube(2, 2);
    case quad8:
      return gauss_cube(2, 3);
    case tet4:
      return tetrahedron(2);
    case tet10:
      return tetrahedron(5);
    case hex8:
      return gauss_cube(3, 2);
    case hex20:
      return gauss_cube(3, 3);
    case wedge6:
      return wedge(2, 2);
    case wedge15:
      break;
  }
  return wedge(4, 3);
}

Rule make_side_points(SideShape shape) {
  using enum SideShape;
  switch (shape) {
    case line2:
      return gauss_cube(1, 2);
    case line3:
      return gauss_cube(1, 3);
    case tri3:
      return triangle(2);
    case tri6:
      return triangle(4);
    case quad4:
      return gauss_cube(2, 2);
    case quad8:
      break;
  }
  return gauss_cube(2, 3);
}

constexpr std::size_t num_element_shapes = 10;
constexpr std::size_t num_side_shapes = 6;

}  // namespace

const std::vector<IntegrationPoint>& stiffness_points(ElementShape shape, Integration integration) {
  static const auto rules = [] {
    std::array<std::array<Rule, 2>, num_element_shapes> all;
    for (std::size_t k = 0; k < all.size(); ++k) {
      for (const Integration of : {Integration::full, Integration::reduced})
        all[k][static_cast<std::size_t>(of)] =
            make_stiffness_points(static_cast<ElementShape>(k), of);
    }
    return all;
  }();
  return rules[static_cast<std::size_t>(shape)][static_cast<std::size_t>(integration)];
}

const std::vector<IntegrationPoint>& mass_points(ElementShape shape) {
  static const auto rules = [] {
    std::array<Rule, num_element_shapes> all;
    for (std::size_t k = 0; k < all.size(); ++k)
      all[k] = make_mass_points(static_cast<ElementShape>(k));
    return all;
  }();
  return rules[static_cast<std::size_t>(shape)];
}

const std::vector<IntegrationPoint>& side_points(SideShape shape) {
  static const auto rules = [] {
    std::array<Rule, num_side_shapes> all;
    for (std::size_t k = 0; k < all.size(); ++k)
      all[k] = make_side_points(static_cast<SideShape>(k));
    return all;
  }();
  return rules[static_cast<std::size_t>(shape)];
}

}  // namespace stridor
