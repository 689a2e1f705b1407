// From the keys of a scene of a disc with pads to the matrices of its small motion.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "core/schema.hpp"
#include "coupling/face_contact.hpp"
#include "substructures/annular_plate.hpp"
#include "substructures/linear_system.hpp"

namespace stridor {

/// C = α M + β K, constant in time.
struct MaterialDamping {
  double alpha = 0.0;  ///< 1/s, >= 0
  double beta = 0.0;   ///< s, >= 0
  static const Schema& schema();
};

struct DiscParameters {
  AnnularPlateParameters plate;
  double speed = 0.0;        ///< Ω towards +φ, rad/s, >= 0
  MaterialDamping damping;   ///< of the material, which turns
  bool centrifugal = false;  ///< whether the stress of the rotation stiffens the plate
  static const Schema& schema();
};

/// Springs that hold a pad: along r, φ and z, and between φ and z.
struct PadStiffness {
  double radial = 0.0;           ///< N/m, > 0
  double circumferential = 0.0;  ///< N/m, > 0
  double normal = 0.0;           ///< N/m, > 0
  double coupling = 0.0;         ///< N/m, between φ and z on the face of larger z, mirrored below
  static const Schema& schema();
};

/// Two rigid pads, one on each face, mirror images of each other.
struct PadsParameters {
  double mass = 0.0;  ///< of each, kg, > 0
  PadStiffness stiffness;
  double radius = 0.0;  ///< where they stand, m
  double angle = 0.0;   ///< rad
  MaterialDamping damping;
  static const Schema& schema();
};

enum class ContactFormulation { lagrange, penalty };

struct FaceFrictionParameters {
  double coefficient = 0.0;  ///< μ, >= 0
  static const Schema& schema();
};

struct FaceContactParameters {
  double preload = 0.0;  ///< normal force of each pad in the sliding state, N, >= 0
  FaceFrictionParameters friction;
  ContactFormulation formulation = ContactFormulation::lagrange;
  std::optional<double> penalty;  ///< k_C of each contact point, N/m, > 0
  std::vector<double> offsets;    ///< of the contact points along φ from the pad's centre, m
  static const Schema& schema();
};

/// A disc between two pads (HS).
struct DiscModelParameters {
  DiscParameters disc;
  PadsParameters pads;
  FaceContactParameters contact;
  std::vector<std::string> terms;  ///< see DiscTerms
  static const Schema& schema();
};

/// Which parts of the linearised equations are kept; HS (41) to (45) add one after the other.
struct DiscTerms {
  bool gyroscopic = false;          ///< 2Ω S and −Ω² SᵀS of the disc
  bool friction = false;            ///< friction of the varying normal force
  bool friction_damping = false;    ///< the preload's friction turns against velocities across
  bool geometric = false;           ///< the preload's forces turn and shift with the motion
  bool structural_damping = false;  ///< of disc and pads
};

/// Names of the terms, as a scene writes them.
const std::vector<std::string>& disc_term_names();
/// @throws std::invalid_argument for another name than these
DiscTerms disc_terms(const std::vector<std::string>& names);

/// Matrices of a disc with pads about steady sliding, and where they hold.
struct DiscModel {
  LinearSystem system;                ///< coordinates: of the plate, then r, φ, z of each pad
  std::vector<FaceContact> contacts;  ///< those of the pad on the face of larger z come first
  double contact_preload = 0.0;       ///< N₀ of each of them, N
  double highest_frequency = 0.0;     ///< Hz, of the lowest mode of the plate that is left out
};

/// Assembles the linearised equations (docs/theory.md, 10.3; HS (21), (26)).
///
/// With Lagrange multipliers the contacts are constraints, N q = 0; with a penalty their forces are
/// k_C times the gap. The disc has the modes of its plate; its material damping acts on what a
/// particle sees, ∂q/∂t + Ω S q, where the gyroscopic terms are kept.
///
/// @throws std::invalid_argument if a radius is off the plate, a penalty is missing, or friction
/// damping is wanted at no speed
DiscModel make_disc_model(const DiscModelParameters& parameters);

}  // namespace stridor
