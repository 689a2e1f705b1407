// From the keys of `sphere` to an oscillator on a sliding viscoelastic substrate.
#pragma once

#include <memory>
#include <optional>
#include <string>

#include "core/schema.hpp"
#include "coupling/normal_parameters.hpp"
#include "solvers/substrate_oscillator.hpp"

namespace stridor {

/// A sphere on springs and dampers that is pressed against a sliding substrate (PPH, Fig. 2). The
/// parameters of its motion are given dimensionless or, instead, by its dimensional twin.
struct SphereParameters {
  double stiffness_x = 0.0;        ///< k_x, N/m
  double natural_frequency = 0.0;  ///< ω_nx = √(k_x/m), rad/s
  double radius = 0.0;             ///< R, m
  double modulus = 0.0;            ///< E_0*, Pa
  double creep_time = 0.0;         ///< τ, s

  std::optional<double> normal_load;         ///< F̃_n = F_n/(E_0* R²)
  std::optional<double> normal_force;        ///< F_n, N
  std::optional<double> shear_strength;      ///< τ̃_0 = τ_0/E_0*
  std::optional<double> shear_stress;        ///< τ_0, Pa
  std::optional<double> speed;               ///< v̂_d = v_d τ/R
  std::optional<double> substrate_speed;     ///< v_d, m/s
  std::optional<double> frequency_ratio;     ///< Ω = ω_ny/ω_nx
  std::optional<double> stiffness_y;         ///< k_y, N/m
  std::optional<double> coupling_ratio;      ///< η = ω_nxy/ω_nx
  std::optional<double> coupling_stiffness;  ///< k_xy, N/m
  double angle = 0.0;                        ///< α, of the coupling spring, rad
  std::optional<double> damping_x;           ///< ξ_x = c_x/(2 √(k_x m))
  std::optional<double> damper_x;            ///< c_x, N s/m
  std::optional<double> damping_y;           ///< ξ_y as PPH (12) has it: c_y/(2 √(k_x m))
  std::optional<double> damper_y;            ///< c_y, N s/m
  static const Schema& schema();
};

/// Friction that only resembles the set-valued one, to see the effect.
struct RegularisationParameters {
  RegularisedSign::Kind law = RegularisedSign::Kind::none;
  std::optional<double> speed;  ///< v_ε/v_d
  static const Schema& schema();
};

/// The part of a scene that describes the mechanics of the oscillator.
struct SphereModelParameters {
  static constexpr const char* published_fit = "published_fit";
  static constexpr const char* boundary_element = "boundary_element";

  SphereParameters sphere;
  std::string contact_law = published_fit;  ///< one of the two, or a file with a table
  /// The law in that file; the reader of the scene reads it as well.
  std::shared_ptr<const ViscoelasticContactLaw> table;
  FrictionLoad friction_normal_force = FrictionLoad::applied;
  RegularisationParameters regularisation;
  SmallMotionTerms small_motion = SmallMotionTerms::all;
  static const Schema& schema();

  bool has_table() const { return contact_law != published_fit && contact_law != boundary_element; }
};

/// The dimensionless numbers of PPH (9) to (11), and the units that they are measured in.
struct SphereNumbers {
  double normal_load = 0.0;      ///< F̃_n
  double shear_strength = 0.0;   ///< τ̃_0
  double speed = 0.0;            ///< v̂_d
  double frequency_ratio = 0.0;  ///< Ω
  double coupling_ratio = 0.0;   ///< η
  double damping_x = 0.0;        ///< ξ_x
  double damping_y = 0.0;        ///< ξ_y of (12)
  double radius_ratio = 0.0;     ///< R̃ = R/x_0
  double time_ratio = 0.0;       ///< τ̃ = ω_nx τ
  double length_unit = 0.0;      ///< x_0 = F_n/k_x, m
  double time_unit = 0.0;        ///< 1/ω_nx, s
  double force_unit = 0.0;       ///< F_n, N
  /// c_y/(2 √(k_y m)), the damping ratio of the vertical motion by itself: ξ_y/Ω.
  std::optional<double> vertical_damping_ratio;
};

SphereNumbers sphere_numbers(const SphereParameters& parameters);

/// PPH (12), corrected (docs/theory.md, 9.1): displacements over x_0, times ω_nx, forces over F_n.
/// @throws std::invalid_argument if the table of a contact law has not been read
SubstrateOscillator make_sphere(const SphereModelParameters& parameters);

}  // namespace stridor
