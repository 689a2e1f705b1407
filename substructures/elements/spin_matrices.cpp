#include "substructures/elements/spin_matrices.hpp"

#include <Eigen/Geometry>
#include <Eigen/LU>
#include <algorithm>
#include <array>
#include <cmath>
#include <complex>
#include <functional>
#include <limits>
#include <numeric>
#include <optional>
#include <stdexcept>

#include "substructures/elements/shape_functions.hpp"

namespace stridor {
namespace {

using Entries = std::vector<Eigen::Triplet<double>>;

/// Shape functions of an element at one of its points, with the share of its volume.
struct ElementPoint {
  Eigen::Matrix<double, Eigen::Dynamic, 1, 0, 20, 1> values;     ///< N_a
  Eigen::Matrix<double, Eigen::Dynamic, 3, 0, 20, 3> gradients;  ///< ∂N_a/∂x, 1/m
  Eigen::Vector3d place;                                         ///< m
  double volume = 0.0;  ///< weight times Jacobian, m³
};

/// Shape functions at given points, tabulated once for each shape.
class PointTable {
 public:
  using Points = std::function<std::vector<IntegrationPoint>(ElementShape)>;
  explicit PointTable(Points points) : points_(std::move(points)) {}

  /// Calls action(k, point) at the points k of an element.
  template <class Action>
  void for_points(const Mesh& mesh, std::size_t element, Action&& action) {
    const Table& table = table_of(mesh.shapes[element]);
    const std::span<const int> nodes = mesh.nodes_of(element);
    Eigen::Matrix<double, Eigen::Dynamic, 3, 0, 20, 3> places(
        static_cast<Eigen::Index>(nodes.size()), 3);
    for (std::size_t a = 0; a < nodes.size(); ++a)
      places.row(static_cast<Eigen::Index>(a)) = mesh.nodes.row(nodes[a]);
    ElementPoint point;
    for (std::size_t k = 0; k < table.size(); ++k) {
      const auto& [functions, weight] = table[k];
      const Eigen::Matrix3d jacobian = functions.derivatives.transpose() * places;
      point.values = functions.values;
      point.gradients = functions.derivatives * jacobian.inverse().transpose();
      point.place = places.transpose() * functions.values;
      point.volume = weight * jacobian.determinant();
      action(k, point);
    }
  }

 private:
  struct Row {
    ShapeFunctions functions;
    double weight = 0.0;
  };
  using Table = std::vector<Row>;

  const Table& table_of(ElementShape shape) {
    std::optional<Table>& table = tables_[static_cast<std::size_t>(shape)];
    if (!table) {
      table.emplace();
      for (const IntegrationPoint& point : points_(shape))
        table->push_back({shape_functions(shape, point.place), point.weight});
    }
    return *table;
  }

  Points points_;
  std::array<std::optional<Table>, 10> tables_;
};

void require_volumes(const Mesh& mesh, const char* function) {
  if (mesh.dimension() != 3)
    throw std::invalid_argument(std::string(function) + ": the mesh is planar");
}

/// ∂_φ N_a of all nodes at a point.
Eigen::VectorXd around(const ElementPoint& point, const AxisOfRevolution& axis) {
  return point.gradients * axis.direction.cross(point.place - axis.point);
}

void append(std::span<const int> nodes, const Eigen::MatrixXd& block, Entries& entries) {
  for (std::size_t b = 0; b < nodes.size(); ++b)
    for (std::size_t a = 0; a < nodes.size(); ++a)
      entries.emplace_back(nodes[a], nodes[b],
                           block(static_cast<Eigen::Index>(a), static_cast<Eigen::Index>(b)));
}

/// Points that lie evenly along the edges of bricks and the height of wedges, so that around a mesh of
/// revolution they repeat more often than its elements do.
std::vector<IntegrationPoint> even_points(ElementShape shape) {
  constexpr int count = 4;
  const auto at = [](int i) { return (2.0 * i + 1.0) / count - 1.0; };
  std::vector<IntegrationPoint> points;
  switch (shape) {
    case ElementShape::hex8:
    case ElementShape::hex20:
      for (int k = 0; k < count; ++k)
        for (int j = 0; j < count; ++j)
          for (int i = 0; i < count; ++i)
            points.push_back({{at(i), at(j), at(k)}, 8.0 / (count * count * count)});
      return points;
    case ElementShape::wedge6:
    case ElementShape::wedge15:
      for (const IntegrationPoint& base : side_points(SideShape::tri6))
        for (int k = 0; k < count; ++k)
          points.push_back({{base.place.x(), base.place.y(), at(k)}, base.weight * 2.0 / count});
      return points;
    default:
      break;
  }
  // Tetrahedra: the middles of small ones.
  constexpr int order = 5;
  for (int i = 0; i <= order; ++i)
    for (int j = 0; i + j <= order; ++j)
      for (int k = 0; i + j + k <= order; ++k)
        points.push_back({(Eigen::Vector3d(i, j, k).array() + 0.25) / (order + 1.0), 0.0});
  for (IntegrationPoint& point : points)
    point.weight = natural_size(shape) / static_cast<double>(points.size());
  return points;
}

SparseMatrix between_nodes(const Mesh& mesh, const Entries& entries) {
  SparseMatrix matrix(mesh.nodes.rows(), mesh.nodes.rows());
  matrix.setFromTriplets(entries.begin(), entries.end());
  return matrix;
}

}  // namespace

SpinMatrices assemble_spin(const Mesh& mesh, const MeshSections& sections,
                           const AxisOfRevolution& axis) {
  require_volumes(mesh, "assemble_spin");
  PointTable table(mass_points);
  Entries gyroscopic, convected;
  for (std::size_t element = 0; element < mesh.num_elements(); ++element) {
    const std::span<const int> nodes = mesh.nodes_of(element);
    const auto n = static_cast<Eigen::Index>(nodes.size());
    Eigen::MatrixXd G = Eigen::MatrixXd::Zero(n, n);
    Eigen::MatrixXd S = Eigen::MatrixXd::Zero(n, n);
    const double density = sections.of(element).density;
    table.for_points(mesh, element, [&](std::size_t, const ElementPoint& point) {
      const Eigen::VectorXd turned = around(point, axis);
      G += density * point.volume * point.values * turned.transpose();
      S += density * point.volume * turned * turned.transpose();
    });
    append(nodes, 0.5 * (G - G.transpose()), gyroscopic);
    append(nodes, S, convected);
  }
  return {between_nodes(mesh, gyroscopic), between_nodes(mesh, convected)};
}

SparseMatrix derivative_around(const Mesh& mesh, const AxisOfRevolution& axis) {
  require_volumes(mesh, "derivative_around");
  PointTable at_nodes([](ElementShape shape) {
    const Eigen::Matrix<double, Eigen::Dynamic, 3> places = natural_nodes(shape);
    std::vector<IntegrationPoint> points;
    for (Eigen::Index a = 0; a < places.rows(); ++a)
      points.push_back({places.row(a).transpose(), 1.0});
    return points;
  });
  PointTable within(mass_points);
  Entries entries;
  Eigen::VectorXd volumes = Eigen::VectorXd::Zero(mesh.nodes.rows());
  for (std::size_t element = 0; element < mesh.num_elements(); ++element) {
    const std::span<const int> nodes = mesh.nodes_of(element);
    double volume = 0.0;
    within.for_points(mesh, element, [&](std::size_t, const ElementPoint& point) {
      volume += point.volume;
    });
    at_nodes.for_points(mesh, element, [&](std::size_t a, const ElementPoint& point) {
      const Eigen::VectorXd turned = around(point, axis);
      volumes(nodes[a]) += volume;
      for (std::size_t b = 0; b < nodes.size(); ++b)
        entries.emplace_back(nodes[a], nodes[b], volume * turned(static_cast<Eigen::Index>(b)));
    });
  }
  SparseMatrix derivative = between_nodes(mesh, entries);
  return volumes.cwiseMax(std::numeric_limits<double>::min()).cwiseInverse().asDiagonal() *
         derivative;
}

Eigen::VectorXd centrifugal_load(const Mesh& mesh, const MeshSections& sections,
                                 const AxisOfRevolution& axis) {
  require_volumes(mesh, "centrifugal_load");
  PointTable table(mass_points);
  Eigen::VectorXd load = Eigen::VectorXd::Zero(3 * mesh.nodes.rows());
  for (std::size_t element = 0; element < mesh.num_elements(); ++element) {
    const std::span<const int> nodes = mesh.nodes_of(element);
    const double density = sections.of(element).density;
    table.for_points(mesh, element, [&](std::size_t, const ElementPoint& point) {
      Eigen::Vector3d arm = point.place - axis.point;
      arm -= arm.dot(axis.direction) * axis.direction;
      for (std::size_t a = 0; a < nodes.size(); ++a)
        load.segment<3>(3 * nodes[a]) +=
            density * point.volume * point.values(static_cast<Eigen::Index>(a)) * arm;
    });
  }
  return load;
}

SparseMatrix stress_stiffness(const Mesh& mesh, const MeshSections& sections,
                              const Eigen::VectorXd& displacements) {
  require_volumes(mesh, "stress_stiffness");
  PointTable full([](ElementShape shape) { return stiffness_points(shape, Integration::full); });
  Entries entries;
  for (std::size_t element = 0; element < mesh.num_elements(); ++element) {
    const std::span<const int> nodes = mesh.nodes_of(element);
    const auto n = static_cast<Eigen::Index>(nodes.size());
    const ElementSection& section = sections.of(element);
    Eigen::MatrixXd block = Eigen::MatrixXd::Zero(n, n);
    full.for_points(mesh, element, [&](std::size_t, const ElementPoint& point) {
      Eigen::Matrix3d slope = Eigen::Matrix3d::Zero();  // ∂u_i/∂x_j
      for (std::size_t a = 0; a < nodes.size(); ++a)
        slope += displacements.segment<3>(3 * nodes[a]) *
                 point.gradients.row(static_cast<Eigen::Index>(a));
      Eigen::Matrix<double, 6, 1> strain;
      strain << slope(0, 0), slope(1, 1), slope(2, 2), slope(0, 1) + slope(1, 0),
          slope(1, 2) + slope(2, 1), slope(2, 0) + slope(0, 2);
      const ElasticLaw::Matrix law =
          section.law_at ? section.law_at(point.place) : section.law.matrix();
      const Eigen::Matrix<double, 6, 1> s = law * strain;
      Eigen::Matrix3d stress;
      stress << s(0), s(3), s(5), s(3), s(1), s(4), s(5), s(4), s(2);
      block += point.volume * point.gradients * stress * point.gradients.transpose();
    });
    append(nodes, block, entries);
  }
  return between_nodes(mesh, entries);
}

SparseMatrix in_every_direction(const SparseMatrix& between_nodes, int dimension) {
  Entries entries;
  entries.reserve(static_cast<std::size_t>(dimension * between_nodes.nonZeros()));
  for (Eigen::Index column = 0; column < between_nodes.outerSize(); ++column)
    for (SparseMatrix::InnerIterator entry(between_nodes, column); entry; ++entry)
      for (int i = 0; i < dimension; ++i)
        entries.emplace_back(static_cast<int>(dimension * entry.row()) + i,
                             static_cast<int>(dimension * column) + i, entry.value());
  SparseMatrix matrix(dimension * between_nodes.rows(), dimension * between_nodes.cols());
  matrix.setFromTriplets(entries.begin(), entries.end());
  return matrix;
}

Roundness roundness(const Mesh& mesh, const MeshSections& sections, const AxisOfRevolution& axis) {
  require_volumes(mesh, "roundness");
  constexpr int num_harmonics = 36;
  // The corners of a mesh of a round part give harmonics of up to this size.
  constexpr double negligible = 2e-3;
  // Directions across the axis.
  const Eigen::Vector3d first = axis.direction.unitOrthogonal();
  const Eigen::Vector3d second = axis.direction.cross(first);
  std::array<std::complex<double>, num_harmonics> masses{}, stiffnesses{};
  double mass = 0.0;
  double stiffness = 0.0;
  std::complex<double> arm = 0.0;
  PointTable table(even_points);
  for (std::size_t element = 0; element < mesh.num_elements(); ++element) {
    const ElementSection& section = sections.of(element);
    const double modulus = section.law.matrix().trace();
    table.for_points(mesh, element, [&](std::size_t, const ElementPoint& point) {
      const Eigen::Vector3d from = point.place - axis.point;
      const std::complex<double> across(from.dot(first), from.dot(second));
      const double share = section.density * point.volume;
      mass += share;
      stiffness += modulus * point.volume;
      arm += share * across;
      const double radius = std::abs(across);
      if (radius == 0.0) return;
      const std::complex<double> turn = across / radius;
      std::complex<double> power = 1.0;
      for (std::size_t m = 0; m < masses.size(); ++m) {
        power *= turn;
        masses[m] += share * power;
        stiffnesses[m] += modulus * point.volume * power;
      }
    });
  }
  Roundness found;
  found.eccentricity = std::abs(arm) / mass;
  for (int m = 1; m <= num_harmonics; ++m) {
    const auto k = static_cast<std::size_t>(m - 1);
    found.harmonics.push_back(
        std::max(std::abs(masses[k]) / mass, std::abs(stiffnesses[k]) / stiffness));
    if (found.harmonics.back() > negligible) found.num_sectors = std::gcd(found.num_sectors, m);
  }
  return found;
}

std::vector<int> Roundness::without_sectors() const {
  if (num_sectors == 0 || num_sectors > 2) return {};
  std::vector<int> order(harmonics.size());
  std::iota(order.begin(), order.end(), 1);
  std::stable_sort(order.begin(), order.end(), [&](int a, int b) {
    return harmonics[static_cast<std::size_t>(a - 1)] > harmonics[static_cast<std::size_t>(b - 1)];
  });
  std::vector<int> found;
  int sectors = 0;
  for (const int m : order) {
    const int left = std::gcd(sectors, m);
    if (left == sectors) continue;  // fits those before
    sectors = left;
    found.push_back(m);
    if (sectors <= 2) break;
  }
  return found;
}

}  // namespace stridor
