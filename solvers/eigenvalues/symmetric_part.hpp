// The symmetric part of a sparse system: its lowest modes, and a mass that can be factored.
#pragma once

#include <Eigen/Core>

#include "solvers/eigenvalues/sparse_pencil.hpp"
#include "substructures/reduction/lowest_modes.hpp"

namespace stridor {

/// The lowest modes of the symmetric part of Q with M. It need not be definite: it is shifted until
/// it is.
/// @throws NumericalError if there is no stiffness, or none that a shift makes definite
Modes symmetric_modes(const SparseSystem& system, Eigen::Index count);

/// M with a trace of mass everywhere: positive definite unless M is indefinite. A body without mass
/// at some DoFs is none the worse.
SparseMatrix with_little_mass(const SparseMatrix& mass);

}  // namespace stridor
