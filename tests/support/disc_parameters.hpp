// Numbers of a disc with pads, of which the second formulation is made.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "substructures/bodies/annular_plate.hpp"
#include "tests/support/brake_pad.hpp"

namespace stridor {

/// C = α M + β K, constant in time.
struct MaterialDamping {
  double alpha = 0.0;  ///< 1/s, >= 0
  double beta = 0.0;   ///< s, >= 0
};

struct DiscParameters {
  AnnularPlateParameters plate;
  double speed = 0.0;        ///< Ω towards +φ, rad/s, >= 0
  MaterialDamping damping;   ///< of the material, which turns
  bool centrifugal = false;  ///< whether the stress of the rotation stiffens the plate
};

/// Load that presses the back of a pad towards the disc: a force, or a displacement of the far ends
/// of its springs.
struct PistonParameters {
  std::optional<double> force;         ///< N, >= 0
  std::optional<double> displacement;  ///< m, >= 0
};

/// Two pads, one on each face, mirror images of each other; rigid or elastic.
struct PadsParameters {
  std::optional<double> mass;                   ///< of each, where they are rigid, kg, > 0
  std::optional<ElasticPadParameters> elastic;  ///< or their material and geometry
  PadStiffness stiffness;
  std::optional<PistonParameters> piston;
  double radius = 0.0;  ///< of their position, m
  double angle = 0.0;   ///< rad
  MaterialDamping damping;
};

enum class ContactFormulation { lagrange, penalty };

struct FaceFrictionParameters {
  double coefficient = 0.0;  ///< μ, >= 0
};

struct FaceContactParameters {
  /// Normal force of each pad in the sliding state, N, >= 0; else it follows from the piston.
  std::optional<double> preload;
  FaceFrictionParameters friction;
  ContactFormulation formulation = ContactFormulation::lagrange;
  std::optional<double> penalty;  ///< k_C of each contact point, N/m, > 0
  /// Of the contact points along φ from the pad's centre, m; empty: see contact_offsets().
  std::vector<double> offsets;
};

/// A disc between two pads (HS).
struct DiscModelParameters {
  DiscParameters disc;
  PadsParameters pads;
  FaceContactParameters contact;
  std::vector<std::string> terms;  ///< see DiscTerms
};

/// The contact points of every pad along φ from its centre, m: those of the scene, else the nodes
/// of an elastic face, else the centre.
std::vector<double> contact_offsets(const DiscModelParameters& parameters);

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

}  // namespace stridor
