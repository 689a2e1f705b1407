// The force law of an indenter on a viscoelastic half-space, as scenes name it.
#pragma once

#include <memory>

#include "coupling/laws/normal_law_type.hpp"
#include "coupling/laws/viscoelastic_law.hpp"

namespace stridor {

/// The laws that the program has built in.
enum class SphereContactLaw { published_fit, boundary_element };

/// One of them.
std::shared_ptr<const ViscoelasticContactLaw> shipped_law(SphereContactLaw law);

/// F_k = E_0* R² F̃(y/R, v τ/R), with friction μ_v F_k of its own, of the `form` and from `profile`
/// or `radius`, `material` or `modulus` and `creep_time`.
NormalLawType viscoelastic_law_type();

}  // namespace stridor
