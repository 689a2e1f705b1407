// A disc between two pads, assembled for such discs alone: a second formulation of what a System of
// bodies with contacts on faces is.
#pragma once

#include <vector>

#include "substructures/matrices/linear_system.hpp"
#include "tests/support/disc_parameters.hpp"
#include "tests/support/face_contact.hpp"

namespace stridor {

/// A disc with pads, and its small motion about steady sliding.
struct DiscModel {
  LinearSystem bodies;                ///< without contact: of the plate, then of each pad (PadBody)
  std::vector<FaceContact> contacts;  ///< those of the pad on the face of larger z come first
  FaceContactLaw law;
  FaceSlidingState state;  ///< about which motion is small
  LinearSystem system;     ///< of this motion
  /// Hz: the lowest mode of the plate that is left out, or half the highest that is kept of a pad.
  double highest_frequency = 0.0;
};

/// Assembles the linearised equations (docs/theory.md, 10.3; HS (21), (26)).
///
/// The sliding state is that of the undeformed bodies with the preload of the scene, or follows
/// from what presses the pads. With Lagrange multipliers the closed contacts are constraints; with
/// a penalty their forces are k_C times the gap. The disc has the modes of its plate; its material
/// damping acts on what a particle sees, ∂q/∂t + Ω S q, where the gyroscopic terms are kept.
///
/// @throws std::invalid_argument if a radius is off the plate, pads have not either a mass or an
/// elastic body, contacts not either a preload or a piston behind them, a penalty is missing, or
/// friction damping is wanted at no speed; as make_elastic_pad()
/// @throws NumericalError if pads that are pressed on have no state of steady sliding
DiscModel make_disc_model(const DiscModelParameters& parameters);

/// A pad, rigid or elastic.
PadBody make_pad(const PadsParameters& pads, const std::vector<double>& offsets);

}  // namespace stridor
