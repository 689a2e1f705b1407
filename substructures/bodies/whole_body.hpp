// Bodies of which every unknown is kept.
#pragma once

#include <span>
#include <vector>

#include "substructures/matrices/body_matrices.hpp"
#include "substructures/matrices/sparse_system.hpp"
#include "substructures/reduction/craig_bampton.hpp"
#include "substructures/reduction/modal_body.hpp"

namespace stridor {

/// A body in the form of a reduced one, with its own DoFs as coordinates.
///
/// Nothing is solved for, so the body may move freely, and its stiffness K may be negative in some
/// motions: with K φ = ν M φ these are taken out of it into the coupled terms,
///
///   K ← K − Σ_{ν<0} ν M φ φᵀ M,   N ← N + Σ_{ν<0} ν M φ φᵀ M
///
/// so that its modes have ω = 0 there (make_modal()) and the sum of both is as given.
///
/// @param watched DoFs whose displacement is wanted, in the order of `rows`; `BodyMatrices::held`
///                gives a row of zeros
/// @throws std::invalid_argument if a watched DoF is out of range
/// @throws NumericalError as generalised_eigenpairs()
ReducedBody make_whole(const BodyMatrices& body, std::span<const int> watched);

/// M, P and Q of a body with its damping after its schedule, sparse.
SparseSystem make_sparse(const BodyMatrices& body);
/// The same of the modes of a body: unit mass.
SparseSystem make_sparse(const ModalBody& body);

/// Bodies side by side: block-diagonal matrices.
SparseSystem block_diagonal(std::vector<SparseSystem> blocks);

}  // namespace stridor
