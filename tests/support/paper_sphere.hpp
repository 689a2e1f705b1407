// The sphere of PPH (14) as an oscillator, by the dimensionless equations of the paper.
#pragma once

#include <cmath>
#include <numbers>

#include "coupling/laws/viscoelastic_normal_law.hpp"
#include "solvers/transient/substrate_oscillator.hpp"

namespace stridor::test {

/// Friction that only resembles the set-valued one.
struct PaperRegularisation {
  RegularisedSign::Kind law = RegularisedSign::Kind::none;
  double speed = 1.0;  ///< v_ε/v_d
};

/// The numbers of PPH (9) to (11), for k_x = 50 N/m, ω_nx = 40 rad/s, R = 10 mm,
/// E_0* = 4/3 MPa and τ = 10 ms.
struct PaperSphere {
  double normal_load = 7.5e-4;             ///< F̃_n = F_n/(E_0* R²)
  double shear_strength = 1e-2;            ///< τ̃_0 = τ_0/E_0*
  double speed = 5e-3;                     ///< v̂_d = v_d τ/R
  double frequency_ratio = 1.0;            ///< Ω = ω_ny/ω_nx
  double coupling_ratio = 1.0;             ///< η = ω_nxy/ω_nx
  double angle = 0.25 * std::numbers::pi;  ///< α, of the coupling spring
  double damping_x = 0.01;                 ///< ξ_x = c_x/(2 √(k_x m))
  double damping_y = 0.01;                 ///< ξ_y as PPH (12) has it: c_y/(2 √(k_x m))
  SphereContactLaw contact_law = SphereContactLaw::published_fit;
  FrictionLoad friction_normal_force = FrictionLoad::applied;
  PaperRegularisation regularisation;

  /// R̃ = R/x_0 with x_0 = F_n/k_x.
  double radius_ratio() const { return 50.0 / (4.0e6 / 3.0 * 0.01) / normal_load; }
  static constexpr double time_ratio = 0.4;  ///< τ̃ = ω_nx τ
};

/// @param speed, shear of PPH, chapter 5, where nothing else is said
inline PaperSphere paper_sphere(double speed = 5e-3, double shear = 1e-2) {
  PaperSphere sphere;
  sphere.shear_strength = shear;
  sphere.speed = speed;
  return sphere;
}

/// PPH (12), corrected (docs/theory.md, 9.1): displacements over x_0, times ω_nx, forces over F_n.
inline SubstrateOscillator make_sphere(const PaperSphere& sphere) {
  const double cosine = std::cos(sphere.angle);
  const double sine = std::sin(sphere.angle);
  const double spring = sphere.coupling_ratio * sphere.coupling_ratio;
  SubstrateOscillator oscillator;
  oscillator.damping.diagonal() << 2.0 * sphere.damping_x, 2.0 * sphere.damping_y;
  oscillator.stiffness << 1.0 + spring * cosine * cosine, spring * sine * cosine,
      spring * sine * cosine,
      sphere.frequency_ratio * sphere.frequency_ratio + spring * sine * sine;
  oscillator.load = {0.0, 1.0};
  SubstrateContact& contact = oscillator.contact;
  contact.law = shipped_law(sphere.contact_law);
  contact.indentation_unit = sphere.radius_ratio();
  contact.speed_unit = sphere.radius_ratio() / PaperSphere::time_ratio;
  contact.force_unit = 1.0 / sphere.normal_load;
  contact.shear = sphere.shear_strength / sphere.normal_load;
  contact.load = 1.0;
  contact.friction_load = sphere.friction_normal_force;
  oscillator.substrate_speed = sphere.speed * contact.speed_unit;
  contact.sign = {sphere.regularisation.law,
                  sphere.regularisation.speed * oscillator.substrate_speed};
  return oscillator;
}

}  // namespace stridor::test
