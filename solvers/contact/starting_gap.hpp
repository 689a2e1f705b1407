// Gaps of the contacts of a system at t = 0, before any contact force acts.
#pragma once

#include <vector>

#include "coupling/system/system.hpp"

namespace stridor {

/// Initial distance of a slave point from its master.
struct StartingGap {
  int contact = 0;
  double gap = 0.0;  ///< along the normal, m; negative: the slave starts inside its master
  Eigen::Vector3d normal = Eigen::Vector3d::UnitY();  ///< out of the master
};

/// Gaps of all contacts as the assumption of each measures them (docs/theory.md, 2.2), with
/// the initial displacements of the bodies and of the drive. A contact that starts off the end of its
/// master is measured from the last segment, extended.
std::vector<StartingGap> starting_gaps(const System& system);

/// Whether the gap of a contact may be of either sign at the start: positive ones are closed by the
/// load in time. A bilateral contact closes any gap in the first step.
inline bool may_start_open(const ContactPoint& contact) { return contact.unilateral_from() <= 0.0; }

/// Largest gap that is rounding, m: 1e-9 of the length of the master, on a face of its radius. An equilibrium that is found
/// iteratively leaves up to some 1e-11 of it.
double negligible_gap(const System& system, const ContactPoint& contact);

}  // namespace stridor
