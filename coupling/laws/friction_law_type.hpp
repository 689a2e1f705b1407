// What scenes must know of a friction law.
#pragma once

#include <string>
#include <vector>

#include "core/schema.hpp"
#include "coupling/laws/friction_law.hpp"
#include "coupling/laws/law_keys.hpp"

namespace stridor {

/// The numbers that a scene gives to a friction law, SI, by their keys.
using FrictionNumbers = LawNumbers;

/// A number that a law needs. Laws may share a key, which is then declared in the same way.
struct FrictionKey {
  std::string name;
  RealKey says;
  bool is_coefficient = false;  ///< a μ, of which no pair of solids has more than 100
};

/// A friction law that scenes can name. A new one is registered in friction_laws.cpp; nothing else
/// names it.
struct FrictionLawType {
  std::string name;               ///< the word by which scenes call it
  std::string doc;                ///< what it makes of its keys
  std::vector<FrictionKey> keys;  ///< it needs all of them
  FrictionLaw (*make)(const FrictionNumbers& numbers) = nullptr;
  /// What must hold between its numbers, of which some may be missing; adds to the list. May be
  /// null.
  void (*check)(const FrictionNumbers& numbers, std::vector<Problem>& problems) = nullptr;
  bool has_jump = false;  ///< μ(0) is not μ_s, so that a regularised contact would never have μ_s
  bool needs_area = false;  ///< in proportion to an area, which not every normal law has
};

/// All laws that scenes can name; the first is that of a scene that names none.
const std::vector<FrictionLawType>& friction_law_types();
/// @throws std::out_of_range if there is none of the name
const FrictionLawType& friction_law_type(const std::string& name);

/// `static` and `dynamic`, which several laws have.
FrictionKey static_coefficient_key();
FrictionKey dynamic_coefficient_key();

}  // namespace stridor
