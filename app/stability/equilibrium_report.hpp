// Output of a sliding equilibrium.
#pragma once

#include "app/terminal/command.hpp"
#include "models/model.hpp"
#include "solvers/equilibrium/equilibrium.hpp"

namespace stridor {

/// Force, place and sliding of every contact, and displacements.
Json equilibrium_json(const Model& model, const Equilibrium& equilibrium);

/// A line for each contact: where it is, its forces and how fast it slides; of a pair with more
/// than 20 points what they do together.
void print_equilibrium(const System& system, const Equilibrium& equilibrium);

/// Where a contact law is used beyond its range. @param equilibrium of equilibrium_json()
void print_law_ranges(const Json& equilibrium);

}  // namespace stridor
