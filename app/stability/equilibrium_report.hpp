// Output of a sliding equilibrium.
#pragma once

#include "app/terminal/command.hpp"
#include "models/model.hpp"
#include "solvers/equilibrium/equilibrium.hpp"

namespace stridor {

/// Force, place and sliding of every contact, and displacements.
Json equilibrium_json(const Model& model, const Equilibrium& equilibrium);

}  // namespace stridor
