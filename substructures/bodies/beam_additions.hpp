// What a scene adds to the mesh of a beam: points, springs, motion across.
#pragma once

#include <string>

#include "substructures/bodies/beam.hpp"

namespace stridor {

/// One more DoF, the displacement of the whole beam along z.
void add_motion_across(const BeamParameters& parameters, BodyMatrices& body);

/// A named point on a surface; between nodes it has their displacements with the weights of the
/// shape functions of the edge.
/// @param key of the point, for messages
/// @throws ConfigError where there is no such surface, the point lies off it, or its name is taken
void add_beam_point(const std::string& key, const std::string& name,
                    const BeamPointParameters& point, BodyMatrices& body);

/// Even loads of 1 N over every surface, BodyMatrices::loads.
void add_beam_loads(BodyMatrices& body);

/// Stiffness of the springs, and what they exert when their ground ends move.
/// @throws ConfigError where there is no such surface or point
void add_beam_springs(const BeamParameters& parameters, BodyMatrices& body);

}  // namespace stridor
