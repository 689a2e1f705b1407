// The sphere of PPH (14).
#pragma once

#include <numbers>

#include "models/sphere.hpp"

namespace stridor::test {

/// @param speed, shear of PPH, chapter 5, where nothing else is said
inline SphereModelParameters paper_sphere(double speed = 5e-3, double shear = 1e-2) {
  SphereModelParameters model;
  SphereParameters& sphere = model.sphere;
  sphere.stiffness_x = 50.0;
  sphere.natural_frequency = 40.0;
  sphere.radius = 0.01;
  sphere.modulus = 4.0e6 / 3.0;
  sphere.creep_time = 0.01;
  sphere.normal_load = 7.5e-4;
  sphere.shear_strength = shear;
  sphere.speed = speed;
  sphere.frequency_ratio = 1.0;
  sphere.coupling_ratio = 1.0;
  sphere.angle = std::numbers::pi / 4.0;
  sphere.damping_x = 0.01;
  sphere.damping_y = 0.01;
  return model;
}

}  // namespace stridor::test
