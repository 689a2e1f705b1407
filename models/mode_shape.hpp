// Modes of a system as motions of all nodes of its bodies.
#pragma once

#include <vector>

#include "models/body_cache.hpp"
#include "models/model.hpp"
#include "solvers/equilibrium/equilibrium.hpp"
#include "substructures/reduction/recovery.hpp"

namespace stridor {

/// A mode about an equilibrium, on the meshes of the bodies. A rigid master has no nodes and is
/// left out.
///
/// @param equilibrium of its system, which gives the positions of nodes; the bodies that follow the
///                    drive are displaced by it. In the undeformed geometry they are not deformed
/// @param mode        q, modal coordinates of all bodies in their order
/// @throws std::invalid_argument if `mode` is not as long as the bodies have modes
/// Cost: a reduction of every body.
std::vector<BodyShape> mode_shape(const Model& model, const Equilibrium& equilibrium,
                                  const Eigen::VectorXcd& mode, BodyCache& cache);

}  // namespace stridor
