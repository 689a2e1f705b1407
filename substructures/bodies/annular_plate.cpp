#include "substructures/bodies/annular_plate.hpp"

#include <fmt/format.h>

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <stdexcept>

namespace stridor {
namespace {

/// Ritz functions R_k at one radius and their derivatives by r.
struct RadialBasis {
  Eigen::VectorXd value, first, second;
};

RadialBasis radial_basis(const AnnularPlateParameters& plate, double radius) {
  const double width = plate.outer_radius - plate.inner_radius;
  const double x = (radius - plate.inner_radius) / width;
  const double z = 2.0 * x - 1.0;
  const Eigen::Index size = plate.radial_terms;
  // Legendre polynomials with their derivatives by z, by their three-term recurrence.
  Eigen::VectorXd p(size), dp(size), ddp(size);
  p(0) = 1.0;
  dp(0) = ddp(0) = 0.0;
  if (size > 1) {
    p(1) = z;
    dp(1) = 1.0;
    ddp(1) = 0.0;
  }
  for (Eigen::Index k = 1; k + 1 < size; ++k) {
    const auto n = static_cast<double>(k);
    p(k + 1) = ((2.0 * n + 1.0) * z * p(k) - n * p(k - 1)) / (n + 1.0);
    dp(k + 1) = dp(k - 1) + (2.0 * n + 1.0) * p(k);
    ddp(k + 1) = ddp(k - 1) + (2.0 * n + 1.0) * dp(k);
  }
  dp *= 2.0;
  ddp *= 4.0;
  RadialBasis basis;
  basis.value = x * x * p;
  basis.first = (2.0 * x * p + x * x * dp) / width;
  basis.second = (2.0 * p + 4.0 * x * dp + x * x * ddp) / (width * width);
  return basis;
}

struct QuadraturePoint {
  double at = 0.0, weight = 0.0;
};

/// Gauss-Legendre points of an interval.
std::vector<QuadraturePoint> gauss_legendre(int count, double from, double to) {
  std::vector<QuadraturePoint> points;
  for (int i = 0; i < count; ++i) {
    double z = std::cos(std::numbers::pi * (i + 0.75) / (count + 0.5));
    double slope = 0.0;
    for (int iteration = 0; iteration < 100; ++iteration) {
      double p = 1.0;
      double before = 0.0;
      for (int k = 1; k <= count; ++k) {
        const double next = ((2.0 * k - 1.0) * z * p - (k - 1.0) * before) / k;
        before = p;
        p = next;
      }
      slope = count * (z * p - before) / (z * z - 1.0);
      const double correction = p / slope;
      z -= correction;
      if (std::abs(correction) < 1e-16) break;
    }
    points.push_back(
        {0.5 * (from + to) + 0.5 * (to - from) * z, (to - from) / ((1.0 - z * z) * slope * slope)});
  }
  return points;
}

/// Mass-normalised radial modes of one number of nodal diameters, lowest first.
struct RadialModes {
  Eigen::VectorXd omega;
  Eigen::MatrixXd shapes;
};

RadialModes radial_modes(const AnnularPlateParameters& plate, double prestress_speed, int n) {
  const MaterialParameters& material = plate.material;
  const double h = plate.thickness;
  const double nu = material.poissons_ratio;
  const double bending = material.youngs_modulus * h * h * h / (12.0 * (1.0 - nu * nu));
  const double around = (n == 0 ? 2.0 : 1.0) * std::numbers::pi;  // ∫ cos² nφ dφ
  const double n2 = static_cast<double>(n) * n;
  const Eigen::Index size = plate.radial_terms;
  Eigen::MatrixXd mass = Eigen::MatrixXd::Zero(size, size);
  Eigen::MatrixXd stiffness = Eigen::MatrixXd::Zero(size, size);
  // Exact for the polynomials, and for their quotients by r to rounding.
  const int num_points = 2 * plate.radial_terms + 48;
  for (const QuadraturePoint& point :
       gauss_legendre(num_points, plate.inner_radius, plate.outer_radius)) {
    const double r = point.at;
    const RadialBasis basis = radial_basis(plate, r);
    const Eigen::VectorXd radial = basis.second;
    const Eigen::VectorXd circumferential = basis.first / r - n2 * basis.value / (r * r);
    const Eigen::VectorXd twist = n * (basis.first / r - basis.value / (r * r));
    const double weight = around * point.weight * r;
    mass += weight * material.density * h * basis.value * basis.value.transpose();
    stiffness +=
        weight * bending *
        (radial * radial.transpose() + circumferential * circumferential.transpose() +
         nu * (radial * circumferential.transpose() + circumferential * radial.transpose()) +
         2.0 * (1.0 - nu) * twist * twist.transpose());
    if (prestress_speed == 0.0) continue;
    const MembraneStress stress = centrifugal_stress(plate, prestress_speed, r);
    stiffness += weight * h *
                 (stress.radial * basis.first * basis.first.transpose() +
                  stress.circumferential * n2 / (r * r) * basis.value * basis.value.transpose());
  }
  const Eigen::GeneralizedSelfAdjointEigenSolver<Eigen::MatrixXd> modes(stiffness, mass);
  return {modes.eigenvalues().cwiseSqrt(), modes.eigenvectors()};
}

void check(const AnnularPlateParameters& plate) {
  const auto reject = [](const std::string& message) {
    throw std::invalid_argument("annular plate: " + message);
  };
  if (!(plate.inner_radius > 0.0 && plate.outer_radius > plate.inner_radius)) {
    reject(fmt::format("no annulus between radii {:g} and {:g} m", plate.inner_radius,
                       plate.outer_radius));
  }
  if (!(plate.thickness > 0.0)) reject(fmt::format("thickness {:g} m", plate.thickness));
  if (plate.nodal_diameters < 0) reject(fmt::format("{} nodal diameters", plate.nodal_diameters));
  if (plate.radial_modes < 1 || plate.radial_modes > plate.radial_terms) {
    reject(fmt::format("{} radial modes of {} terms", plate.radial_modes, plate.radial_terms));
  }
}

}  // namespace

const Schema& AnnularPlateParameters::schema() {
  using P = AnnularPlateParameters;
  static const Schema keys =
      SchemaOf<P>("annular_plate")
          .real("inner_radius", &P::inner_radius,
                {.doc = "Radius at which the plate is clamped.",
                 .unit = "m",
                 .range = Range::positive()})
          .real("outer_radius", &P::outer_radius,
                {.doc = "Radius of the free edge.", .unit = "m", .range = Range::positive()})
          .real("thickness", &P::thickness,
                {.doc = "Thickness of the plate.", .unit = "m", .range = Range::positive()})
          .section("material", &P::material, {.doc = "Linear elastic, isotropic."})
          .integer("nodal_diameters", &P::nodal_diameters,
                   {.doc = "Largest number of nodal diameters of the modes that are kept.",
                    .range = Range::between(0, 200)})
          .integer("radial_modes", &P::radial_modes,
                   {.doc = "Modes kept for every number of nodal diameters, lowest first.",
                    .optional = true,
                    .range = Range::between(1, 40)})
          .integer("radial_terms", &P::radial_terms,
                   {.doc = "Polynomials of the Ritz basis from which they are computed.",
                    .optional = true,
                    .range = Range::between(1, 40)})
          .check([](const P& plate, std::vector<Problem>& problems) {
            if (plate.outer_radius <= plate.inner_radius) {
              problems.push_back(
                  {Refusal::wrong_value, "outer_radius",
                   fmt::format("must be larger than inner_radius = {:g} m, got {:g} m",
                               plate.inner_radius, plate.outer_radius)});
            }
            if (plate.radial_modes > plate.radial_terms) {
              problems.push_back({Refusal::wrong_value, "radial_modes",
                                  fmt::format("must not exceed radial_terms = {}, got {}",
                                              plate.radial_terms, plate.radial_modes)});
            }
          });
  return keys;
}

MembraneStress centrifugal_stress(const AnnularPlateParameters& plate, double speed,
                                  double radius) {
  const double nu = plate.material.poissons_ratio;
  const double a = plate.inner_radius;
  const double b = plate.outer_radius;
  // u = A r + B/r − C r³ with u(a) = 0 and no radial stress at b; stresses over E/(1 − ν²).
  const double plane = plate.material.youngs_modulus / (1.0 - nu * nu);
  const double C = plate.material.density * speed * speed / (8.0 * plane);
  const double B = C * ((3.0 + nu) * b * b - (1.0 + nu) * a * a) /
                   (-(1.0 + nu) / (a * a) - (1.0 - nu) / (b * b));
  const double A = C * a * a - B / (a * a);
  const double r2 = radius * radius;
  return {plane * ((1.0 + nu) * A - (1.0 - nu) * B / r2 - (3.0 + nu) * C * r2),
          plane * ((1.0 + nu) * A + (1.0 - nu) * B / r2 - (1.0 + 3.0 * nu) * C * r2)};
}

AnnularPlate::AnnularPlate(const AnnularPlateParameters& plate, double prestress_speed)
    : plate_(plate) {
  check(plate);
  std::vector<double> omega;
  lowest_omitted_ = std::numeric_limits<double>::infinity();
  for (int n = 0; n <= plate.nodal_diameters + 1; ++n) {
    const RadialModes modes = radial_modes(plate, prestress_speed, n);
    const int num_kept = n <= plate.nodal_diameters ? plate.radial_modes : 0;
    for (int j = 0; j < num_kept; ++j) {
      for (const bool is_sine : {false, true}) {
        if (n == 0 && is_sine) continue;
        coordinates_.push_back({n, is_sine, modes.shapes.col(j)});
        omega.push_back(modes.omega(j));
      }
    }
    if (num_kept < plate.radial_terms)
      lowest_omitted_ = std::min(lowest_omitted_, modes.omega(num_kept));
  }
  omega_ = Eigen::Map<Eigen::VectorXd>(omega.data(), static_cast<Eigen::Index>(omega.size()));
}

Eigen::MatrixXd AnnularPlate::spin() const {
  Eigen::MatrixXd S = Eigen::MatrixXd::Zero(size(), size());
  for (Eigen::Index i = 0; i + 1 < size(); ++i) {
    const Coordinate& cosine = coordinates_[static_cast<std::size_t>(i)];
    if (cosine.is_sine || cosine.nodal_diameters == 0) continue;
    S(i, i + 1) = cosine.nodal_diameters;
    S(i + 1, i) = -cosine.nodal_diameters;
  }
  return S;
}

PlateRows AnnularPlate::rows(double radius, double angle) const {
  const RadialBasis basis = radial_basis(plate_, radius);
  PlateRows rows;
  for (Eigen::VectorXd* row : {&rows.w, &rows.w_r, &rows.w_phi, &rows.w_r_phi, &rows.w_phi_phi})
    row->resize(size());
  for (Eigen::Index i = 0; i < size(); ++i) {
    const Coordinate& coordinate = coordinates_[static_cast<std::size_t>(i)];
    const double n = coordinate.nodal_diameters;
    const double cosine = std::cos(n * angle);
    const double sine = std::sin(n * angle);
    const double shape = coordinate.is_sine ? sine : cosine;
    const double derivative = coordinate.is_sine ? n * cosine : -n * sine;
    const double R = basis.value.dot(coordinate.shape);
    const double R_r = basis.first.dot(coordinate.shape);
    rows.w(i) = R * shape;
    rows.w_r(i) = R_r * shape;
    rows.w_phi(i) = R * derivative;
    rows.w_r_phi(i) = R_r * derivative;
    rows.w_phi_phi(i) = -n * n * R * shape;
  }
  return rows;
}

}  // namespace stridor
