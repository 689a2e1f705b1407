// Pencils with known eigenvalues, and random ones.
#pragma once

#include <Eigen/Core>
#include <complex>
#include <random>

#include "solvers/pencil.hpp"

namespace stridor::test {

/// Two unit masses without constraint: q̈ + diag(d) q̇ + diag(k) q + G q + H q̇ = 0.
inline Pencil two_masses(const Eigen::Vector2d& stiffness, const Eigen::Vector2d& damping) {
  Pencil pencil;
  pencil.omega = stiffness.cwiseSqrt();
  pencil.damping = damping;
  pencil.slots = Eigen::Matrix2d::Identity();
  pencil.compatibility.resize(0, 2);
  pencil.equilibrium.resize(0, 2);
  return pencil;
}

/// Circulatory coupling of two_masses(): [[0, p], [−p, 0]].
inline Eigen::MatrixXd circulatory(double p) {
  return Eigen::Matrix2d{{0.0, p}, {-p, 0.0}};
}

/// Modes with one constraint and slots of which each is a mode: rows of B_C and B_E as given.
inline Pencil constrained_modes(const Eigen::VectorXd& omega, const Eigen::VectorXd& damping,
                                const Eigen::MatrixXd& compatibility,
                                const Eigen::MatrixXd& equilibrium) {
  Pencil pencil;
  pencil.omega = omega;
  pencil.damping = damping;
  pencil.slots = Eigen::MatrixXd::Identity(omega.size(), omega.size());
  pencil.compatibility = compatibility;
  pencil.equilibrium = equilibrium;
  return pencil;
}

enum class ContactTerms { rows_only, with_stiffness, with_stiffness_and_damping };

/// n modes from 1 to 1000 rad/s, a damping ratio of at most 1 %, k contacts of six slots with
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
  pencil.slots = matrix(m, n);
  pencil.compatibility = matrix(k, m);
  pencil.equilibrium = pencil.compatibility + 0.3 * matrix(k, m);
  if (terms != ContactTerms::rows_only)
    pencil.slot_stiffness = 0.1 * matrix(m, 2 * k) * matrix(2 * k, m);
  if (terms == ContactTerms::with_stiffness_and_damping)
    pencil.slot_damping = 1e-4 * matrix(m, 2 * k) * matrix(2 * k, m);
  return pencil;
}

/// P(s) = s² + s (diag(c) + SᵀHS) + diag(ω²) + SᵀGS.
inline Eigen::MatrixXcd dynamic_stiffness(const Pencil& pencil, std::complex<double> s) {
  const Eigen::Index n = pencil.num_modes();
  Eigen::MatrixXcd P = Eigen::MatrixXcd::Zero(n, n);
  P.diagonal() = (s * s + s * pencil.damping.array().cast<std::complex<double>>() +
                  pencil.omega.array().square().cast<std::complex<double>>())
                     .matrix();
  if (pencil.slot_stiffness.size() > 0)
    P += pencil.slots.transpose() * pencil.slot_stiffness * pencil.slots;
  if (pencil.slot_damping.size() > 0)
    P += s * (pencil.slots.transpose() * pencil.slot_damping * pencil.slots);
  return P;
}

}  // namespace stridor::test
