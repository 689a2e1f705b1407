#include "substructures/elements/solid_element.hpp"

#include <fmt/format.h>

#include <Eigen/Cholesky>
#include <Eigen/LU>
#include <array>
#include <stdexcept>

#include "substructures/elements/shape_functions.hpp"

namespace stridor {
namespace {

/// Shape functions at an integration point.
template <ElementShape shape>
struct TablePoint {
  using Sizes = ElementSizes<shape>;
  double weight;
  Eigen::Matrix<double, Sizes::num_nodes, 1> values;
  Eigen::Matrix<double, Sizes::dimension, Sizes::num_nodes, Eigen::RowMajor> derivatives;
  Eigen::Vector3d place;
};

template <ElementShape shape>
TablePoint<shape> table_point(const IntegrationPoint& point) {
  const ShapeFunctions functions = shape_functions(shape, point.place);
  return {point.weight, functions.values, functions.derivatives.transpose(), point.place};
}

template <ElementShape shape>
std::vector<TablePoint<shape>> tabulate(const std::vector<IntegrationPoint>& points) {
  std::vector<TablePoint<shape>> table;
  for (const IntegrationPoint& point : points) table.push_back(table_point<shape>(point));
  return table;
}

template <ElementShape shape>
const std::vector<TablePoint<shape>>& stiffness_table(Integration integration) {
  static const std::array<std::vector<TablePoint<shape>>, 2> tables{
      tabulate<shape>(stiffness_points(shape, Integration::full)),
      tabulate<shape>(stiffness_points(shape, Integration::reduced))};
  return tables[static_cast<std::size_t>(integration)];
}

template <ElementShape shape>
const std::vector<TablePoint<shape>>& mass_table() {
  static const std::vector<TablePoint<shape>> table = tabulate<shape>(mass_points(shape));
  return table;
}

/// ∂x_j/∂ξ_i in row i, column j.
template <ElementShape shape>
using JacobianOf =
    Eigen::Matrix<double, ElementSizes<shape>::dimension, ElementSizes<shape>::dimension>;

template <ElementShape shape>
JacobianOf<shape> jacobian_at(const TablePoint<shape>& point, const ElementNodes<shape>& nodes) {
  return point.derivatives.lazyProduct(nodes);
}

[[noreturn]] void refuse_element(ElementShape shape, std::int64_t label) {
  throw std::invalid_argument(fmt::format("element {} ({}) is degenerate or turned inside out",
                                          label, facts_of(shape).name));
}

/// Where the derivative of the displacement in a direction along a coordinate stands among the
/// strains.
template <int dimension>
constexpr int strain_place(int direction, int coordinate) {
  if (direction == coordinate) return direction;
  if constexpr (dimension == 2) return 2;
  return direction + coordinate == 1 ? 3 : direction + coordinate == 3 ? 4 : 5;
}

/// Stiffness of a number of functions, part by part: parts[i][j] is the force in direction i on
/// function a of the displacement in direction j of function b. Only parts with i <= j are made.
template <int dimension, int num_functions>
struct StiffnessParts {
  static constexpr auto directions = static_cast<std::size_t>(dimension);
  static constexpr auto functions = static_cast<std::size_t>(num_functions);
  using Part = std::array<std::array<double, functions>, functions>;
  std::array<std::array<Part, directions>, directions> parts{};

  static constexpr int num_strains = dimension == 2 ? 3 : 6;
  using Law = Eigen::Matrix<double, num_strains, num_strains>;
  using Gradients = Eigen::Matrix<double, dimension, num_functions, Eigen::RowMajor>;

  /// Adds weight · Bᵀ D B.
  void add(const Gradients& gradients, const Law& law, double weight) {
    for (int j = 0; j < dimension; ++j) {
      // D B of displacements in direction j.
      Eigen::Matrix<double, num_strains, num_functions, Eigen::RowMajor> stress;
      for (int s = 0; s < num_strains; ++s) {
        for (int b = 0; b < num_functions; ++b) {
          double sum = 0.0;
          for (int k = 0; k < dimension; ++k)
            sum += law(s, strain_place<dimension>(j, k)) * gradients(k, b);
          stress(s, b) = weight * sum;
        }
      }
      for (int i = 0; i <= j; ++i) {
        Part& part = parts[static_cast<std::size_t>(i)][static_cast<std::size_t>(j)];
        std::array<const double*, directions> of_strain;
        for (int k = 0; k < dimension; ++k)
          of_strain[static_cast<std::size_t>(k)] = &stress(strain_place<dimension>(i, k), 0);
        for (int a = 0; a < num_functions; ++a) {
          auto& row = part[static_cast<std::size_t>(a)];
          std::array<double, directions> gradient;
          for (int k = 0; k < dimension; ++k)
            gradient[static_cast<std::size_t>(k)] = gradients(k, a);
          for (std::size_t b = 0; b < functions; ++b) {
            if constexpr (dimension == 2) {
              row[b] += gradient[0] * of_strain[0][b] + gradient[1] * of_strain[1][b];
            } else {
              row[b] += gradient[0] * of_strain[0][b] + gradient[1] * of_strain[1][b] +
                        gradient[2] * of_strain[2][b];
            }
          }
        }
      }
    }
  }

  /// Interleaved; exactly symmetric, as either triangle is copied from the same numbers.
  Eigen::Matrix<double, dimension * num_functions, dimension * num_functions> interleaved() const {
    Eigen::Matrix<double, dimension * num_functions, dimension * num_functions> whole;
    for (std::size_t i = 0; i < directions; ++i) {
      for (std::size_t j = i; j < directions; ++j) {
        const Part& part = parts[i][j];
        for (std::size_t a = 0; a < functions; ++a) {
          for (std::size_t b = i == j ? a : 0; b < functions; ++b) {
            const auto row = static_cast<Eigen::Index>(directions * a + i);
            const auto column = static_cast<Eigen::Index>(directions * b + j);
            whole(row, column) = whole(column, row) = part[a][b];
          }
        }
      }
    }
    return whole;
  }
};

/// Incompatible modes 1 − ξ_i² in hex8, of which only derivatives matter.
template <ElementShape shape>
constexpr int num_modes = shape == ElementShape::hex8 ? 3 : 0;

/// The stiffness of the nodes, with the modes, which belong to one element alone, condensed.
/// @param whole rows of the nodes, then of the modes
template <ElementShape shape, class Whole>
ElementStiffness<shape> without_modes(const Whole& whole, std::int64_t label) {
  using Sizes = ElementSizes<shape>;
  constexpr int num_inner = Sizes::dimension * num_modes<shape>;
  const Eigen::Matrix<double, num_inner, num_inner> inner =
      whole.template bottomRightCorner<num_inner, num_inner>();
  Eigen::Matrix<double, num_inner, Sizes::num_dofs> coupling =
      whole.template bottomLeftCorner<num_inner, Sizes::num_dofs>();
  const Eigen::LLT<Eigen::Matrix<double, num_inner, num_inner>> factor(inner);
  if (factor.info() != Eigen::Success) refuse_element(shape, label);
  factor.matrixL().solveInPlace(coupling);
  ElementStiffness<shape> stiffness =
      whole.template topLeftCorner<Sizes::num_dofs, Sizes::num_dofs>();
  stiffness -= coupling.transpose().lazyProduct(coupling);
  stiffness.template triangularView<Eigen::StrictlyLower>() = stiffness.transpose();
  return stiffness;
}

}  // namespace

template <ElementShape shape>
ElementStiffness<shape> element_stiffness(const ElementNodes<shape>& nodes,
                                          const ElementSection& section, std::int64_t label) {
  using Sizes = ElementSizes<shape>;
  using Jacobian = JacobianOf<shape>;
  constexpr int dimension = Sizes::dimension;
  constexpr int num_functions = Sizes::num_nodes + num_modes<shape>;
  using Parts = StiffnessParts<dimension, num_functions>;
  if (section.law.dimension() != dimension)
    throw std::invalid_argument("element_stiffness: the law is for another dimension");
  typename Parts::Law law = section.law.matrix();
  const double thickness = dimension == 2 ? section.thickness : 1.0;

  // Of the centre, for the modes: Σ w det(J) ∂(mode) = 0, as the patch test requires.
  double centre_determinant = 0.0;
  Jacobian centre_inverse;
  if constexpr (num_modes < shape >> 0) {
    static const TablePoint<shape> centre = table_point<shape>({Eigen::Vector3d::Zero(), 1.0});
    const Jacobian jacobian = jacobian_at<shape>(centre, nodes);
    centre_determinant = jacobian.determinant();
    if (!(centre_determinant > 0.0)) refuse_element(shape, label);
    centre_inverse = jacobian.inverse();
  }

  Parts parts;
  for (const TablePoint<shape>& point : stiffness_table<shape>(section.integration)) {
    const Jacobian jacobian = jacobian_at<shape>(point, nodes);
    const double determinant = jacobian.determinant();
    if (!(determinant > 0.0)) refuse_element(shape, label);
    const Jacobian inverse = jacobian.inverse();
    typename Parts::Gradients gradients;
    gradients.template leftCols<Sizes::num_nodes>() = inverse.lazyProduct(point.derivatives);
    if constexpr (num_modes < shape >> 0) {
      for (int mode = 0; mode < num_modes<shape>; ++mode) {
        gradients.col(Sizes::num_nodes + mode) =
            -2.0 * point.place(mode) * centre_determinant / determinant * centre_inverse.col(mode);
      }
    }
    if (section.law_at) {
      Eigen::Vector3d place = Eigen::Vector3d::Zero();
      place.head<dimension>() = nodes.transpose().lazyProduct(point.values);
      law = section.law_at(place);
    }
    parts.add(gradients, law, point.weight * determinant * thickness);
  }
  if constexpr (num_modes<shape> == 0) {
    return parts.interleaved();
  } else {
    return without_modes<shape>(parts.interleaved(), label);
  }
}

template <ElementShape shape>
NodalMass<shape> element_mass(const ElementNodes<shape>& nodes, const ElementSection& section,
                              std::int64_t label) {
  constexpr int num_nodes = ElementSizes<shape>::num_nodes;
  const double factor =
      ElementSizes<shape>::dimension == 2 ? section.density * section.thickness : section.density;
  NodalMass<shape> mass = NodalMass<shape>::Zero();
  for (const TablePoint<shape>& point : mass_table<shape>()) {
    const double determinant = jacobian_at<shape>(point, nodes).determinant();
    if (!(determinant > 0.0)) refuse_element(shape, label);
    const double weight = factor * point.weight * determinant;
    for (int b = 0; b < num_nodes; ++b) {
      const double share = weight * point.values(b);
      for (int a = 0; a <= b; ++a) mass(a, b) += share * point.values(a);
    }
  }
  mass.template triangularView<Eigen::StrictlyLower>() = mass.transpose();
  return mass;
}

ElementMatrices element_matrices(ElementShape shape, const Mesh::Nodes& nodes,
                                 const ElementSection& section, std::int64_t label) {
  if (nodes.rows() != facts_of(shape).num_nodes)
    throw std::invalid_argument("element_matrices: wrong number of nodes");
  return with_shape(shape, [&]<ElementShape of>() -> ElementMatrices {
    const ElementNodes<of> places = nodes.leftCols<ElementSizes<of>::dimension>();
    return {element_stiffness<of>(places, section, label),
            element_mass<of>(places, section, label)};
  });
}

#define STRIDOR_ELEMENT(shape)                                                                     \
  template ElementStiffness<shape> element_stiffness<shape>(const ElementNodes<shape>&,            \
                                                            const ElementSection&, std::int64_t);  \
  template NodalMass<shape> element_mass<shape>(const ElementNodes<shape>&, const ElementSection&, \
                                                std::int64_t);
STRIDOR_ELEMENT(ElementShape::tri3)
STRIDOR_ELEMENT(ElementShape::tri6)
STRIDOR_ELEMENT(ElementShape::quad4)
STRIDOR_ELEMENT(ElementShape::quad8)
STRIDOR_ELEMENT(ElementShape::tet4)
STRIDOR_ELEMENT(ElementShape::tet10)
STRIDOR_ELEMENT(ElementShape::hex8)
STRIDOR_ELEMENT(ElementShape::hex20)
STRIDOR_ELEMENT(ElementShape::wedge6)
STRIDOR_ELEMENT(ElementShape::wedge15)
#undef STRIDOR_ELEMENT

}  // namespace stridor
