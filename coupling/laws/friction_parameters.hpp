// The friction of a contact in a scene.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "core/schema.hpp"
#include "coupling/laws/friction_law_type.hpp"
#include "coupling/laws/substrate_contact.hpp"

namespace stridor {

/// Smooth friction in the place of the set-valued one, which it only resembles.
struct FrictionRegularisation {
  RegularisedSign::Kind law = RegularisedSign::Kind::tanh;
  double speed = 0.0;  ///< v_ε, m/s, > 0
  static const Schema& schema();
};

/// Coefficients hold once the drive's ramp has ended.
struct FrictionParameters {
  const FrictionLawType* law = &friction_law_types().front();  ///< not null; lives for ever
  FrictionNumbers numbers{};                                   ///< those of its keys
  /// What the viscoelastic friction coefficient of such a normal law is multiplied with.
  FrictionLoad viscoelastic = FrictionLoad::contact;
  std::optional<FrictionRegularisation> regularisation{};
  static const Schema& schema();
};

/// Adds a problem for a coefficient of friction that no pair of solids has, above 100.
void check_coefficient(const char* key, const std::optional<double>& coefficient,
                       std::vector<Problem>& problems);

/// The law of a section. @throws std::out_of_range if one of its numbers is missing
FrictionLaw make_friction_law(const FrictionParameters& parameters);

}  // namespace stridor
