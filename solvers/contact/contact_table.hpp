// Contacts of any indenter and material over speeds and indentations, as a table for a contact law.
#pragma once

#include <functional>
#include <vector>

#include "coupling/laws/viscoelastic_law.hpp"
#include "solvers/half_space/sliding_contact.hpp"

namespace stridor {

/// A table and how its contacts were found.
struct ComputedContactTable {
  ContactTable table;
  std::vector<SlidingContactResult> results;  ///< a row per indentation, as in the table
  bool converged() const;
};

/// Computes a table of contacts (docs/theory.md, 8.4): indentations one after the other, each along
/// the speeds.
///
/// @param creep        shares of the creep times and their lengths v τ_k at the speed v̂ = 1, m
/// @param speeds       v̂ > 0, ascending
/// @param indentations ŷ > 0, ascending
/// @param advanced     called after each contact with the number of contacts done
/// @throws std::invalid_argument as SlidingContact, e.g. if the indenter is in contact up to its
/// end
ComputedContactTable compute_contact_table(const IndenterProfile& profile,
                                           const CreepLengths& creep,
                                           const std::vector<double>& speeds,
                                           const std::vector<double>& indentations,
                                           const SlidingContactParameters& parameters,
                                           const std::function<void(std::size_t)>& advanced = {});

}  // namespace stridor
