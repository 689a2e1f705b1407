// The disc with pads whose eigenvalues and limits an independent program has computed.
#pragma once

#include <string>
#include <utility>
#include <vector>

#include "solvers/eigenvalues/linear_pencil.hpp"
#include "tests/support/disc_model.hpp"

namespace stridor::test {

inline DiscModelParameters reference_brake(std::vector<std::string> terms) {
  DiscModelParameters brake;
  brake.disc.plate.inner_radius = 0.08;
  brake.disc.plate.outer_radius = 0.16;
  brake.disc.plate.thickness = 0.012;
  brake.disc.plate.material = {2.1e11, 0.3, 7850.0};
  brake.disc.plate.nodal_diameters = 6;
  brake.disc.speed = 10.0;
  brake.pads.mass = 0.25;
  brake.pads.stiffness = {6e7, 4e7, 1e8, 2e7};
  brake.pads.radius = 0.13;
  brake.contact.preload = 3000.0;
  brake.contact.friction.coefficient = 0.3;
  brake.terms = std::move(terms);
  return brake;
}

inline Pencil pencil_of(const DiscModelParameters& parameters) {
  return make_pencil(make_disc_model(parameters).system);
}

}  // namespace stridor::test
