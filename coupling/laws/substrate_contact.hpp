// Contact of a body with a sliding viscoelastic substrate, as a force law in the body's own units.
#pragma once

#include <memory>

#include "coupling/laws/friction_law.hpp"
#include "coupling/laws/regularised_sign.hpp"
#include "coupling/laws/viscoelastic_law.hpp"

namespace stridor {

/// The normal force that the viscoelastic friction coefficient is multiplied with.
enum class FrictionLoad {
  applied,  ///< F_n, as PPH (5) has it
  contact,  ///< F_k, that of the contact at this instant
};

/// Forces of the contact on the body, with their derivatives.
struct SubstrateForces {
  /// A force by the displacement into the substrate and by the slip velocity.
  struct Force {
    double value = 0.0;
    double by_indentation = 0.0;
    double by_slip = 0.0;
  };
  Force normal;      ///< pushes the body out
  Force tangential;  ///< along x; against the slip
  LawRange range = LawRange::inside;
  double indentation = 0.0;
};

/// F_k and F_µ of PPH (4), (5) in the units of the equations of motion (docs/theory.md, 9.1):
///
///   normal     =  n F̃_k(ŷ, |v̂|)
///   tangential = −σ (N μ(ŷ, |v̂|) + a Ã(ŷ, |v̂|) + μ_i(v) normal),  σ the direction of slip
///   ŷ = y/y_1,  v̂ = v/v_1
///
/// with N the applied load or the normal force of the contact, and μ_i the friction of the
/// interface where that is in proportion to the normal force. Out of contact (y <= 0) everything
/// vanishes. Regularised friction has s(v/v_ε) in the place of σ.
struct SubstrateContact {
  std::shared_ptr<const ViscoelasticContactLaw> law;
  double indentation_unit = 1.0;  ///< y_1: displacement that is ŷ = 1
  double speed_unit = 1.0;        ///< v_1: velocity that is v̂ = 1
  double force_unit = 1.0;        ///< n: force that is F̃_k = 1
  double shear = 0.0;             ///< a: friction per Ã by the interfacial shear
  double load = 0.0;              ///< the applied normal force
  FrictionLoad friction_load = FrictionLoad::applied;
  FrictionLaw interface_friction;  ///< μ_i; its own sign is not used
  RegularisedSign sign;

  /// @param indentation y; <= 0 out of contact
  /// @param slip        v, velocity of the body relative to the substrate
  /// @param direction   σ = ±1, on which side of v = 0 the contact slips; `slip` itself may be on
  ///                    the other side by rounding
  SubstrateForces at(double indentation, double slip, double direction) const;

  /// The forces at the indentation where the normal force is a given one: Newton's method on
  /// F_k^(2/3), which is nearly proportional to the indentation, within a bracket.
  /// @param normal > 0
  SubstrateForces under(double normal, double slip, double direction) const;

  /// Largest tangential force that keeps the contact sticking, a Ã(ŷ, 0) + μ_s n F̃_k(ŷ, 0), by the
  /// indentation. Only the friction of the interface has static strength, and none if friction is
  /// regularised.
  SubstrateForces::Force static_strength(double indentation) const;

  /// Area of the contact, in units of length of the indentation.
  double area(double indentation, double slip) const {
    return indentation_unit * indentation_unit *
           law->at(indentation / indentation_unit, slip / speed_unit).area.value;
  }

  /// Whether the body has sunk in by more than its radius, ŷ > 1. No law goes that far: they are of
  /// indentations that are small against the radius.
  bool is_sunk(double indentation) const { return indentation > indentation_unit; }
};

}  // namespace stridor
