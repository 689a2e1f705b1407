// What scenes must know of a normal law.
#pragma once

#include <string>
#include <vector>

#include "core/schema.hpp"

namespace stridor {

struct NormalParameters;
struct SubstrateContact;

/// A number that a law takes. Laws may share a key, which is then declared in the same way.
struct NormalKey {
  std::string name;
  RealKey says;
  bool is_required = true;
};

/// A normal law that scenes can name: the gap closed exactly, a spring, or a force law of an
/// indenter on a half-space. A new one is registered in normal_laws.cpp; nothing else names it.
struct NormalLawType {
  std::string name;             ///< the word by which scenes call it
  std::string doc;              ///< what it makes of its keys
  std::vector<NormalKey> keys;  ///< its numbers
  /// Which of the keys profile, material, form and solver it takes besides.
  std::vector<std::string> other_keys{};
  /// The key that is the stiffness of a spring in the place of gap = 0, N/m; empty where there is
  /// none.
  std::string spring{};
  /// Force, area and friction of the indenter in SI units, without friction of the interface; null
  /// of a law without area. Such a law takes the master half_space, sticks, slips and lifts off.
  /// @throws std::invalid_argument if it needs what has not been read or computed
  SubstrateContact (*make_contact)(const NormalParameters& parameters) = nullptr;
  bool has_friction = false;  ///< the force law has friction of its own
  /// What must hold between its keys, besides that it has those it requires and no other; adds to
  /// the list. May be null.
  void (*check)(const NormalParameters& parameters, std::vector<Problem>& problems) = nullptr;

  bool has_area() const { return make_contact != nullptr; }
};

/// All laws that scenes can name; the first is that of a scene that names none.
const std::vector<NormalLawType>& normal_law_types();
/// @throws std::out_of_range if there is none of the name
const NormalLawType& normal_law_type(const std::string& name);
/// Names of those for which `wanted` holds, joined by "or".
std::string normal_laws_with(bool (*wanted)(const NormalLawType& law));

/// Keys that several laws have.
NormalKey preload_key();
NormalKey indenter_radius_key(bool is_required);
NormalKey half_space_modulus_key(bool is_required);

}  // namespace stridor
