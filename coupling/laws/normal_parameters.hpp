// Normal laws of contacts in a scene.
#pragma once

#include <memory>
#include <optional>
#include <string>

#include "core/schema.hpp"
#include "coupling/laws/friction_law.hpp"
#include "coupling/laws/indenter_profile.hpp"
#include "coupling/laws/law_keys.hpp"
#include "coupling/laws/normal_law_type.hpp"
#include "coupling/laws/sliding_contact_parameters.hpp"
#include "coupling/laws/substrate_contact.hpp"
#include "substructures/elements/viscoelastic_material.hpp"

namespace stridor {

/// The normal law of a contact, with the numbers of the law that is chosen.
struct NormalParameters {
  static constexpr const char* published_fit = "published_fit";
  static constexpr const char* boundary_element = "boundary_element";
  static constexpr const char* solve = "solve";

  const NormalLawType* law = &normal_law_types().front();  ///< not null; lives for ever
  LawNumbers numbers;                                      ///< those of its keys
  std::optional<ProfileParameters> profile;      ///< the indenter, in the place of a radius
  std::optional<ViscoelasticMaterial> material;  ///< of the half-space, in the place of its numbers
  std::string form = published_fit;              ///< one of the three, or a file with a table
  std::optional<SlidingContactParameters> solver;  ///< of the form `solve`
  /// The law in that file; the reader of the scene reads it as well.
  std::shared_ptr<const ViscoelasticContactLaw> table;
  static const Schema& schema();

  /// A number that may be missing.
  std::optional<double> number(const std::string& key) const {
    const auto given = numbers.find(key);
    return given == numbers.end() ? std::nullopt : std::optional(given->second);
  }
  /// Whether the law takes one of the keys that are no numbers.
  bool takes(const std::string& key) const;
  /// Stiffness of the spring that the law is, N/m; nothing where it is none.
  std::optional<double> stiffness() const {
    return law->spring.empty() ? std::nullopt : number(law->spring);
  }
  bool has_table() const {
    return form != published_fit && form != boundary_element && form != solve && takes("form");
  }
  /// Whether its contacts are computed by boundary elements, one by one.
  bool is_solved() const { return form == solve && takes("form"); }

  /// The indenter on a half-space: `profile`, or the paraboloid of `radius`.
  ProfileParameters indenter() const;
  /// R of it, m.
  double tip_radius() const { return profile ? profile->radius : numbers.at("radius"); }
  /// E_0* of the half-space, Pa.
  double composite_modulus() const {
    return material ? material->composite_modulus() : numbers.at("modulus");
  }
  /// τ_1 of the half-space, s.
  double first_creep_time() const {
    return material ? material->creep_times.front() : numbers.at("creep_time");
  }
};

/// The contact of a law with an area in SI units: its force F_k, friction μ_v F_k + τ_0 A + μ(v)
/// F_k.
///
/// @param friction τ_0 and μ(v) of the interface, besides the viscoelastic friction μ_v
/// @throws std::invalid_argument as NormalLawType::make_contact
SubstrateContact make_substrate_contact(const NormalParameters& parameters,
                                        const FrictionLaw& friction = {});

}  // namespace stridor
