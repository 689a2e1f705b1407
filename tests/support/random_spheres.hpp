// Spheres on viscoelastic substrates with random parameters.
#pragma once

#include <cmath>
#include <numbers>
#include <random>

#include "tests/support/paper_sphere.hpp"

namespace stridor::test {

/// Parameters over the whole range that a scene may ask for.
class RandomSpheres {
 public:
  explicit RandomSpheres(unsigned seed) : engine_(seed) {}

  PaperSphere next() {
    PaperSphere model = paper_sphere();
    PaperSphere& sphere = model;
    sphere.normal_load = power_of_ten(-7.0, -1.5);
    sphere.shear_strength = power_of_ten(-4.0, -0.5);
    sphere.speed = power_of_ten(-5.0, 1.0);
    sphere.frequency_ratio = uniform(0.3, 2.0);
    sphere.coupling_ratio = uniform(0.0, 1.5);
    sphere.angle = uniform(0.0, 0.5 * std::numbers::pi);
    sphere.damping_x = uniform(0.0, 0.1);
    sphere.damping_y = uniform(0.0, 0.1);
    model.contact_law = uniform(0.0, 1.0) < 0.5 ? SphereContactLaw::published_fit
                                                : SphereContactLaw::boundary_element;
    model.friction_normal_force =
        uniform(0.0, 1.0) < 0.5 ? FrictionLoad::applied : FrictionLoad::contact;
    return model;
  }

 private:
  double uniform(double low, double high) {
    return std::uniform_real_distribution<double>(low, high)(engine_);
  }
  double power_of_ten(double low, double high) { return std::pow(10.0, uniform(low, high)); }

  std::mt19937 engine_;
};

}  // namespace stridor::test
