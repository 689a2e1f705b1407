// Normal laws of contacts in a scene.
#pragma once

#include <memory>
#include <optional>
#include <string>

#include "core/schema.hpp"
#include "coupling/laws/friction_law.hpp"
#include "coupling/laws/indenter_profile.hpp"
#include "coupling/laws/sliding_contact_parameters.hpp"
#include "coupling/laws/substrate_contact.hpp"
#include "substructures/elements/viscoelastic_material.hpp"

namespace stridor {

/// The law of the contact between a sphere and a substrate.
enum class SphereContactLaw { published_fit, boundary_element };

/// A law that the program has built in.
std::shared_ptr<const ViscoelasticContactLaw> shipped_law(SphereContactLaw law);

enum class NormalLaw {
  multiplier,    ///< gap = 0 by a Lagrange multiplier
  penalty,       ///< a spring, λ_n = −k gap
  viscoelastic,  ///< a sphere on a viscoelastic half-space
};

/// The normal law of a contact, with the numbers of the law that is chosen.
struct NormalParameters {
  static constexpr const char* published_fit = "published_fit";
  static constexpr const char* boundary_element = "boundary_element";
  static constexpr const char* solve = "solve";

  NormalLaw law = NormalLaw::multiplier;
  std::optional<double> stiffness;           ///< k of a penalty, N/m, > 0
  /// Force of each contact in steady sliding of undeformed bodies, N, ≥ 0; of a multiplier or
  /// penalty on a face.
  std::optional<double> preload;
  std::optional<double> radius;              ///< R of the sphere at the slave point, m, > 0
  std::optional<ProfileParameters> profile;  ///< the indenter there, in the place of `radius`
  std::optional<double> modulus;             ///< E_0* of the half-space at frequency zero, Pa, > 0
  std::optional<double> creep_time;          ///< τ of the half-space, s, > 0
  /// Its material, in the place of `modulus` and `creep_time`.
  std::optional<ViscoelasticMaterial> material;
  std::string form = published_fit;                ///< one of the three, or a file with a table
  std::optional<SlidingContactParameters> solver;  ///< of the form `solve`
  /// The law in that file; the reader of the scene reads it as well.
  std::shared_ptr<const ViscoelasticContactLaw> table;
  static const Schema& schema();

  bool has_table() const {
    return law == NormalLaw::viscoelastic && form != published_fit && form != boundary_element &&
           form != solve;
  }
  /// Whether its contacts are computed by boundary elements, one by one.
  bool is_solved() const { return law == NormalLaw::viscoelastic && form == solve; }

  /// The indenter of a viscoelastic law: `profile`, or the paraboloid of `radius`.
  ProfileParameters indenter() const;
  /// R of it, m.
  double tip_radius() const { return profile ? profile->radius : radius.value(); }
  /// E_0* of the half-space, Pa.
  double composite_modulus() const {
    return material ? material->composite_modulus() : modulus.value();
  }
  /// τ_1 of the half-space, s.
  double first_creep_time() const {
    return material ? material->creep_times.front() : creep_time.value();
  }
};

/// The law of a viscoelastic contact.
/// @throws std::invalid_argument if it is of the form `solve`, or its table has not been read
std::shared_ptr<const ViscoelasticContactLaw> law_of(const NormalParameters& parameters);

/// The contact of a viscoelastic normal law in SI units:
/// F_k = E_0* R² F̃(y/R, v τ/R), friction μ_v F_k + τ_0 R² Ã + μ(v) F_k.
///
/// @param friction τ_0 and μ(v) of the interface, besides the viscoelastic friction μ_v
/// @throws std::invalid_argument as law_of()
SubstrateContact make_substrate_contact(const NormalParameters& parameters,
                                        const FrictionLaw& friction = {});

}  // namespace stridor
