// Parameters of a viscoelastic substrate under a sphere in a scene.
#pragma once

#include <memory>

#include "core/schema.hpp"
#include "coupling/substrate_contact.hpp"

namespace stridor {

/// The law of the contact between a sphere and a substrate.
enum class SphereContactLaw { published_fit, boundary_element };

/// A law that the program has built in.
std::shared_ptr<const ViscoelasticContactLaw> shipped_law(SphereContactLaw law);

/// A slave point that carries a sphere, on a viscoelastic half-space.
struct SubstrateParameters {
  double radius = 0.0;          ///< R, m
  double modulus = 0.0;         ///< E_0*, Pa
  double creep_time = 0.0;      ///< τ, s
  double shear_strength = 0.0;  ///< τ̃_0 = τ_0/E_0*
  SphereContactLaw law = SphereContactLaw::published_fit;
  static const Schema& schema();
};

/// Its contact in SI units: F_k = E_0* R² F̃(y/R, v τ/R), friction μ F_k + τ_0 R² Ã.
SubstrateContact make_substrate_contact(const SubstrateParameters& parameters);

}  // namespace stridor
