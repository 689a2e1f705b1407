// Contacts on the faces of plates: where slaves stand, and what presses them on.
#pragma once

#include "models/contact_pair.hpp"

namespace stridor {

/// Places the slave of a pair on the face of its master, and adds the contacts to a system.
///
/// The middle of the slave body, between its nodes of smallest and largest x, stands at `start`; a
/// point that is x away from it along the circumference is at the angle φ + x/r, and its directions
/// turn with it. The face is flat: all points of the slave have the same y.
/// @throws ConfigError where the slave stands off the face, is bent, is placed by another contact,
///         or the pair has keys that mean nothing on a face
void add_face_contacts(const ContactPair& pair, const PairDrive& drive,
                       std::vector<ModelBody>& bodies, System& system);

/// Makes the state of rest with preloaded contacts that of undeformed bodies: each contact on a
/// face has the force of its preload there, and the bodies carry the opposite of its generalised
/// forces (docs/theory.md, 10.2), n + μ b, as SystemBody::held_load. A penalty has its spring
/// compressed by ContactPoint::overlap.
/// @param preloads of the contacts of the system, N
void hold_preloads(const std::vector<double>& preloads, System& system);

/// Preload of every contact of a system, 0 where none is given, N.
/// @param pairs in any order
std::vector<double> preloads_of(const std::vector<ContactPair>& pairs, const System& system);

}  // namespace stridor
