// Pencils with known eigenvalues, and random ones.
#pragma once

#include <Eigen/Core>
#include <complex>
#include <random>

#include "solvers/eigenvalues/pencil.hpp"

namespace stridor::test {

/// Two unit masses without constraint: q̈ + diag(d) q̇ + diag(k) q + G q + H q̇ = 0.
inline Pencil two_masses(const Eigen::Vector2d& stiffness, const Eigen::Vector2d& damping) {
  Pencil pencil;
  pencil.omega = stiffness.cwiseSqrt();
  pencil.damping = damping;
  pencil.ports = Eigen::Matrix2d::Identity();
  pencil.compatibility.resize(0, 2);
  pencil.equilibrium.resize(0, 2);
  return pencil;
}

/// Circulatory coupling of two_masses(): [[0, p], [−p, 0]].
inline Eigen::MatrixXd circulatory(double p) {
  return Eigen::Matrix2d{{0.0, p}, {-p, 0.0}};
}

/// Modes with one constraint and ports of which each is a mode: rows of B_C and B_E as given.
inline Pencil constrained_modes(const Eigen::VectorXd& omega, const Eigen::VectorXd& damping,
                                const Eigen::MatrixXd& compatibility,
                                const Eigen::MatrixXd& equilibrium) {
  Pencil pencil;
  pencil.omega = omega;
  pencil.damping = damping;
  pencil.ports = Eigen::MatrixXd::Identity(omega.size(), omega.size());
  pencil.compatibility = compatibility;
  pencil.equilibrium = equilibrium;
  return pencil;
}

enum class ContactTerms { rows_only, with_stiffness, with_stiffness_and_damping };

/// n modes from 1 to 1000 rad/s, a damping ratio of at most 1 %, k contacts of six ports with
/// friction, and of G and H the terms asked for, of rank 2 per contact.
inline Pencil random_pencil(unsigned seed, Eigen::Index n, Eigen::Index k, ContactTerms terms) {
  std::mt19937 engine(seed);
  std::normal_distribution<double> normal;
  std::uniform_real_distribution<double> uniform;
  const auto matrix = [&](Eigen::Index rows, Eigen::Index columns) {
    return Eigen::MatrixXd(
        Eigen::MatrixXd::NullaryExpr(rows, columns, [&] { return normal(engine); }));
  };
  const Eigen::Index m = 6 * k;
  Pencil pencil;
  pencil.omega = Eigen::VectorXd::NullaryExpr(n, [&] { return std::pow(1000.0, uniform(engine)); });
  pencil.damping = Eigen::VectorXd::NullaryExpr(
      n, [&](Eigen::Index i) { return 0.02 * uniform(engine) * pencil.omega(i); });
  pencil.ports = matrix(m, n);
  pencil.compatibility = matrix(k, m);
  pencil.equilibrium = pencil.compatibility + 0.3 * matrix(k, m);
  if (terms != ContactTerms::rows_only)
    pencil.port_stiffness = 0.1 * matrix(m, 2 * k) * matrix(2 * k, m);
  if (terms == ContactTerms::with_stiffness_and_damping)
    pencil.port_damping = 1e-4 * matrix(m, 2 * k) * matrix(2 * k, m);
  return pencil;
}

/// random_pencil() of 3 to 40 modes and up to 3 contacts with what is awkward about some systems:
/// no damping, overdamped modes and modes that are fed, rigid modes, modes that coincide or almost,
/// modes that the contacts feel hardly or not at all, friction that nearly jams.
inline Pencil awkward_pencil(unsigned seed) {
  std::mt19937 engine(seed);
  std::uniform_real_distribution<double> uniform;
  const auto one_in = [&](unsigned count) { return engine() % count == 0; };
  const Eigen::Index k = 1 + engine() % 3;
  const Eigen::Index n = k + 2 + engine() % 35;
  const ContactTerms terms =
      one_in(2) ? ContactTerms::rows_only : static_cast<ContactTerms>(engine() % 3);
  Pencil pencil = random_pencil(seed, n, k, terms);
  switch (engine() % 4) {
    case 0:
      pencil.damping.setZero();
      break;
    case 1:
      for (double& c : pencil.damping) c = one_in(4) ? 2500.0 * uniform(engine) : c;
      break;
    case 2:
      for (double& c : pencil.damping) c = one_in(5) ? -c : c;
      break;
    default:
      break;
  }
  if (one_in(4)) {
    for (unsigned i = 0; i < 2; ++i) {
      const Eigen::Index mode = engine() % n;
      pencil.omega(mode) = 0.0;
      if (one_in(2)) pencil.damping(mode) = 0.0;
    }
  }
  if (one_in(3)) {
    const double apart = one_in(3) ? 0.0 : std::pow(10.0, -13.0 + 9.0 * uniform(engine));
    for (Eigen::Index i = 0; i + 1 < n; i += 2 + engine() % 5) {
      pencil.omega(i + 1) = pencil.omega(i) * (1.0 + apart);
      pencil.damping(i + 1) = pencil.damping(i);
    }
  }
  if (one_in(3)) {
    const double felt = one_in(3) ? 0.0 : std::pow(10.0, -14.0 + 11.0 * uniform(engine));
    for (Eigen::Index i = 0; i < n; ++i)
      if (one_in(3)) pencil.ports.col(i) *= felt;
  }
  if (one_in(3)) {
    const Pencil other = random_pencil(seed + 1, n, k, terms);
    pencil.equilibrium = pencil.compatibility + 10.0 * uniform(engine) * other.compatibility;
  }
  return pencil;
}

/// P(s) = s² + s (diag(c) + SᵀHS) + diag(ω²) + SᵀGS.
inline Eigen::MatrixXcd dynamic_stiffness(const Pencil& pencil, std::complex<double> s) {
  const Eigen::Index n = pencil.num_modes();
  Eigen::MatrixXcd P = Eigen::MatrixXcd::Zero(n, n);
  P.diagonal() = (s * s + s * pencil.damping.array().cast<std::complex<double>>() +
                  pencil.omega.array().square().cast<std::complex<double>>())
                     .matrix();
  if (pencil.port_stiffness.size() > 0)
    P += pencil.ports.transpose() * pencil.port_stiffness * pencil.ports;
  if (pencil.port_damping.size() > 0)
    P += s * (pencil.ports.transpose() * pencil.port_damping * pencil.ports);
  return P;
}

}  // namespace stridor::test
