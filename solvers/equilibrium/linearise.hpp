// Small motion about a sliding equilibrium.
#pragma once

#include <complex>

#include "solvers/eigenvalues/pencil.hpp"
#include "solvers/equilibrium/equilibrium.hpp"

namespace stridor {

/// Linearises the system about an equilibrium (docs/theory.md, 6.2).
///
///   B_C = −∂gap/∂y,   B_E,   G = Σ λ ∂b_Eᵀ/∂y,   H = Σ λ ∂b_Eᵀ/∂ẏ
///
/// in the geometry and under the assumptions that the equilibrium was found with: in the undeformed
/// geometry, and under Subs-a, the rows are constant and G = 0. The bodies slide with the velocity
/// of the drive; an open contact does not appear. The damping is that at the end of its schedule.
///
/// @param equilibrium of this system, converged
/// @param terms       which parts of G, H and of the gap's derivative are kept
/// @return ports and constraints of the closed contacts, in their order; where they have more ports
///         than there are modes, the modes as ports, S = 1; G and H empty where they vanish
/// @throws std::invalid_argument if the equilibrium has not converged
Pencil linearise(const System& system, const Equilibrium& equilibrium,
                 const LinearisationTerms& terms = {});

/// The same with every contact that is no force law as a constraint, those with a penalty giving way
/// by its compliance (Pencil::compliance).
Pencil linearise_constraints(const System& system, const Equilibrium& equilibrium,
                             const LinearisationTerms& terms = {});

/// Adds the motion u = Re(q exp(st)) of an eigenvector to the state in which the bodies start.
///
/// @param system    its initial displacements and velocities grow by Re q and Re(s q)
/// @param vector    q, modal coordinates of all bodies in their order, of any length and phase
/// @param s         its eigenvalue, 1/s
/// @param amplitude largest displacement of a row of any body (contact points, master nodes, loaded
///                  and recorded DoFs), m; that DoF starts with it
/// @throws std::invalid_argument if `vector` is not as long as the bodies have modes, or moves none
///         of their rows
void add_perturbation(System& system, const Eigen::VectorXcd& vector, std::complex<double> s,
                      double amplitude);

}  // namespace stridor
