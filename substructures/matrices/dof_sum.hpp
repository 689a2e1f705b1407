// Sums and multiples of displacements that are sums over DoFs.
#pragma once

#include "substructures/matrices/body_matrices.hpp"

namespace stridor {

/// All weights times a factor; empty where that is 0.
DofSum scaled(const DofSum& sum, double factor);
/// Every DoF once, ascending; those that cancel are left out.
DofSum gathered(DofSum all);
/// Adds a displacement to another one; gathered() makes a DofSum with every DoF once of it.
void append(DofSum& all, const DofSum& more);

}  // namespace stridor
