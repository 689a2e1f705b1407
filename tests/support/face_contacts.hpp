// Contacts on the faces of a plate, in a brake that squeals and one by one.
#pragma once

#include <algorithm>
#include <complex>

#include "solvers/eigenvalues/dense_eigenvalues.hpp"
#include "tests/support/face_contact.hpp"
#include "tests/support/reference_brake.hpp"

namespace stridor::test {

/// The reference brake with friction far beyond its limit, by a penalty.
inline DiscModelParameters squealing_brake() {
  DiscModelParameters brake = reference_brake(
      {"gyroscopic", "friction", "friction_damping", "geometric", "structural_damping"});
  brake.disc.damping.beta = brake.pads.damping.beta = 1e-7;
  brake.contact.friction.coefficient = 0.45;
  brake.contact.formulation = ContactFormulation::penalty;
  brake.contact.penalty = 1e10;
  return brake;
}

/// With three points on each of two elastic pads.
inline DiscModelParameters with_elastic_pads(DiscModelParameters brake) {
  brake.pads.mass.reset();
  ElasticPadParameters& pad = brake.pads.elastic.emplace();
  pad.length = 0.06;
  pad.thickness = 0.015;
  pad.width = 0.04;
  pad.material = {1e10, 0.3, 2500.0};
  pad.mesh = {6, 2};
  pad.reduction.fixed_interface_modes = 8;
  brake.contact.offsets = {-0.03, 0.0, 0.03};
  return brake;
}

struct FastestMode {
  std::complex<double> s;
  Eigen::VectorXcd q;
};

inline FastestMode fastest_of(const LinearSystem& system) {
  const Pencil pencil = make_pencil(system);
  const DenseSpectrum spectrum = dense_spectrum(pencil);
  const auto fastest =
      std::max_element(spectrum.eigenvalues.begin(), spectrum.eigenvalues.end(),
                       [](const auto& a, const auto& b) { return a.growth() < b.growth(); });
  const Eigen::VectorXcd q =
      pencil.ports * spectrum.right.col(fastest - spectrum.eigenvalues.begin());
  // Its largest entry is 1: neither size nor phase depend on the eigensolver.
  Eigen::Index largest = 0;
  q.cwiseAbs().maxCoeff(&largest);
  return {fastest->s, q / q(largest)};
}

/// On a pad alone, with coordinates along (none if negative) and away from the plate, which is
/// flat.
inline FaceContact contact_of(Eigen::Index n, Eigen::Index along, Eigen::Index normal) {
  FaceContact contact;
  const Eigen::VectorXd none = Eigen::VectorXd::Zero(n);
  contact.plate = {none, none, none, none, none};
  contact.pad_r = contact.pad_phi = contact.pad_z = none;
  if (along >= 0) contact.pad_phi(along) = 1.0;
  contact.pad_z(normal) = 1.0;
  contact.radius = 1.0;
  return contact;
}

}  // namespace stridor::test
