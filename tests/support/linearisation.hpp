// Assumptions, terms and single eigenvalues for tests of linearised contacts.
#pragma once

#include <gtest/gtest.h>

#include <Eigen/LU>
#include <array>
#include <cmath>
#include <complex>
#include <numbers>

#include "solvers/eigenvalues/pencil.hpp"
#include "solvers/equilibrium/contact_linearisation.hpp"

namespace stridor::test {

/// The rows of the contacts alone.
inline constexpr LinearisationTerms no_terms{false, false, false, false, false, false};

/// Of a point on a line.
inline constexpr std::array all_assumptions{ContactAssumption::subs_a, ContactAssumption::subs_b,
                                            ContactAssumption::subs_c, ContactAssumption::film};

/// The determinant whose zeros are the eigenvalues: 1 + Z(G + s H), Z B_Eᵀ; B_C, 0 with
/// Z = S diag(1/(s² + c s + ω²)) Sᵀ.
inline std::complex<double> characteristic(const Pencil& pencil, std::complex<double> s) {
  using Complex = std::complex<double>;
  const Eigen::Index m = pencil.num_ports();
  const Eigen::Index k = pencil.num_constraints();
  const Eigen::VectorXcd inverse = (s * s + s * pencil.damping.array().cast<Complex>() +
                                    pencil.omega.array().square().cast<Complex>())
                                       .inverse();
  const Eigen::MatrixXcd ports = pencil.ports.cast<Complex>();
  const Eigen::MatrixXcd receptance = ports * inverse.asDiagonal() * ports.transpose();
  Eigen::MatrixXcd forces = Eigen::MatrixXcd::Zero(m, m);
  if (pencil.port_stiffness.size() > 0) forces += pencil.port_stiffness.cast<Complex>();
  if (pencil.port_damping.size() > 0) forces += s * pencil.port_damping.cast<Complex>();
  Eigen::MatrixXcd matrix(m + k, m + k);
  matrix << Eigen::MatrixXcd::Identity(m, m) + receptance * forces,
      receptance * pencil.equilibrium.transpose().cast<Complex>(),
      pencil.compatibility.cast<Complex>(), Eigen::MatrixXcd::Zero(k, k);
  return matrix.determinant();
}

/// The eigenvalue next to a guess, by the secant method.
inline std::complex<double> eigenvalue_near(const Pencil& pencil, std::complex<double> guess) {
  using Complex = std::complex<double>;
  Complex last = guess * Complex(1.0, 1e-5);
  Complex here = guess;
  Complex value_last = characteristic(pencil, last);
  for (int k = 0; k < 60; ++k) {
    const Complex value = characteristic(pencil, here);
    if (value == value_last) break;
    const Complex step = value * (here - last) / (value - value_last);
    last = here;
    value_last = value;
    here -= step;
    if (std::abs(step) < 1e-12 * std::abs(here)) return here;
  }
  ADD_FAILURE() << "no eigenvalue found near " << guess;
  return here;
}

/// The eigenvalue of a growth in 1/s and a frequency in Hz.
inline std::complex<double> at_frequency(double growth, double hertz) {
  return {growth, 2.0 * std::numbers::pi * hertz};
}

}  // namespace stridor::test
