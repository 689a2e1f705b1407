// Bodies given by matrices in words: how their damping was taken.
#pragma once

#include "app/terminal/command.hpp"
#include "models/model.hpp"

namespace stridor {

/// Of each body given by matrices, by name: `damping` "proportional" with alpha and beta, or
/// "coupled" where it, gyroscopic or circulatory terms join its modes (docs/theory.md, 1.5).
Json matrix_bodies_json(const Model& model);
/// The same, one line each.
void print_matrix_bodies(const Json& bodies);

}  // namespace stridor
