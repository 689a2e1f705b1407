#include "substructures/elements/q8_element.hpp"

#include <Eigen/LU>
#include <array>
#include <cmath>
#include <stdexcept>

namespace stridor {
namespace {

constexpr std::array<double, 8> node_xi{-1, 1, 1, -1, 0, 1, 0, -1};
constexpr std::array<double, 8> node_eta{-1, -1, 1, 1, -1, 0, 1, 0};

struct Q8Shape {
  Eigen::Matrix<double, 8, 1> value;
  Eigen::Matrix<double, 8, 2> gradient;  // with respect to (ξ, η)
};

Q8Shape q8_shape(double xi, double eta) {
  Q8Shape shape;
  for (int i = 0; i < 8; ++i) {
    const double a = node_xi[static_cast<std::size_t>(i)];
    const double b = node_eta[static_cast<std::size_t>(i)];
    if (i < 4) {
      shape.value(i) = 0.25 * (1 + a * xi) * (1 + b * eta) * (a * xi + b * eta - 1);
      shape.gradient(i, 0) = 0.25 * a * (1 + b * eta) * (2 * a * xi + b * eta);
      shape.gradient(i, 1) = 0.25 * b * (1 + a * xi) * (a * xi + 2 * b * eta);
    } else if (a == 0.0) {
      shape.value(i) = 0.5 * (1 - xi * xi) * (1 + b * eta);
      shape.gradient(i, 0) = -xi * (1 + b * eta);
      shape.gradient(i, 1) = 0.5 * b * (1 - xi * xi);
    } else {
      shape.value(i) = 0.5 * (1 + a * xi) * (1 - eta * eta);
      shape.gradient(i, 0) = 0.5 * a * (1 - eta * eta);
      shape.gradient(i, 1) = -eta * (1 + a * xi);
    }
  }
  return shape;
}

}  // namespace

Q8Element make_q8_element(const Q8Nodes& nodes, const ElasticMaterial& material, double width) {
  const double nu = material.poissons_ratio;
  Eigen::Matrix3d elasticity;
  elasticity << 1, nu, 0, nu, 1, 0, 0, 0, 0.5 * (1 - nu);
  elasticity *= material.youngs_modulus / (1 - nu * nu);

  const double g = std::sqrt(0.6);
  const std::array<double, 3> points{-g, 0.0, g};
  const std::array<double, 3> weights{5.0 / 9.0, 8.0 / 9.0, 5.0 / 9.0};

  Q8Element element{Q8Matrix::Zero(), Q8Matrix::Zero()};
  for (std::size_t i = 0; i < 3; ++i) {
    for (std::size_t j = 0; j < 3; ++j) {
      const Q8Shape shape = q8_shape(points[i], points[j]);
      const Eigen::Matrix2d jacobian = shape.gradient.transpose() * nodes;
      const double determinant = jacobian.determinant();
      if (!(determinant > 0.0)) {
        throw std::invalid_argument(
            "make_q8_element: the element is degenerate or turned inside out");
      }
      const Eigen::Matrix<double, 8, 2> gradient = shape.gradient * jacobian.inverse().transpose();
      const double weight = weights[i] * weights[j] * determinant * width;

      Eigen::Matrix<double, 3, 16> strain = Eigen::Matrix<double, 3, 16>::Zero();
      Eigen::Matrix<double, 2, 16> interpolation = Eigen::Matrix<double, 2, 16>::Zero();
      for (int k = 0; k < 8; ++k) {
        strain(0, 2 * k) = gradient(k, 0);
        strain(1, 2 * k + 1) = gradient(k, 1);
        strain(2, 2 * k) = gradient(k, 1);
        strain(2, 2 * k + 1) = gradient(k, 0);
        interpolation(0, 2 * k) = interpolation(1, 2 * k + 1) = shape.value(k);
      }
      element.stiffness += weight * strain.transpose() * elasticity * strain;
      element.mass += weight * material.density * interpolation.transpose() * interpolation;
    }
  }
  return element;
}

}  // namespace stridor
